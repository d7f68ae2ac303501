#include "io/readback_exr_write.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStdIO.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <exception>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/text_file.h"
#include "io/camera_exr_input.h"
#include "io/exr_threads.h"
#include "wire/utf8.h"

namespace lightfit {

namespace {

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
                          Utf8Text(light.name.substr(0, 32)),
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
void AddMatrix(const std::string& name, const Eigen::Matrix4d& matrix, Imf::Header* header) {
  Imath::M44d rows;
  for (int i = 0; i < 16; ++i) rows[i / 4][i % 4] = matrix(i % 4, i / 4);
  header->insert(name, Imf::M44fAttribute(Imath::M44f(rows)));
  header->insert(internal::ExactName(name), Imf::M44dAttribute(rows));
}

// A channel of one light.
struct BitChannel {
  std::string name;
  absl::Span<const uint32_t> words;
  int bit;
};

std::vector<BitChannel> BitChannelsOf(const Readback& readback, absl::Span<const Light> lights) {
  std::vector<BitChannel> channels;
  const auto add = [&](const char* kind, absl::Span<const uint32_t> words, const Light& light) {
    channels.push_back({absl::StrCat(kind, ".", light.name), words, light.shadow_bit});
  };
  for (const Light& light : lights) {
    add("shadow", readback.shadow_bits, light);
    if (readback.KnowsFacing(light.shadow_bit)) add("facing", readback.facing_bits, light);
    if (readback.KnowsMapped(light.shadow_bit)) add("mapped", readback.mapped_bits, light);
  }
  return channels;
}

Imf::Header HeaderOf(const Readback& readback, const std::vector<BitChannel>& channels) {
  const StandardMatrices matrices = StandardMatricesOf(readback.camera);
  Imf::Header header(
      readback.width(), readback.height(), static_cast<float>(matrices.pixel_aspect));
  header.compression() = Imf::ZIP_COMPRESSION;
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  for (const BitChannel& channel : channels) {
    header.channels().insert(channel.name, Imf::Channel(Imf::HALF));
  }
  AddMatrix("worldToCamera", matrices.camera_from_world, &header);
  AddMatrix("worldToNDC", matrices.ndc_from_world, &header);
  return header;
}

std::vector<half> ValuesOf(const BitChannel& channel) {
  std::vector<half> values;
  values.reserve(channel.words.size());
  for (const uint32_t word : channel.words) {
    values.emplace_back((word >> channel.bit & 1U) != 0 ? 1.0F : 0.0F);
  }
  return values;
}

// The whole file: to memory first, as OpenEXR ends a file in a destructor, where a full disk would
// go unnoticed.
std::string BytesOf(const Readback& readback, absl::Span<const Light> lights) {
  const std::vector<BitChannel> channels = BitChannelsOf(readback, lights);
  const Imf::Header header = HeaderOf(readback, channels);
  const auto slice = [&header](Imf::PixelType type, const void* pixels) {
    return Imf::Slice::Make(type, pixels, header.dataWindow());
  };
  std::vector<std::vector<half>> values;
  Imf::FrameBuffer pixels;
  pixels.insert("Z", slice(Imf::FLOAT, readback.depth.data()));
  for (const BitChannel& channel : channels) {
    values.push_back(ValuesOf(channel));
    pixels.insert(channel.name, slice(Imf::HALF, values.back().data()));
  }
  internal::StartExrThreads();
  Imf::StdOSStream bytes;
  {
    Imf::OutputFile file(bytes, header);
    file.setFrameBuffer(pixels);
    file.writePixels(readback.height());
  }
  return bytes.str();
}

}  // namespace

absl::Status WriteReadbackExr(const std::string& path,
                              const Readback& readback,
                              absl::Span<const Light> lights) {
  if (absl::Status status = Validate(readback, lights); !status.ok()) return status;
  try {
    return WriteTextFileAtomically(path, BytesOf(readback, lights));
  } catch (const std::exception& e) {
    return absl::UnknownError(
        absl::StrCat(path, ": cannot be written as OpenEXR: ", Utf8Text(e.what())));
  }
}

}  // namespace lightfit
