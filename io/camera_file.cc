#include "io/camera_file.h"

#include <google/protobuf/struct.pb.h>

#include <Eigen/Dense>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/text_file.h"
#include "geometry/clip.h"
#include "io/frames/frame_table.h"
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

absl::StatusOr<StatedCamera> CameraFromScene(const Struct& scene,
                                             const Value& entry,
                                             const std::string& where) {
  if (!entry.has_struct_value()) {
    return absl::InvalidArgumentError(absl::StrCat(
        where, ": want an object with the camera of this frame, camera_to_world and projection"));
  }
  const Struct& cameras = entry.struct_value();
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

absl::StatusOr<StatedCamera> OneOf(CameraFile file, const std::optional<FrameNumber>& frame) {
  if (!frame.has_value()) return file.cameras[0];
  ShotNumbers shot;
  shot.are_known = true;
  shot.stated = frame;
  const absl::StatusOr<EntryChooser> chooser = EntryChooser::Make(file.numbers, shot, "cameras");
  if (!chooser.ok()) return chooser.status();
  const absl::StatusOr<size_t> entry = chooser->EntryOf(shot.first);
  if (!entry.ok()) return entry.status();
  return file.cameras[*entry];
}

}  // namespace

absl::StatusOr<CameraFile> ParseCameras(absl::string_view json) {
  CameraFile file;
  Struct scene;
  if (absl::Status status = JsonToProto(json, scene); !status.ok()) return status;
  if (!HasFrames(scene)) {
    v1::Camera proto;
    if (absl::Status status = JsonToProto(json, proto); !status.ok()) return status;
    const absl::StatusOr<StatedCamera> camera = CameraFromProto(proto);
    if (!camera.ok()) return camera.status();
    file.cameras.push_back(camera);
    file.numbers.emplace_back();
    return file;
  }
  const absl::StatusOr<FrameTable> table = ReadFrameTable(scene);
  if (!table.ok()) return table.status();
  for (const FrameEntry& entry : *table) {
    const std::string where = scene.fields().at("frames").has_struct_value()
                                  ? absl::StrCat("frames.", entry.number->Text())
                                  : absl::StrFormat("frames[%d]", file.cameras.size());
    file.cameras.push_back(CameraFromScene(scene, entry.value, where));
    file.numbers.push_back(entry.number);
  }
  return file;
}

absl::StatusOr<CameraFile> ReadCameras(const std::string& path) {
  if (IsGltf(path)) {
    absl::StatusOr<Camera> camera = ReadGltfCamera(path);
    if (!camera.ok()) return camera.status();
    CameraFile file;
    file.cameras.emplace_back(StatedCamera{*std::move(camera), std::nullopt});
    file.numbers.emplace_back();
    return file;
  }
  const absl::StatusOr<std::string> json = ReadTextFile(path);
  if (!json.ok()) return json.status();
  absl::StatusOr<CameraFile> file = ParseCameras(*json);
  if (!file.ok()) return InFile(path, file.status());
  return file;
}

absl::StatusOr<StatedCamera> ParseCameraJson(absl::string_view json,
                                             const std::optional<FrameNumber>& frame) {
  absl::StatusOr<CameraFile> file = ParseCameras(json);
  if (!file.ok()) return file.status();
  return OneOf(*std::move(file), frame);
}

absl::StatusOr<StatedCamera> ReadCameraFile(const std::string& path,
                                            const std::optional<FrameNumber>& frame) {
  absl::StatusOr<CameraFile> file = ReadCameras(path);
  if (!file.ok()) return file.status();
  absl::StatusOr<StatedCamera> camera = OneOf(*std::move(file), frame);
  if (!camera.ok()) return InFile(path, camera.status());
  return camera;
}

}  // namespace lightfit
