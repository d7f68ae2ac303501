#include "io/lights_file.h"

#include <cmath>
#include <set>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "io/proto_json.h"
#include "io/text_file.h"

namespace lightfit {

namespace {

// Longer names are mistakes, and they go into every message and channel name.
constexpr size_t kMaxNameBytes = 256;

absl::Status TooManyLights(int64_t count) {
  return absl::InvalidArgumentError(
      absl::StrFormat("lights: %d of them, want at most %d: one read-back has %d shadow bits per "
                      "pixel; split the list",
                      count,
                      kMaxLights,
                      kMaxLights));
}

absl::StatusOr<Eigen::Vector3d> VectorFromField(const std::string& light,
                                                const char* field,
                                                const google::protobuf::RepeatedField<double>& m) {
  if (m.size() != 3) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": %s = [%s], %d numbers, want 3: x, y, z",
                        light,
                        field,
                        absl::StrJoin(m.begin(), m.begin() + std::min(m.size(), 8), ", "),
                        m.size()));
  }
  return Eigen::Vector3d(m[0], m[1], m[2]);
}

// As ValidateLight(), and the name.
absl::Status ValidateNamedLight(const Light& light) {
  if (light.name.empty()) {
    return absl::InvalidArgumentError("light: name is empty, want one to tell lights apart by");
  }
  if (light.name.size() > kMaxNameBytes) {
    return absl::InvalidArgumentError(absl::StrFormat("light \"%s...\": name has %d bytes, want %d",
                                                      light.name.substr(0, 32),
                                                      light.name.size(),
                                                      kMaxNameBytes));
  }
  return ValidateLight(light);
}

}  // namespace

absl::StatusOr<Light> LightFromProto(const v1::Light& proto) {
  const bool is_point = proto.position_size() > 0;
  if (is_point == (proto.direction_size() > 0)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": has %s, want either position (a point light) or direction (of travel, a "
        "directional light)",
        proto.name(),
        is_point ? "both position and direction" : "neither position nor direction"));
  }
  const absl::StatusOr<Eigen::Vector3d> vector =
      is_point ? VectorFromField(proto.name(), "position", proto.position())
               : VectorFromField(proto.name(), "direction", proto.direction());
  if (!vector.ok()) return vector.status();
  Light light =
      is_point ? Light::Point(proto.name(), *vector) : Light::Directional(proto.name(), *vector);
  if (absl::Status status = ValidateNamedLight(light); !status.ok()) return status;
  return light;
}

v1::Light LightToProto(const Light& light) {
  v1::Light proto;
  proto.set_name(light.name);
  const bool is_point = light.kind == Light::Kind::kPoint;
  for (const double value : is_point ? light.position : light.direction) {
    is_point ? proto.add_position(value) : proto.add_direction(value);
  }
  return proto;
}

absl::Status ValidateLights(absl::Span<const Light> lights) {
  if (lights.size() > kMaxLights) return TooManyLights(static_cast<int64_t>(lights.size()));
  std::set<std::string> names;
  for (const Light& light : lights) {
    if (absl::Status status = ValidateNamedLight(light); !status.ok()) return status;
    if (!names.insert(light.name).second) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "light \"%s\": name is taken by an earlier light, want distinct names", light.name));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<Light>> ParseLightsJson(absl::string_view json) {
  v1::LightList list;
  if (absl::Status status = JsonToProto(json, list); !status.ok()) return status;
  if (list.lights().empty()) {
    return absl::InvalidArgumentError(
        "lights: none, want {\"lights\": [{\"name\": ..., \"position\" or \"direction\": [x, y, "
        "z]}]}");
  }
  if (list.lights_size() > kMaxLights) return TooManyLights(list.lights_size());
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
