#include "fuzz/small_readback.h"

#include <Eigen/Core>
#include <cstdint>

#include "calls/pixel_buffer.h"
#include "io/lights_file.h"
#include "wire/camera_proto.h"

namespace lightfit::fuzz {
namespace {

constexpr int kStep = 9;  // odd, so that the middle of a block is the middle of a pixel

template <typename Word>
std::string BytesOf(const std::vector<Word>& words) {
  return {reinterpret_cast<const char*>(words.data()), sizeof(Word) * words.size()};
}

}  // namespace

SmallReadback SmallYard(const std::string& folder) {
  SmallReadback yard;
  yard.lights = ReadLightsFile(folder + "/scene.json").value();
  const ReadbackFile whole = ReadReadbackExr(folder + "/0001.exr", yard.lights).value();
  yard.lights.resize(2);
  ReadbackFile& file = yard.file;
  file.camera = whole.camera;
  file.camera.width /= kStep;
  file.camera.height /= kStep;
  file.camera.screen_from_camera.topRows<2>() /= kStep;
  for (int y = 0; y < file.camera.height; ++y) {
    for (int x = 0; x < file.camera.width; ++x) {
      const int from = (kStep * y + kStep / 2) * whole.camera.width + kStep * x + kStep / 2;
      file.depth.push_back(whole.depth[from]);
      file.shadow_bits.push_back(whole.shadow_bits[from] & 3U);
      // Made up, as the file has none.
      file.facing_bits.push_back(file.shadow_bits.back() | (y % 2 == 0 ? 1U : 2U));
      file.mapped_bits.push_back(x == 0 ? 1U : file.shadow_bits.back());
    }
  }
  file.facing_lights = 3;
  file.mapped_lights = 1;
  return yard;
}

v1::Readback MessageOf(const SmallReadback& yard) {
  v1::Readback readback;
  *readback.mutable_camera() = CameraToProto(yard.file.camera, yard.file.depth_kind);
  readback.set_depth(BytesOf(yard.file.depth));
  readback.set_shadow_bits(BytesOf(yard.file.shadow_bits));
  readback.set_facing_bits(BytesOf(yard.file.facing_bits));
  readback.set_mapped_bits(BytesOf(yard.file.mapped_bits));
  readback.set_mapped_lights(yard.file.mapped_lights);
  return readback;
}

void AddFineCover(const SmallReadback& yard, v1::Readback* readback) {
  const int width = yard.file.camera.width, height = yard.file.camera.height;
  std::vector<float> nearest;
  std::vector<uint32_t> shadow, lit;
  for (int y = 0; y < 2 * height; ++y) {
    for (int x = 0; x < 2 * width; ++x) {
      const int pixel = y / 2 * width + x / 2;
      nearest.push_back(yard.file.depth[pixel]);
      shadow.push_back(yard.file.shadow_bits[pixel]);
      lit.push_back(~yard.file.shadow_bits[pixel] & 3U);
    }
  }
  v1::FineCover& cover = *readback->mutable_fine_cover();
  cover.set_columns(2 * width);
  cover.set_rows(2 * height);
  cover.set_nearest(BytesOf(nearest));
  cover.set_furthest(BytesOf(nearest));
  cover.set_shadow_bits(BytesOf(shadow));
  cover.set_lit_bits(BytesOf(lit));
  cover.set_lit_lights(3);
}

void UseOtherForms(const SmallReadback& yard, v1::Readback* readback) {
  readback->set_depth_format(v1::DEPTH_FORMAT_FLOAT16);
  readback->set_shadow_format(v1::SHADOW_FORMAT_PLANES);
  std::vector<uint16_t> halves;
  for (const float depth : yard.file.depth) {
    halves.push_back(Eigen::numext::bit_cast<uint16_t>(Eigen::half(depth)));
  }
  readback->set_depth(BytesOf(halves));
  readback->clear_shadow_bits();
  readback->clear_facing_bits();
  const auto plane = [](const std::vector<uint32_t>& words, size_t light) {
    std::string bytes;
    for (const uint32_t word : words) bytes.push_back((word >> light & 1U) != 0 ? '\xff' : '\0');
    return bytes;
  };
  for (size_t l = 0; l < yard.lights.size(); ++l) {
    readback->add_shadow_planes(plane(yard.file.shadow_bits, l));
    readback->add_facing_planes(plane(yard.file.facing_bits, l));
  }
}

v1::FitStreamRequest PixelsOf(const v1::Readback& readback, size_t begin, size_t end) {
  v1::FitStreamRequest part;
  v1::PixelChunk& pixels = *part.mutable_pixels();
  pixels.set_depth(readback.depth().substr(begin, end - begin));
  pixels.set_shadow_bits(readback.shadow_bits().substr(begin, end - begin));
  pixels.set_facing_bits(readback.facing_bits().substr(begin, end - begin));
  pixels.set_mapped_bits(readback.mapped_bits().substr(begin, end - begin));
  return part;
}

void RemovePixels(v1::Readback* readback) {
  readback->set_facing_format(readback->facing_bits().empty() ? v1::SHADOW_FORMAT_PLANES
                                                              : v1::SHADOW_FORMAT_BITS);
  readback->set_mapped_format(v1::SHADOW_FORMAT_BITS);
  ClearPixels(readback);
}

}  // namespace lightfit::fuzz
