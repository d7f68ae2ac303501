#include "fuzz/exr_variants.h"

#include <OpenImageIO/imageio.h>

#include <iostream>
#include <vector>

namespace lightfit::fuzz {
namespace {

bool WriteVariant(const OIIO::ImageSpec& spec,
                  const std::vector<float>& pixels,
                  const std::string& path) {
  OIIO::ImageSpec depth = spec;
  depth.nchannels = 2;
  depth.channelnames = {"Z", "shadow"};
  depth.channelformats = {OIIO::TypeDesc::FLOAT, OIIO::TypeDesc::UINT32};
  depth.attribute("oiio:subimagename", "depth");
  OIIO::ImageSpec shadows = depth;
  shadows.channelnames = {"shadow.key", "shadow.sun"};
  shadows.channelformats = {OIIO::TypeDesc::HALF, OIIO::TypeDesc::HALF};
  shadows.attribute("oiio:subimagename", "shadows");
  const OIIO::ImageSpec parts[] = {depth, shadows};
  const auto output = OIIO::ImageOutput::create("openexr");
  const bool is_written =
      output->open(path, 2, parts) && output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) &&
      output->open(path, shadows, OIIO::ImageOutput::AppendSubimage) &&
      output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) && output->close();
  if (!is_written) std::cerr << path << ": " << output->geterror() << "\n";
  return is_written;
}

}  // namespace

bool WriteExrVariants(const std::string& path, const std::string& folder) {
  const auto input = OIIO::ImageInput::create("openexr");
  OIIO::ImageSpec spec;
  std::vector<float> pixels;
  if (input->open(path, spec)) pixels.resize(spec.image_pixels() * 2);
  if (pixels.empty() || !input->read_image(0, 0, 0, 2, OIIO::TypeDesc::FLOAT, pixels.data())) {
    std::cerr << path << ": " << input->geterror() << "\n";
    return false;
  }
  for (const char* compression : {"none", "rle", "zips", "piz", "pxr24", "b44", "dwaa"}) {
    spec.attribute("compression", compression);
    if (!WriteVariant(spec, pixels, folder + "/" + compression)) return false;
  }
  spec.attribute("compression", "zip");
  spec.tile_width = spec.tile_height = 16;
  return WriteVariant(spec, pixels, folder + "/zip_tiled");
}

}  // namespace lightfit::fuzz
