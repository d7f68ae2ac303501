#include "io/given_maps.h"

#include <google/protobuf/struct.pb.h>

#include <Eigen/LU>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/text_file.h"
#include "geometry/border.h"
#include "geometry/clip.h"
#include "geometry/homography.h"
#include "lightfit/v1/result.pb.h"
#include "wire/matrix_proto.h"
#include "wire/plan_proto.h"
#include "wire/proto_json.h"

namespace lightfit {

namespace {

using google::protobuf::ListValue;
using google::protobuf::Struct;
using google::protobuf::Value;

// The field under its name in the schema or in JSON; null when there is neither.
const Value* FindField(const Struct& object, const char* name, const char* json_name) {
  for (const char* field : {name, json_name}) {
    const auto found = object.fields().find(field);
    if (found != object.fields().end()) return &found->second;
  }
  return nullptr;
}

// Appends numbers and, one level down, lists of numbers.
bool AppendNumbers(const ListValue& list, int depth, v1::Matrix4x4* matrix) {
  for (const Value& value : list.values()) {
    if (value.has_number_value()) {
      matrix->add_m(value.number_value());
    } else if (depth > 1 || !value.has_list_value() ||
               !AppendNumbers(value.list_value(), depth + 1, matrix)) {
      return false;
    }
  }
  return true;
}

absl::StatusOr<Eigen::Matrix4d> MatrixOf(const Value& value, const char* field) {
  const Value* numbers = &value;
  if (value.has_struct_value()) {
    numbers = FindField(value.struct_value(), "m", "m");
  }
  v1::Matrix4x4 matrix;
  if (numbers == nullptr || !numbers->has_list_value() ||
      !AppendNumbers(numbers->list_value(), 1, &matrix)) {
    return absl::InvalidArgumentError(
        absl::StrCat(field, ": want 16 numbers, row-major, or 4 rows of 4"));
  }
  return MatrixFromProto(matrix, field);
}

// From texels of a map of size `from` to those of one of size `to`.
Eigen::Matrix4d ScaledTexels(MapSize from, MapSize to) {
  Eigen::Vector4d scale = Eigen::Vector4d::Ones();
  scale.x() = static_cast<double>(to.width) / from.width;
  scale.y() = static_cast<double>(to.height) / from.height;
  return scale.asDiagonal();
}

absl::StatusOr<MapSize> SizeOf(const Value& value) {
  const auto side = [&value](const char* field) {
    const Value* found = FindField(value.struct_value(), field, field);
    return found == nullptr ? 0.0 : found->number_value();
  };
  const double width = side("width"), height = side("height");
  if (!(width >= 1.0 && height >= 1.0 && width <= kMaxMapSide && height <= kMaxMapSide)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "map = %gx%g, want {\"width\": ..., \"height\": ...} in texels", width, height));
  }
  return MapSize{static_cast<int>(width), static_cast<int>(height)};
}

absl::StatusOr<ClipConvention> ClipOf(const Value& value) {
  if (value.has_string_value()) return ParseClipConvention(value.string_value());
  ClipConvention clip;
  const Value* y_up = FindField(value.struct_value(), "y_up", "yUp");
  if (y_up == nullptr || y_up->kind_case() != Value::kBoolValue) {
    return absl::InvalidArgumentError(
        "clip: want \"vulkan\", \"direct3d\", \"opengl\", \"reversed_z\" or "
        "\"direct3d_reversed\"");
  }
  clip.y_up = y_up->bool_value();  // depth does not matter
  return clip;
}

absl::StatusOr<Eigen::Matrix4d> SingleMapFromWorld(const Struct& object, MapSize map) {
  if (const Value* value = FindField(object, "map_from_world", "mapFromWorld")) {
    absl::StatusOr<Eigen::Matrix4d> matrix = MatrixOf(*value, "map_from_world");
    const Value* size = FindField(object, "map", "map");
    if (!matrix.ok() || size == nullptr) return matrix;
    const absl::StatusOr<MapSize> own_map = SizeOf(*size);
    if (!own_map.ok()) return own_map.status();
    return Eigen::Matrix4d(ScaledTexels(*own_map, map) * *matrix);
  }
  if (const Value* value = FindField(object, "clip_from_world", "clipFromWorld")) {
    absl::StatusOr<Eigen::Matrix4d> matrix = MatrixOf(*value, "clip_from_world");
    if (!matrix.ok()) return matrix;
    ClipConvention clip = ClipConvention::Vulkan();
    if (const Value* clip_value = FindField(object, "clip", "clip")) {
      const absl::StatusOr<ClipConvention> given = ClipOf(*clip_value);
      if (!given.ok()) return given.status();
      clip = *given;
    }
    return Eigen::Matrix4d(ClipFromMap(map, clip).inverse() * *matrix);
  }
  return absl::InvalidArgumentError(
      "holds no matrix: want a result of lightfit fit, or \"map_from_world\" or "
      "\"clip_from_world\" with 16 numbers");
}

// "dark", or as the schema calls it.
absl::StatusOr<Border> SingleBorder(const Struct& object) {
  const Value* value = FindField(object, "border", "border");
  if (value == nullptr) return Border::kLit;
  for (const Border border : {Border::kLit, Border::kDark}) {
    const std::string& word = value->string_value();
    if (word == BorderName(border) || word == v1::Border_Name(BorderToProto(border))) return border;
  }
  return absl::InvalidArgumentError(
      absl::StrCat("border = \"", value->string_value(), "\", want \"lit\" or \"dark\""));
}

// `of_light` stands before the field in an error.
absl::StatusOr<GivenMaps> OneMap(const Eigen::Matrix4d& map_from_world,
                                 MapSize map,
                                 Border border,
                                 const std::string& of_light = "") {
  if (!map_from_world.allFinite()) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%sthe matrix has numbers that are too large for a double once it is in texels of a map of "
        "%dx%d",
        of_light,
        map.width,
        map.height));
  }
  return GivenMaps{PlanOfOneMap(/*light_name=*/"", map_from_world, map, border)};
}

absl::StatusOr<GivenMaps> SingleMatrix(const Struct& object, MapSize map) {
  const absl::StatusOr<Eigen::Matrix4d> matrix = SingleMapFromWorld(object, map);
  if (!matrix.ok()) return matrix.status();
  const absl::StatusOr<Border> border = SingleBorder(object);
  if (!border.ok()) return border.status();
  return OneMap(*matrix, map, *border);
}

absl::StatusOr<GivenMaps> PlanOfResult(const v1::Plan& proto, const std::string& field) {
  absl::StatusOr<Plan> plan = PlanFromProto(proto, field);
  if (!plan.ok()) return plan.status();
  const absl::StatusOr<double> guard_texels = GuardTexelsFromProto(proto, field);
  if (!guard_texels.ok()) return guard_texels.status();
  return GivenMaps{*std::move(plan), *guard_texels};
}

absl::StatusOr<GivenMaps> MatrixOfResult(const v1::LightResult& light,
                                         const std::string& of_light,
                                         MapSize map) {
  const absl::StatusOr<Eigen::Matrix4d> matrix =
      MatrixFromProto(light.map_from_world(), of_light + "map_from_world");
  if (!matrix.ok()) return matrix.status();
  const absl::StatusOr<Border> border = BorderFromProto(light.border(), of_light + "border");
  if (!border.ok()) return border.status();
  const MapSize own_map = {light.map().width(), light.map().height()};
  if (own_map.width < 1 || own_map.height < 1) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%smap = %dx%d texels", of_light, own_map.width, own_map.height));
  }
  return OneMap(ScaledTexels(own_map, map) * *matrix, map, *border, of_light);
}

absl::StatusOr<std::map<std::string, GivenMaps>> MapsOfResult(absl::string_view json, MapSize map) {
  v1::FitResult result;
  if (absl::Status status = JsonToProto(json, result); !status.ok()) return status;
  std::map<std::string, GivenMaps> by_light;
  for (const v1::LightResult& light : result.lights()) {
    if (light.status().code() != 0 || !(light.has_plan() || light.has_map_from_world())) continue;
    const std::string of_light = absl::StrCat("light \"", light.name(), "\": ");
    absl::StatusOr<GivenMaps> maps = light.has_plan()
                                         ? PlanOfResult(light.plan(), of_light + "plan")
                                         : MatrixOfResult(light, of_light, map);
    if (!maps.ok()) return maps.status();
    by_light[light.name()] = *std::move(maps);
  }
  if (by_light.empty()) {
    return absl::InvalidArgumentError(
        "lights: none of them has a map_from_world or a plan; want a result of lightfit fit "
        "--json");
  }
  return by_light;
}

// Errors say which map is not one of the light.
absl::Status CheckIsOfLight(const Plan& plan, const Light& light) {
  for (size_t k = 0; k < plan.maps.size(); ++k) {
    absl::Status status = MapFromRay(plan.maps[k].map_from_world, light).status();
    if (status.ok()) continue;
    if (plan.maps.size() == 1) return status;
    return absl::Status(
        status.code(),
        absl::StrCat("plan.maps[", k, "]: ", status.message(), "; want the plan as it was fitted"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<GivenMaps> GivenSetUp::Of(const Light& light) const {
  const GivenMaps* given = for_every_light.has_value() ? &*for_every_light : nullptr;
  if (given == nullptr) {
    const auto found = by_light.find(light.name);
    if (found != by_light.end()) given = &found->second;
  }
  if (given == nullptr) {
    const std::string known =
        absl::StrJoin(by_light, ", ", [](std::string* out, const auto& name_and_maps) {
          absl::StrAppend(out, "\"", name_and_maps.first, "\"");
        });
    return absl::NotFoundError(absl::StrCat(
        "the file of ", name, " has no maps for light \"", light.name, "\", it has ", known));
  }
  if (absl::Status status = CheckIsOfLight(given->plan, light); !status.ok()) {
    return path.empty() ? status : InFile(path, status);
  }
  GivenMaps maps = *given;
  maps.plan.light_name.assign(light.name.data(), light.name.size());
  return maps;
}

absl::StatusOr<GivenSetUp> ParseGivenMaps(const std::string& name,
                                          absl::string_view json,
                                          MapSize map) {
  Struct object;
  if (absl::Status status = JsonToProto(json, object); !status.ok()) return status;
  GivenSetUp given;
  given.name = name;
  if (object.fields().contains("lights")) {
    absl::StatusOr<std::map<std::string, GivenMaps>> maps = MapsOfResult(json, map);
    if (!maps.ok()) return maps.status();
    given.by_light = *std::move(maps);
    return given;
  }
  absl::StatusOr<GivenMaps> maps = SingleMatrix(object, map);
  if (!maps.ok()) return maps.status();
  given.for_every_light = *std::move(maps);
  return given;
}

absl::StatusOr<GivenSetUp> ReadGivenMaps(const std::string& name,
                                         const std::string& path,
                                         MapSize map) {
  const absl::StatusOr<std::string> json = ReadTextFile(path);
  if (!json.ok()) return json.status();
  absl::StatusOr<GivenSetUp> given = ParseGivenMaps(name, *json, map);
  if (!given.ok()) return InFile(path, given.status());
  given->path = path;
  return given;
}

}  // namespace lightfit
