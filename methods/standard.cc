#include "methods/standard.h"

#include "methods/light_body.h"

namespace lightfit {

absl::StatusOr<MethodMap> StandardMap(const MethodInput& input) {
  const absl::StatusOr<LightBody> body = WholeBody(input);
  if (!body.ok()) return body.status();
  return FitBody(*body, Eigen::Matrix3d::Identity(), RectangleTurn::kMinArea);
}

}  // namespace lightfit
