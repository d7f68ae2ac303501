// tests/io/exr_file.h
//
// EXR files for the tests of io/: written through OpenEXR, as a renderer would.
#pragma once

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace lightfit::testing {

// A channel of an EXR part: name, type, and its value at a pixel of the data window.
struct Channel {
  std::string name;
  Imf::PixelType type = Imf::FLOAT;
  std::function<double(int x, int y)> value;
};

struct ExrPart {
  int width = 8, height = 6;                                    // display window
  int data_x = 0, data_y = 0, data_width = 8, data_height = 6;  // data window
  std::vector<Channel> channels;
  std::vector<std::pair<std::string, Eigen::Matrix4d>> matrices;  // rows as stored
  std::vector<std::pair<std::string, std::string>> strings;       // attributes
  float pixel_aspect = 1.0F;
  std::string name = "part";
  std::string view;                     // of a stereo file; empty: the part does not say
  std::vector<std::string> multi_view;  // likewise, of a part that has several
};

inline Imf::Header HeaderOf(const ExrPart& part) {
  const Imath::V2i data_begin(part.data_x, part.data_y);
  const Imath::V2i data_size(part.data_width, part.data_height);
  Imf::Header header(Imath::Box2i({0, 0}, {part.width - 1, part.height - 1}),
                     Imath::Box2i(data_begin, data_begin + data_size - Imath::V2i(1)),
                     part.pixel_aspect);
  header.compression() = Imf::ZIP_COMPRESSION;
  header.setName(part.name);  // a multi-part file must tell parts apart
  header.setType(Imf::SCANLINEIMAGE);
  if (!part.view.empty()) header.setView(part.view);
  if (!part.multi_view.empty()) Imf::addMultiView(header, part.multi_view);
  for (const Channel& channel : part.channels) {
    header.channels().insert(channel.name, Imf::Channel(channel.type));
  }
  for (const auto& [name, matrix] : part.matrices) {
    Imath::M44f rows;
    for (int i = 0; i < 16; ++i) rows[i / 4][i % 4] = static_cast<float>(matrix(i / 4, i % 4));
    header.insert(name, Imf::M44fAttribute(rows));
  }
  for (const auto& [name, text] : part.strings) header.insert(name, Imf::StringAttribute(text));
  return header;
}

// The channel over the data window, as its type has it.
inline std::vector<char> NativePixels(const ExrPart& part, const Channel& channel) {
  std::vector<char> bytes;
  const auto put = [&bytes](const auto& value) {
    const char* begin = reinterpret_cast<const char*>(&value);
    bytes.insert(bytes.end(), begin, begin + sizeof(value));
  };
  for (int y = part.data_y; y < part.data_y + part.data_height; ++y) {
    for (int x = part.data_x; x < part.data_x + part.data_width; ++x) {
      const double value = channel.value(x, y);
      if (channel.type == Imf::UINT) {
        put(static_cast<uint32_t>(value));
      } else if (channel.type == Imf::HALF) {
        put(half(static_cast<float>(value)));
      } else {
        put(static_cast<float>(value));
      }
    }
  }
  return bytes;
}

// Writes the parts; a file with several is a multi-part file.
inline void WriteExr(const std::string& path,
                     const std::vector<ExrPart>& parts,
                     Imf::Compression compression = Imf::ZIP_COMPRESSION) {
  std::vector<Imf::Header> headers;
  for (const ExrPart& part : parts) {
    headers.push_back(HeaderOf(part));
    headers.back().compression() = compression;
  }
  const int count = static_cast<int>(headers.size());
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), count);
  for (int i = 0; i < count; ++i) {
    std::vector<std::vector<char>> channels;
    Imf::FrameBuffer pixels;
    for (const Channel& channel : parts[i].channels) {
      channels.push_back(NativePixels(parts[i], channel));
      pixels.insert(
          channel.name,
          Imf::Slice::Make(channel.type, channels.back().data(), headers[i].dataWindow()));
    }
    Imf::OutputPart output(file, i);
    output.setFrameBuffer(pixels);
    output.writePixels(parts[i].data_height);
  }
}

}  // namespace lightfit::testing
