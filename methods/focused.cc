#include "methods/focused.h"

#include <Eigen/Core>
#include <optional>

#include "absl/strings/str_cat.h"
#include "methods/light_body.h"
#include "methods/standard.h"
#include "methods/view_body.h"
#include "methods/view_frame.h"

namespace lightfit {

absl::StatusOr<MethodMap> FocusedMap(const MethodInput& input, const FocusedOptions& options) {
  const absl::StatusOr<LightBody> body = BodyInView(input);
  if (!body.ok()) return body.status();
  if (!body->in_view) {
    absl::StatusOr<MethodMap> map = StandardMap(input);
    if (map.ok()) map->note = "standard: the camera sees none of the receivers";
    return map;
  }
  if (!options.min_area_rotation) {
    const std::optional<ViewFrame> frame =
        AlongView(*body, input.camera, ViewDirection(input.camera));
    if (frame.has_value()) return FitBody(*body, frame->Warped(0.0), RectangleTurn::kAlongRows);
  }
  return FitBody(*body, Eigen::Matrix3d::Identity(), RectangleTurn::kMinArea);
}

absl::StatusOr<MethodMap> FocusedInstead(const MethodInput& input, const std::string& why) {
  absl::StatusOr<MethodMap> map = FocusedMap(input);
  if (map.ok() && map->note.empty()) map->note = absl::StrCat("focused: ", why);
  return map;
}

}  // namespace lightfit
