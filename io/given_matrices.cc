#include "io/given_matrices.h"

#include <google/protobuf/struct.pb.h>

#include <Eigen/LU>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/text_file.h"
#include "geometry/map_size.h"
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
        "clip: want \"vulkan\", \"direct3d\", \"opengl\" or \"reversed_z\"");
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

absl::StatusOr<GivenMatrix> SingleMatrix(const Struct& object, MapSize map) {
  const absl::StatusOr<Eigen::Matrix4d> matrix = SingleMapFromWorld(object, map);
  if (!matrix.ok()) return matrix.status();
  const absl::StatusOr<Border> border = SingleBorder(object);
  if (!border.ok()) return border.status();
  return GivenMatrix{*matrix, *border};
}

absl::StatusOr<std::map<std::string, GivenMatrix>> MatricesOfResult(absl::string_view json,
                                                                    MapSize map) {
  v1::FitResult result;
  if (absl::Status status = JsonToProto(json, result); !status.ok()) return status;
  std::map<std::string, GivenMatrix> matrices;
  for (const v1::LightResult& light : result.lights()) {
    if (absl::Status status = CheckHasOneMap(light); !status.ok()) return status;
    if (light.status().code() != 0 || !light.has_map_from_world()) continue;
    const std::string of_light = absl::StrCat("light \"", light.name(), "\": ");
    const absl::StatusOr<Eigen::Matrix4d> matrix =
        MatrixFromProto(light.map_from_world(), of_light + "map_from_world");
    if (!matrix.ok()) return matrix.status();
    const absl::StatusOr<Border> border = BorderFromProto(light.border(), of_light + "border");
    if (!border.ok()) return border.status();
    const MapSize own_map = {light.map().width(), light.map().height()};
    if (own_map.width < 1 || own_map.height < 1) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "light \"%s\": map = %dx%d texels", light.name(), own_map.width, own_map.height));
    }
    matrices[light.name()] = {ScaledTexels(own_map, map) * *matrix, *border};
  }
  if (matrices.empty()) {
    return absl::InvalidArgumentError(
        "lights: none of them has a map_from_world; want a result of lightfit fit --json");
  }
  return matrices;
}

}  // namespace

absl::StatusOr<GivenMatrix> GivenMatrices::Of(const std::string& light) const {
  if (for_every_light.has_value()) return *for_every_light;
  const auto found = by_light.find(light);
  if (found != by_light.end()) return found->second;
  const std::string known =
      absl::StrJoin(by_light, ", ", [](std::string* out, const auto& name_and_matrix) {
        absl::StrAppend(out, "\"", name_and_matrix.first, "\"");
      });
  return absl::NotFoundError(absl::StrCat(
      "the file of ", name, " has no matrix for light \"", light, "\", it has ", known));
}

absl::StatusOr<GivenMatrices> ParseGivenMatrices(const std::string& name,
                                                 absl::string_view json,
                                                 MapSize map) {
  Struct object;
  if (absl::Status status = JsonToProto(json, object); !status.ok()) return status;
  GivenMatrices given;
  given.name = name;
  if (object.fields().contains("lights")) {
    absl::StatusOr<std::map<std::string, GivenMatrix>> matrices = MatricesOfResult(json, map);
    if (!matrices.ok()) return matrices.status();
    given.by_light = *std::move(matrices);
    return given;
  }
  const absl::StatusOr<GivenMatrix> matrix = SingleMatrix(object, map);
  if (!matrix.ok()) return matrix.status();
  given.for_every_light = *matrix;
  return given;
}

absl::StatusOr<GivenMatrices> ReadGivenMatrices(const std::string& name,
                                                const std::string& path,
                                                MapSize map) {
  const absl::StatusOr<std::string> json = ReadTextFile(path);
  if (!json.ok()) return json.status();
  absl::StatusOr<GivenMatrices> given = ParseGivenMatrices(name, *json, map);
  if (!given.ok()) return InFile(path, given.status());
  return given;
}

}  // namespace lightfit
