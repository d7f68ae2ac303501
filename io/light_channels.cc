#include "io/light_channels.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "wire/utf8.h"

namespace lightfit::internal {

namespace {

constexpr float kSetThreshold = 0.5F;

absl::StatusOr<NameFormat> ParseNameFormat(const char* kind, const std::string& format) {
  constexpr absl::string_view kPlaceholder = "{light}";
  const size_t place = format.find(kPlaceholder.data());
  if (place == std::string::npos || format.rfind(kPlaceholder.data()) != place) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s_channel_format = \"%s\", want {light} in it once, as in \"%s.{light}\"",
                        kind,
                        format,
                        kind));
  }
  return NameFormat{format.substr(0, place), format.substr(place + kPlaceholder.size())};
}

std::string ChannelOf(const Light& light, const NameFormat& format) {
  return absl::StrCat(format.prefix, light.name, format.suffix);
}

// The light of a channel of that name; empty where it is none of the format.
std::string LightOf(absl::string_view channel, const NameFormat& format) {
  const bool is_light =
      absl::ConsumePrefix(&channel, format.prefix) && absl::ConsumeSuffix(&channel, format.suffix);
  return is_light ? std::string(channel) : "";
}

absl::Status CheckSameSize(const OpenReadback& file, ChannelId other) {
  const ExrInput& exr = file.exr;
  const ChannelId depth = file.depth;
  if (exr.width(depth.part) == exr.width(other.part) &&
      exr.height(depth.part) == exr.height(other.part)) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      absl::StrFormat("%s: channel %s has %dx%d pixels, the depth %dx%d: "
                      "want one size",
                      exr.path(),
                      exr.quoted_name(other),
                      exr.width(other.part),
                      exr.height(other.part),
                      exr.width(depth.part),
                      exr.height(depth.part)));
}

absl::Status OfLight(const Light& light, const absl::Status& status) {
  if (status.ok()) return status;
  return absl::Status(status.code(),
                      absl::StrFormat("light \"%s\": %s", Utf8Text(light.name), status.message()));
}

// For messages: of a stereo file only what is in the depth's view counts.
std::string InView(const OpenReadback& file) {
  return file.view.empty() ? "" : absl::StrCat(" in the view ", QuotedList({file.view}));
}

// Sets the light's bit where its channel says so. NaN does not.
absl::Status AddBit(ExrInput& exr, ChannelId id, int shadow_bit, std::vector<uint32_t>& words) {
  const uint32_t bit = 1U << shadow_bit;
  if (exr.is_uint(id)) {
    const absl::StatusOr<std::vector<uint32_t>> values = exr.ReadUint(id);
    if (!values.ok()) return values.status();
    for (size_t i = 0; i < values->size(); ++i) words[i] |= (*values)[i] != 0 ? bit : 0;
    return absl::OkStatus();
  }
  const absl::StatusOr<std::vector<float>> values = exr.ReadFloat(id, 0.0F);
  if (!values.ok()) return values.status();
  for (size_t i = 0; i < values->size(); ++i) {
    words[i] |= (*values)[i] > kSetThreshold ? bit : 0;
  }
  return absl::OkStatus();
}

// The same for a channel of the read-back's size; what is wrong names the light.
absl::Status AddBitOfLight(const OpenReadback& file,
                           ChannelId id,
                           const Light& light,
                           std::vector<uint32_t>& words) {
  absl::Status status = CheckSameSize(file, id);
  if (status.ok()) status = AddBit(file.exr, id, light.shadow_bit, words);
  return OfLight(light, status);
}

absl::Status ReadShadowMask(const OpenReadback& file,
                            const std::string& channel,
                            std::vector<uint32_t>& shadow_bits) {
  const absl::StatusOr<std::optional<ChannelId>> id = file.Find(channel);
  if (!id.ok()) return id.status();
  if (!id->has_value()) {
    return absl::NotFoundError(
        absl::StrFormat("%s: shadow_bits_channel \"%s\" is not there%s; channels: %s",
                        file.exr.path(),
                        channel,
                        InView(file),
                        file.channels.QuotedByPart()));
  }
  if (absl::Status status = CheckSameSize(file, **id); !status.ok()) return status;
  absl::StatusOr<std::vector<uint32_t>> bits = file.exr.ReadUint(**id);
  if (!bits.ok()) return bits.status();
  shadow_bits = *std::move(bits);
  return absl::OkStatus();
}

absl::Status ReadShadowOfLight(const OpenReadback& file,
                               const Light& light,
                               const NameFormat& format,
                               const ReadbackExrOptions& options,
                               std::vector<uint32_t>& shadow_bits) {
  const auto named = options.shadow_channels.find(light.name);
  const std::string channel =
      named != options.shadow_channels.end() ? named->second : ChannelOf(light, format);
  const absl::StatusOr<std::optional<ChannelId>> id = file.Find(channel);
  if (!id.ok()) return OfLight(light, id.status());
  if (id->has_value()) return AddBitOfLight(file, **id, light, shadow_bits);
  return absl::NotFoundError(
      absl::StrFormat("light \"%s\": %s has no channel \"%s\"%s; lights with a shadow channel: %s; "
                      "all channels: %s",
                      Utf8Text(light.name),
                      file.exr.path(),
                      Utf8Text(channel),
                      InView(file),
                      QuotedList(LightsInFile(file.channels, format)),
                      file.channels.QuotedByPart()));
}

// Where the file has that channel of the light; else nothing happens.
absl::Status ReadOptionalOfLight(const OpenReadback& file,
                                 const Light& light,
                                 const NameFormat& format,
                                 std::vector<uint32_t>& words,
                                 uint32_t& lights) {
  const absl::StatusOr<std::optional<ChannelId>> id = file.Find(ChannelOf(light, format));
  if (!id.ok()) return OfLight(light, id.status());
  if (!id->has_value()) return absl::OkStatus();
  const int part = file.depth.part;
  words.resize(size_t{1} * file.exr.width(part) * file.exr.height(part), 0);
  absl::Status status = AddBitOfLight(file, **id, light, words);
  if (status.ok()) lights |= 1U << light.shadow_bit;
  return status;
}

}  // namespace

absl::StatusOr<NameFormats> ParseNameFormats(const ReadbackExrOptions& options) {
  absl::StatusOr<NameFormat> shadow = ParseNameFormat("shadow", options.shadow_channel_format);
  if (!shadow.ok()) return shadow.status();
  absl::StatusOr<NameFormat> facing = ParseNameFormat("facing", options.facing_channel_format);
  if (!facing.ok()) return facing.status();
  absl::StatusOr<NameFormat> mapped = ParseNameFormat("mapped", options.mapped_channel_format);
  if (!mapped.ok()) return mapped.status();
  return NameFormats{*std::move(shadow), *std::move(facing), *std::move(mapped)};
}

std::vector<std::string> LightsInFile(const ExrChannels& channels, const NameFormat& format) {
  std::vector<std::string> lights;
  for (const ExrChannel& channel : channels.all()) {
    std::string light = LightOf(channel.name, format);
    if (light.empty() && !channel.part.empty()) {
      light = LightOf(absl::StrCat(channel.part, ".", channel.name), format);
    }
    if (light.empty()) continue;
    if (std::find(lights.begin(), lights.end(), light) == lights.end()) lights.push_back(light);
  }
  return lights;
}

absl::Status ReadBits(const OpenReadback& open,
                      absl::Span<const Light> lights,
                      const NameFormats& formats,
                      const ReadbackExrOptions& options,
                      ReadbackFile& file) {
  file.light_status.assign(lights.size(), absl::OkStatus());
  file.shadow_bits.assign(file.depth.size(), 0);
  const bool has_mask = !options.shadow_bits_channel.empty();
  if (has_mask) {
    absl::Status status = ReadShadowMask(open, options.shadow_bits_channel, file.shadow_bits);
    if (!status.ok()) return status;
  }
  for (size_t l = 0; l < lights.size(); ++l) {
    const Light& light = lights[l];
    absl::Status status;
    if (!has_mask) {
      status = ReadShadowOfLight(open, light, formats.shadow, options, file.shadow_bits);
    }
    if (status.ok()) {
      status =
          ReadOptionalOfLight(open, light, formats.facing, file.facing_bits, file.facing_lights);
    }
    if (status.ok()) {
      status =
          ReadOptionalOfLight(open, light, formats.mapped, file.mapped_bits, file.mapped_lights);
    }
    file.light_status[l] = status;
  }
  if (file.facing_lights == 0) file.facing_bits.clear();
  if (file.mapped_lights == 0) file.mapped_bits.clear();
  return absl::OkStatus();
}

}  // namespace lightfit::internal
