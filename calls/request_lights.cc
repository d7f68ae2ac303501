#include "calls/request_lights.h"

#include <set>
#include <string>

#include "absl/strings/str_format.h"
#include "calls/message_text.h"
#include "wire/light_proto.h"

namespace lightfit {

absl::Status CheckNumLights(int num_lights) {
  if (num_lights < 1) return absl::InvalidArgumentError("lights: none, want 1 to 32 of them");
  if (num_lights <= kMaxLights) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat(
      "lights: %d of them, want at most %d: one read-back has %d shadow bits per pixel; send "
      "several requests",
      num_lights,
      kMaxLights,
      kMaxLights));
}

absl::StatusOr<std::vector<RequestLight>> LightsOfRequest(
    const google::protobuf::RepeatedPtrField<v1::Light>& lights) {
  if (absl::Status status = CheckNumLights(lights.size()); !status.ok()) return status;
  std::set<std::string> names;
  std::vector<RequestLight> result;
  for (const v1::Light& proto : lights) {
    const int index = static_cast<int>(result.size());
    if (proto.name().empty()) {
      return absl::InvalidArgumentError(
          absl::StrFormat("lights[%d].name: is empty, want one to tell lights apart by", index));
    }
    if (!names.insert(proto.name()).second) {
      return absl::InvalidArgumentError(
          absl::StrFormat("lights[%d].name = %s: is taken by an earlier light, want distinct "
                          "names",
                          index,
                          Quoted(proto.name())));
    }
    RequestLight& light = result.emplace_back();
    absl::StatusOr<Light> parsed = LightFromProto(proto);
    if (parsed.ok()) {
      light.light = *std::move(parsed);
    } else {
      light.light.name = proto.name();
      light.status = parsed.status();
    }
    light.light.shadow_bit = index;
  }
  return result;
}

}  // namespace lightfit
