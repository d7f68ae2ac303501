#include "fuzz/exr_variants.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfTiledOutputPart.h>

#include <cstdint>
#include <exception>
#include <iostream>
#include <utility>
#include <vector>

namespace lightfit::fuzz {
namespace {

struct Image {
  Imf::Header header;
  std::vector<float> depth;
  std::vector<half> shadow;
  std::vector<uint32_t> mask;  // all bits where there is shadow
};

Image ReadImage(const std::string& path) {
  Imf::InputFile file(path.c_str());
  Image image;
  image.header = file.header();
  const Imath::Box2i& window = image.header.dataWindow();
  const Imath::V2i size = window.size() + Imath::V2i(1);
  image.depth.resize(static_cast<size_t>(size.x) * size.y);
  image.shadow.resize(image.depth.size());
  auto channel = image.header.channels().begin();
  Imf::FrameBuffer pixels;
  pixels.insert(channel.name(), Imf::Slice::Make(Imf::FLOAT, image.depth.data(), window));
  ++channel;
  pixels.insert(channel.name(), Imf::Slice::Make(Imf::HALF, image.shadow.data(), window));
  file.setFrameBuffer(pixels);
  file.readPixels(window.min.y, window.max.y);
  for (const half value : image.shadow) image.mask.push_back(value > 0.5F ? ~uint32_t{0} : 0);
  return image;
}

struct Channel {
  const char* name;
  Imf::PixelType type;
  const void* pixels;
};

struct Part {
  const char* name;
  const char* view;  // empty: of no view
  std::vector<Channel> channels;
};

// The header says which compression, and whether there are tiles.
void WriteParts(const Imf::Header& header,
                const std::vector<Part>& parts,
                const std::string& path) {
  std::vector<Imf::Header> headers;
  std::vector<Imf::FrameBuffer> pixels;
  for (const auto& [name, view, channels] : parts) {
    Imf::Header& part = headers.emplace_back(header);
    part.setName(name);
    if (*view != '\0') part.setView(view);
    part.channels() = Imf::ChannelList();
    Imf::FrameBuffer& slices = pixels.emplace_back();
    for (const Channel& channel : channels) {
      part.channels().insert(channel.name, Imf::Channel(channel.type));
      slices.insert(channel.name,
                    Imf::Slice::Make(channel.type, channel.pixels, header.dataWindow()));
    }
  }
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), static_cast<int>(headers.size()));
  for (int i = 0; i < file.parts(); ++i) {
    if (header.type() == Imf::TILEDIMAGE) {
      Imf::TiledOutputPart part(file, i);
      part.setFrameBuffer(pixels[i]);
      part.writeTiles(0, part.numXTiles() - 1, 0, part.numYTiles() - 1);
    } else {
      Imf::OutputPart part(file, i);
      part.setFrameBuffer(pixels[i]);
      part.writePixels(header.dataWindow().size().y + 1);
    }
  }
}

// Depth in a part of its own, beside words of bits, and shadows.
void WriteVariant(const Imf::Header& header, const Image& image, const std::string& path) {
  WriteParts(header,
             {{"depth",
               "",
               {{"Z", Imf::FLOAT, image.depth.data()}, {"shadow", Imf::UINT, image.mask.data()}}},
              {"shadows",
               "",
               {{"shadow.key", Imf::HALF, image.shadow.data()},
                {"shadow.sun", Imf::HALF, image.shadow.data()}}}},
             path);
}

// Two views, shadows of one in a part of their own.
void WriteStereo(const Imf::Header& header, const Image& image, const std::string& path) {
  const Channel depth = {"Z", Imf::FLOAT, image.depth.data()};
  const Channel key = {"shadow.key", Imf::HALF, image.shadow.data()};
  const Channel sun = {"shadow.sun", Imf::HALF, image.shadow.data()};
  WriteParts(header,
             {{"left.depth", "left", {depth}},
              {"left.shadows", "left", {key, sun}},
              {"right", "right", {depth, key, sun}}},
             path);
}

}  // namespace

bool WriteExrVariants(const std::string& path, const std::string& folder) {
  constexpr std::pair<const char*, Imf::Compression> kCompressions[] = {
      {"none", Imf::NO_COMPRESSION},
      {"rle", Imf::RLE_COMPRESSION},
      {"zips", Imf::ZIPS_COMPRESSION},
      {"piz", Imf::PIZ_COMPRESSION},
      {"pxr24", Imf::PXR24_COMPRESSION},
      {"b44", Imf::B44_COMPRESSION},
      {"dwaa", Imf::DWAA_COMPRESSION}};
  try {
    const Image image = ReadImage(path);
    Imf::Header header = image.header;
    header.setType(Imf::SCANLINEIMAGE);
    for (const auto& [name, compression] : kCompressions) {
      header.compression() = compression;
      WriteVariant(header, image, folder + "/" + name);
    }
    header.compression() = Imf::ZIP_COMPRESSION;
    WriteStereo(header, image, folder + "/stereo");
    header.setType(Imf::TILEDIMAGE);
    header.setTileDescription(Imf::TileDescription(16, 16));
    WriteVariant(header, image, folder + "/zip_tiled");
  } catch (const std::exception& e) {
    std::cerr << path << ": " << e.what() << "\n";
    return false;
  }
  return true;
}

}  // namespace lightfit::fuzz
