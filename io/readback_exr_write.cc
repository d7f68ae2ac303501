#include "io/readback_exr_write.h"

#include <OpenImageIO/imageio.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <set>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "io/camera_exr_input.h"

namespace lightfit {

namespace {

constexpr uint16_t kHalfOne = 0x3C00;  // 1 in half precision

// OpenEXR's limit of 255, less "shadow.".
constexpr size_t kMaxNameBytes = 248;

// The standard's camera space has x right and y up in the image, whatever ours has.
struct StandardMatrices {
  Eigen::Matrix4d camera_from_world, ndc_from_world;
  double pixel_aspect = 1.0;
};

StandardMatrices StandardMatricesOf(const Camera& camera) {
  const Eigen::Matrix3d& k = camera.screen_from_camera;
  Eigen::Matrix4d standard_from_camera = Eigen::Matrix4d::Identity();
  if (k(0, 0) < 0.0) standard_from_camera(0, 0) = -1.0;
  if (k(1, 1) > 0.0) standard_from_camera(1, 1) = -1.0;
  // Row 3 is not part of the 2D NDC; any that grows with depth and can be inverted will do.
  Eigen::Matrix4d ndc_from_camera = Eigen::Matrix4d::Zero();
  const int w_column = camera.orthographic ? 3 : 2;
  for (int row = 0; row < 2; ++row) {
    const double size = row == 0 ? camera.width : camera.height;
    ndc_from_camera(row, row) = k(row, row) * standard_from_camera(row, row) / size;
    ndc_from_camera(row, w_column) = k(row, 2) / size;
  }
  ndc_from_camera(2, 2) = 1.0;
  if (!camera.orthographic) ndc_from_camera(2, 3) = -1.0;
  ndc_from_camera(3, w_column) = 1.0;
  StandardMatrices matrices;
  matrices.camera_from_world = standard_from_camera * camera.camera_from_world;
  matrices.ndc_from_world = ndc_from_camera * matrices.camera_from_world;
  matrices.pixel_aspect = std::abs(k(1, 1) / k(0, 0));
  return matrices;
}

absl::Status Validate(const Readback& readback, absl::Span<const Light> lights) {
  if (absl::Status status = ValidateReadback(readback); !status.ok()) return status;
  if (readback.depth_kind != DepthKind::kCameraZ) {
    return absl::InvalidArgumentError(
        absl::StrCat("depth_kind = ", DepthKindName(readback.depth_kind), ", want camera z"));
  }
  std::set<std::string> names;
  for (const Light& light : lights) {
    if (absl::Status status = ValidateLight(light); !status.ok()) return status;
    if (light.name.empty() || !names.insert(light.name).second) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "light \"%s\": want distinct names that are not empty: they name channels", light.name));
    }
    if (light.name.size() > kMaxNameBytes) {
      return absl::InvalidArgumentError(
          absl::StrFormat("light \"%s...\": name has %d bytes, want at most %d in a channel name",
                          light.name.substr(0, 32),
                          light.name.size(),
                          kMaxNameBytes));
    }
  }
  const Eigen::Matrix3d& k = readback.camera.screen_from_camera;
  if (k(0, 1) != 0.0 || k(1, 0) != 0.0) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "camera: screen_from_camera has skew (%g, %g), want 0: worldToNDC cannot express it",
        k(0, 1),
        k(1, 0)));
  }
  return absl::OkStatus();
}

// Row vectors, in single and in double precision.
void AddMatrix(const std::string& name, const Eigen::Matrix4d& matrix, OIIO::ImageSpec* spec) {
  // The columns one after the other are the rows of the transpose.
  const Eigen::Matrix4f single = matrix.cast<float>();
  spec->attribute(name, OIIO::TypeDesc::TypeMatrix44, single.data());
  spec->attribute(internal::ExactName(name),
                  OIIO::TypeDesc(OIIO::TypeDesc::DOUBLE, OIIO::TypeDesc::MATRIX44),
                  matrix.data());
}

OIIO::ImageSpec SpecOf(const Readback& readback, absl::Span<const Light> lights) {
  OIIO::ImageSpec spec(readback.width(),
                       readback.height(),
                       1 + static_cast<int>(lights.size()),
                       OIIO::TypeDesc::FLOAT);
  spec.channelnames = {"Z"};
  spec.channelformats = {OIIO::TypeDesc::FLOAT};
  for (const Light& light : lights) {
    spec.channelnames.push_back(absl::StrCat("shadow.", light.name));
    spec.channelformats.emplace_back(OIIO::TypeDesc::HALF);
  }
  const StandardMatrices matrices = StandardMatricesOf(readback.camera);
  AddMatrix("worldToCamera", matrices.camera_from_world, &spec);
  AddMatrix("worldToNDC", matrices.ndc_from_world, &spec);
  spec.attribute("PixelAspectRatio", static_cast<float>(matrices.pixel_aspect));
  spec.attribute("compression", "zip");
  // Without one OpenImageIO writes the present time, and no two files would be the same.
  spec.attribute("DateTime", "");
  return spec;
}

// Native pixels, as the channels say: 4 bytes of depth, 2 of each shadow.
std::vector<char> PixelsOf(const Readback& readback, absl::Span<const Light> lights) {
  std::vector<char> bytes(readback.depth.size() *
                          (sizeof(float) + lights.size() * sizeof(uint16_t)));
  char* out = bytes.data();
  for (size_t i = 0; i < readback.depth.size(); ++i) {
    std::memcpy(out, &readback.depth[i], sizeof(float));
    out += sizeof(float);
    for (const Light& light : lights) {
      const bool is_shadowed = (readback.shadow_bits[i] >> light.shadow_bit & 1U) != 0;
      const uint16_t value = is_shadowed ? kHalfOne : 0;
      std::memcpy(out, &value, sizeof(value));
      out += sizeof(value);
    }
  }
  return bytes;
}

}  // namespace

absl::Status WriteReadbackExr(const std::string& path,
                              const Readback& readback,
                              absl::Span<const Light> lights) {
  if (absl::Status status = Validate(readback, lights); !status.ok()) return status;
  const auto failed = [&path](const std::string& why) {
    return absl::UnknownError(absl::StrCat(path, ": cannot be written: ", why));
  };
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("openexr");
  if (output == nullptr) return failed(OIIO::geterror());
  const OIIO::ImageSpec spec = SpecOf(readback, lights);
  const std::vector<char> pixels = PixelsOf(readback, lights);
  if (!output->open(path, spec) || !output->write_image(OIIO::TypeDesc::UNKNOWN, pixels.data()) ||
      !output->close()) {
    return failed(output->geterror());
  }
  return absl::OkStatus();
}

}  // namespace lightfit
