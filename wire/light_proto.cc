#include "wire/light_proto.h"

#include <Eigen/Core>
#include <algorithm>
#include <set>
#include <string>

#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "wire/utf8.h"

namespace lightfit {

namespace {

// Longer names are mistakes, and they go into every message and channel name.
constexpr size_t kMaxNameBytes = 256;

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

}  // namespace

absl::Status TooManyLightsError(int64_t count) {
  return absl::InvalidArgumentError(
      absl::StrFormat("lights: %d of them, want at most %d: one read-back has %d shadow bits per "
                      "pixel; split the list",
                      count,
                      kMaxLights,
                      kMaxLights));
}

absl::Status NameTakenError(const Light& light) {
  return absl::InvalidArgumentError(absl::StrFormat(
      "light \"%s\": name is taken by an earlier light, want distinct names", light.name));
}

absl::Status ValidateNamedLight(const Light& light) {
  if (light.name.empty()) {
    return absl::InvalidArgumentError("light: name is empty, want one to tell lights apart by");
  }
  if (light.name.size() > kMaxNameBytes) {
    return absl::InvalidArgumentError(absl::StrFormat("light \"%s...\": name has %d bytes, want %d",
                                                      Utf8Text(light.name.substr(0, 32)),
                                                      light.name.size(),
                                                      kMaxNameBytes));
  }
  return ValidateLight(light);
}

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
  if (!is_point && light.direction.isZero(0.0)) return proto;  // of no use, and not made up
  for (const double value : is_point ? light.position : light.direction) {
    is_point ? proto.add_position(value) : proto.add_direction(value);
  }
  return proto;
}

absl::Status ValidateLights(absl::Span<const Light> lights) {
  if (lights.size() > kMaxLights) return TooManyLightsError(static_cast<int64_t>(lights.size()));
  std::set<std::string> names;
  for (const Light& light : lights) {
    if (absl::Status status = ValidateNamedLight(light); !status.ok()) return status;
    if (!names.insert(light.name).second) {
      return NameTakenError(light);
    }
  }
  return absl::OkStatus();
}

}  // namespace lightfit
