#include "io/image_exr_write.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStdIO.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/text_file.h"
#include "io/camera_header.h"
#include "io/exr_threads.h"
#include "wire/utf8.h"

namespace lightfit {
namespace {

constexpr size_t kMaxNameBytes = 255;  // OpenEXR's limit

absl::Status Validate(const Camera& camera, absl::Span<const ExrImage> images) {
  const auto num_pixels = static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height);
  std::set<std::string> names;
  for (const ExrImage& image : images) {
    if (image.channel.empty() || image.channel.size() > kMaxNameBytes ||
        !names.insert(image.channel).second) {
      return absl::InvalidArgumentError(
          absl::StrFormat("channel \"%s\": want distinct names of 1 to %d bytes",
                          image.channel.substr(0, 64),
                          kMaxNameBytes));
    }
    if (image.values.size() != num_pixels) {
      return absl::InvalidArgumentError(absl::StrFormat("channel \"%s\": %d pixels, want %d x %d",
                                                        image.channel,
                                                        image.values.size(),
                                                        camera.width,
                                                        camera.height));
    }
    if (!std::all_of(image.values.begin(), image.values.end(), [](float value) {
          return std::isfinite(value);
        })) {
      return absl::InvalidArgumentError(
          absl::StrCat("channel \"", image.channel, "\": a value is not finite"));
    }
  }
  return internal::CheckCameraAttributes(camera);
}

// The whole file: to memory first, as OpenEXR ends a file in a destructor, where a full disk would
// go unnoticed.
std::string BytesOf(const Camera& camera, absl::Span<const ExrImage> images) {
  Imf::Header header = internal::CameraHeader(camera);
  std::vector<std::vector<half>> masks;
  masks.reserve(images.size());
  Imf::FrameBuffer pixels;
  const auto insert = [&](const std::string& channel, Imf::PixelType type, const void* values) {
    header.channels().insert(channel, Imf::Channel(type));
    pixels.insert(channel, Imf::Slice::Make(type, values, header.dataWindow()));
  };
  for (const ExrImage& image : images) {
    if (image.is_mask) {
      masks.emplace_back(image.values.begin(), image.values.end());
      insert(image.channel, Imf::HALF, masks.back().data());
    } else {
      insert(image.channel, Imf::FLOAT, image.values.data());
    }
  }
  internal::StartExrThreads();
  Imf::StdOSStream bytes;
  {
    Imf::OutputFile file(bytes, header);
    file.setFrameBuffer(pixels);
    file.writePixels(camera.height);
  }
  return bytes.str();
}

}  // namespace

absl::Status WriteImageExr(const std::string& path,
                           const Camera& camera,
                           absl::Span<const ExrImage> images) {
  if (absl::Status status = Validate(camera, images); !status.ok()) return InFile(path, status);
  try {
    return WriteTextFileAtomically(path, BytesOf(camera, images));
  } catch (const std::exception& e) {
    return absl::UnknownError(
        absl::StrCat(path, ": cannot be written as OpenEXR: ", Utf8Text(e.what())));
  }
}

}  // namespace lightfit
