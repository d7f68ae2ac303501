#include "io/header_lights.h"

#include <limits>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "io/exr_input.h"
#include "io/lights_file.h"
#include "wire/light_proto.h"
#include "wire/proto_json.h"
#include "wire/utf8.h"

namespace lightfit {

absl::StatusOr<std::string> LightsForHeader(absl::Span<const Light> lights) {
  v1::LightList list;
  for (const Light& light : lights) {
    if (Utf8Text(light.name) != light.name) {
      return absl::InvalidArgumentError(
          absl::StrCat("light \"", Utf8Text(light.name), "\": name is not UTF-8"));
    }
    *list.add_lights() = LightToProto(light);
  }
  return ProtoToJson(list);
}

absl::StatusOr<std::optional<std::vector<Light>>> internal::LightsFromHeader(const ExrInput& exr,
                                                                             int part) {
  const std::string name(kLightsAttribute);
  std::optional<std::string> json = exr.StringAttribute(part, name);
  for (int i = 0; i < exr.num_parts() && !json; ++i) json = exr.StringAttribute(i, name);
  if (!json) return std::nullopt;
  absl::StatusOr<std::vector<Light>> lights = ParseLightsJson(*json);
  if (lights.ok()) return *std::move(lights);
  return absl::Status(
      lights.status().code(),
      absl::StrCat(exr.path(), ": attribute \"", name, "\": ", lights.status().message()));
}

absl::StatusOr<std::optional<std::vector<Light>>> LightsFromHeader(const std::string& path) {
  // Only the header is read, so the number of pixels does not matter.
  const absl::StatusOr<internal::ExrInput> exr =
      internal::ExrInput::Open(path, std::numeric_limits<int64_t>::max());
  if (!exr.ok()) return exr.status();
  return internal::LightsFromHeader(*exr, 0);
}

}  // namespace lightfit
