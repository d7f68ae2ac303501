// OpenEXR files: cameras, and read-backs with a plane per light and with a mask.
#include <algorithm>
#include <string>
#include <vector>

#include "fuzz/memory_file.h"
#include "fuzz/promises.h"
#include "io/camera_exr.h"
#include "io/readback_exr.h"
#include "wire/camera_proto.h"

namespace lightfit::fuzz {
namespace {

void PromiseCamera(const Camera& camera) {
  Promise(ValidateCamera(camera).ok(), "a camera from a file can be used");
  PromiseMessage(CameraToProto(camera));
}

void PromiseReadback(const absl::StatusOr<ReadbackFile>& file, size_t num_lights) {
  PromiseOkOrError(file.status());
  if (!file.ok()) return;
  PromiseCamera(file->camera);
  Promise(ValidateReadback(file->View()).ok(), "a read-back from a file can be used");
  Promise(file->light_status.size() == num_lights, "each light has a status");
  for (const absl::Status& status : file->light_status) PromiseOkOrError(status);
}

std::vector<Light> LightsNamed(std::vector<std::string> names) {
  names.emplace_back("sun");  // often not there
  std::vector<Light> lights;
  for (const std::string& name : names) {
    if (lights.size() == kMaxLights) break;
    lights.push_back(Light::Point(name, Eigen::Vector3d::UnitX(), static_cast<int>(lights.size())));
  }
  return lights;
}

}  // namespace
}  // namespace lightfit::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightfit;  // NOLINT(google-build-using-namespace)
  const fuzz::MemoryFile file(data, size);
  ReadbackExrOptions options;
  options.max_pixels = 1 << 14;
  const absl::StatusOr<std::vector<std::string>> names = ListShadowLights(file.path(), options);
  fuzz::PromiseOkOrError(names.status());
  if (names.ok()) {
    const std::vector<Light> lights = fuzz::LightsNamed(*names);
    fuzz::PromiseReadback(ReadReadbackExr(file.path(), lights, options), lights.size());
    options.shadow_bits_channel = "shadow";
    fuzz::PromiseReadback(ReadReadbackExr(file.path(), lights, options), lights.size());
    options.shadow_bits_channel.clear();
    options.view = "left";
    fuzz::PromiseReadback(ReadReadbackExr(file.path(), lights, options), lights.size());
  }
  const absl::StatusOr<Camera> camera = ReadCameraExr(file.path());
  fuzz::PromiseOkOrError(camera.status());
  if (camera.ok()) fuzz::PromiseCamera(*camera);
  return 0;
}
