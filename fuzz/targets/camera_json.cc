// Files of cameras, scene files with frames among them.
#include "fuzz/input_form.h"
#include "fuzz/promises.h"
#include "io/camera_file.h"
#include "wire/camera_proto.h"

namespace lightfit::fuzz {

InputForm FormOfInput() { return {&v1::Camera::default_instance(), Encoding::kJson}; }

namespace {

void PromiseCamera(const absl::StatusOr<StatedCamera>& file) {
  PromiseOkOrError(file.status());
  if (!file.ok()) return;
  const Camera& camera = file->camera;
  Promise(ValidateCamera(camera, file->depth_kind.value_or(DepthKind::kCameraZ)).ok(),
          "a camera from a file can be used");
  const v1::Camera proto = CameraToProto(camera, file->depth_kind);
  PromiseMessage(proto);
  const absl::StatusOr<StatedCamera> read = CameraFromProto(proto);
  Promise(read.ok(), "a camera that was written can be read");
  Promise(read->camera.camera_from_world == camera.camera_from_world &&
              read->camera.screen_from_camera == camera.screen_from_camera &&
              read->depth_kind == file->depth_kind,
          "a camera that was written and read is the same");
}

}  // namespace
}  // namespace lightfit::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightfit;  // NOLINT(google-build-using-namespace)
  const absl::string_view json(reinterpret_cast<const char*>(data), size);
  for (const int frame : {0, 1}) {
    fuzz::PromiseCamera(ParseCameraJson(json, FrameNumber::Whole(frame)));
  }
  return 0;
}
