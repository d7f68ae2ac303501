#include "io/camera_file.h"

#include <google/protobuf/struct.pb.h>

#include <Eigen/Dense>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/text_file.h"
#include "geometry/clip.h"
#include "scenes/gltf_view.h"
#include "wire/camera_proto.h"
#include "wire/matrix_proto.h"
#include "wire/proto_json.h"

namespace lightfit {

namespace {

using google::protobuf::Struct;
using google::protobuf::Value;

// Appends numbers and, one level down, lists of numbers: 16 numbers or 4 rows of 4.
bool AppendNumbers(const google::protobuf::ListValue& list, int depth, v1::Matrix4x4& matrix) {
  for (const Value& value : list.values()) {
    if (value.has_number_value()) {
      matrix.add_m(value.number_value());
    } else if (depth > 1 || !value.has_list_value() ||
               !AppendNumbers(value.list_value(), depth + 1, matrix)) {
      return false;
    }
  }
  return true;
}

absl::StatusOr<Eigen::Matrix4d> SceneMatrix(const Struct& frame,
                                            const char* field,
                                            absl::string_view where) {
  v1::Matrix4x4 matrix;
  const auto found = frame.fields().find(field);
  if (found == frame.fields().end() || !found->second.has_list_value() ||
      !AppendNumbers(found->second.list_value(), 1, matrix)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s.%s: want a 4x4 matrix, as 4 rows of 4 numbers", where, field));
  }
  return MatrixFromProto(matrix, absl::StrCat(where, ".", field));
}

absl::StatusOr<int> SceneSize(const Struct& scene, const char* field) {
  const auto found = scene.fields().find(field);
  const double value = found == scene.fields().end() ? 0.0 : found->second.number_value();
  if (!(value >= 1.0) || value > 1e9 || value != std::floor(value)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s = %g, want the image's size in pixels", field, value));
  }
  return static_cast<int>(value);
}

absl::StatusOr<StatedCamera> CameraFromScene(const Struct& scene, int frame) {
  const auto& frames = scene.fields().at("frames").list_value().values();
  if (frame < 0 || frame >= frames.size() || !frames[frame].has_struct_value()) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "frame %d is not in the file: it has %d, counted from 0", frame, frames.size()));
  }
  const std::string where = absl::StrFormat("frames[%d]", frame);
  const Struct& cameras = frames[frame].struct_value();
  const absl::StatusOr<int> width = SceneSize(scene, "width");
  if (!width.ok()) return width.status();
  const absl::StatusOr<int> height = SceneSize(scene, "height");
  if (!height.ok()) return height.status();
  const absl::StatusOr<Eigen::Matrix4d> matrix = SceneMatrix(cameras, "camera_to_world", where);
  if (!matrix.ok()) return matrix.status();
  const absl::StatusOr<Eigen::Matrix4d> world_from_camera =
      RigidPose(*matrix, where + ".camera_to_world");
  if (!world_from_camera.ok()) return world_from_camera.status();
  const absl::StatusOr<Eigen::Matrix4d> projection = SceneMatrix(cameras, "projection", where);
  if (!projection.ok()) return projection.status();
  absl::StatusOr<Camera> camera = MakeCamera(
      InverseOfPose(*world_from_camera), *projection, ClipConvention::OpenGl(), *width, *height);
  if (!camera.ok()) return camera.status();
  return StatedCamera{*std::move(camera), std::nullopt};
}

}  // namespace

absl::StatusOr<StatedCamera> ParseCameraJson(absl::string_view json, int frame) {
  Struct scene;
  if (absl::Status status = JsonToProto(json, scene); !status.ok()) return status;
  if (scene.fields().contains("frames")) return CameraFromScene(scene, frame);
  if (frame != 0) {
    return absl::InvalidArgumentError(
        absl::StrFormat("frame %d is not in the file: it holds one camera, frame 0", frame));
  }
  v1::Camera proto;
  if (absl::Status status = JsonToProto(json, proto); !status.ok()) return status;
  return CameraFromProto(proto);
}

absl::StatusOr<StatedCamera> ReadCameraFile(const std::string& path, int frame) {
  if (IsGltf(path)) {
    absl::StatusOr<Camera> camera = ReadGltfCamera(path);
    if (!camera.ok()) return camera.status();
    if (frame != 0) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%s: has no frame %d: its camera stands still", path, frame));
    }
    return StatedCamera{*std::move(camera), std::nullopt};
  }
  const absl::StatusOr<std::string> json = ReadTextFile(path);
  if (!json.ok()) return json.status();
  absl::StatusOr<StatedCamera> camera = ParseCameraJson(*json, frame);
  if (!camera.ok()) return InFile(path, camera.status());
  return camera;
}

}  // namespace lightfit
