#include "io/lights_file.h"

#include <cmath>
#include <optional>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "base/text_file.h"
#include "io/frames/light_frames.h"
#include "wire/light_proto.h"
#include "wire/proto_json.h"

namespace lightfit {

absl::StatusOr<std::vector<Light>> ParseLightsJson(absl::string_view json) {
  const absl::StatusOr<std::optional<LightFrames>> frames = LightFrames::Parse(json);
  if (!frames.ok()) return frames.status();
  if (frames->has_value()) {
    return absl::InvalidArgumentError(
        "frames: its lights move, and the lights of one frame are wanted here: give each with "
        "--light, or a file without frames");
  }
  v1::LightList list;
  if (absl::Status status = JsonToProto(json, list); !status.ok()) return status;
  if (list.lights().empty()) {
    return absl::InvalidArgumentError(
        "lights: none, want {\"lights\": [{\"name\": ..., \"position\" or \"direction\": [x, y, "
        "z]}]}");
  }
  if (list.lights_size() > kMaxLights) return TooManyLightsError(list.lights_size());
  std::vector<Light> lights;
  for (const v1::Light& proto : list.lights()) {
    absl::StatusOr<Light> light = LightFromProto(proto);
    if (!light.ok()) {
      return absl::Status(light.status().code(),
                          absl::StrCat("lights[", lights.size(), "]: ", light.status().message()));
    }
    light->shadow_bit = static_cast<int>(lights.size());
    lights.push_back(*std::move(light));
  }
  if (absl::Status status = ValidateLights(lights); !status.ok()) return status;
  return lights;
}

absl::StatusOr<std::vector<Light>> ReadLightsFile(const std::string& path) {
  const absl::StatusOr<std::string> json = ReadTextFile(path);
  if (!json.ok()) return json.status();
  absl::StatusOr<std::vector<Light>> lights = ParseLightsJson(*json);
  if (!lights.ok()) return InFile(path, lights.status());
  return lights;
}

absl::StatusOr<Light> ParseLight(absl::string_view text) {
  const auto refuse = [text](absl::string_view what) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": %s, want NAME=point:x,y,z or NAME=sun:x,y,z (the direction of travel)",
        text,
        what));
  };
  // Names may hold '=', values cannot.
  const size_t equals = text.rfind('=');
  if (equals == absl::string_view::npos) return refuse("has no '='");
  const absl::string_view name = text.substr(0, equals);
  const std::pair<absl::string_view, absl::string_view> value =
      absl::StrSplit(text.substr(equals + 1), absl::MaxSplits(':', 1));
  const bool is_point = value.first == "point";
  if (!is_point && value.first != "sun") {
    return refuse(absl::StrFormat("kind = \"%s\"", value.first));
  }
  const std::vector<absl::string_view> numbers = absl::StrSplit(value.second, ',');
  if (numbers.size() != 3) return refuse(absl::StrFormat("has %d numbers", numbers.size()));
  Eigen::Vector3d vector;
  for (int i = 0; i < 3; ++i) {
    if (!absl::SimpleAtod(numbers[i], &vector[i])) {
      return refuse(absl::StrFormat("\"%s\" is not a number", numbers[i]));
    }
  }
  Light light = is_point ? Light::Point(std::string(name), vector)
                         : Light::Directional(std::string(name), vector);
  if (absl::Status status = ValidateNamedLight(light); !status.ok()) return status;
  return light;
}

}  // namespace lightfit
