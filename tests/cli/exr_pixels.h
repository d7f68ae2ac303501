// tests/cli/exr_pixels.h
//
// The pixels of an EXR file of one part, read through OpenEXR alone.
// In:   a path.
// Out:  every channel as floats, by its name, row-major.
#pragma once

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>

#include <map>
#include <string>
#include <vector>

namespace lightfit {

struct ExrPixels {
  int width = 0, height = 0;
  std::map<std::string, std::vector<float>> channels;

  double Sum(const std::string& channel) const {
    double sum = 0.0;
    for (const float value : channels.at(channel)) sum += value;
    return sum;
  }
};

inline ExrPixels ReadExrPixels(const std::string& path) {
  Imf::InputFile file(path.c_str());
  const Imath::Box2i window = file.header().dataWindow();
  ExrPixels pixels;
  pixels.width = window.max.x - window.min.x + 1;
  pixels.height = window.max.y - window.min.y + 1;
  Imf::FrameBuffer buffer;
  const Imf::ChannelList& list = file.header().channels();
  for (auto channel = list.begin(); channel != list.end(); ++channel) {
    std::vector<float>& values = pixels.channels[channel.name()];
    values.resize(static_cast<size_t>(pixels.width) * pixels.height);
    buffer.insert(channel.name(), Imf::Slice::Make(Imf::FLOAT, values.data(), window));
  }
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  return pixels;
}

}  // namespace lightfit
