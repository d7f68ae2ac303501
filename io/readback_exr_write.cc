#include "io/readback_exr_write.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <cstdint>
#include <exception>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/text_file.h"
#include "io/camera_header.h"
#include "io/exr/threads.h"
#include "io/header_lights.h"
#include "wire/utf8.h"

namespace lightfit {

namespace {

// OpenEXR's limit of 255, less "shadow.".
constexpr size_t kMaxNameBytes = 248;

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
  return internal::CheckCameraAttributes(readback.camera);
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

Imf::Header HeaderOf(const Readback& readback,
                     absl::Span<const Light> lights,
                     const std::vector<BitChannel>& channels) {
  Imf::Header header = internal::CameraHeader(readback.camera);
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  for (const BitChannel& channel : channels) {
    header.channels().insert(channel.name, Imf::Channel(Imf::HALF));
  }
  // Names that are not UTF-8 can stand in no JSON: such a file says nothing of its lights.
  if (const absl::StatusOr<std::string> json = LightsForHeader(lights); json.ok()) {
    header.insert(std::string(kLightsAttribute), Imf::StringAttribute(*json));
  }
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
  const Imf::Header header = HeaderOf(readback, lights, channels);
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
