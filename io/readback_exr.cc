#include "io/readback_exr.h"

#include <algorithm>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "geometry/affine_depth.h"
#include "io/camera_exr_input.h"
#include "io/exr_input.h"

namespace lightfit {

using internal::ChannelId;
using internal::ExrInput;
using internal::QuotedList;

namespace {

// What Cycles writes where nothing was hit; beyond kBackgroundDepth, and finite.
constexpr float kNothingHit = 1e10F;

constexpr float kSetThreshold = 0.5F;

float BackgroundDepth(DepthKind kind) {
  switch (kind) {
    case DepthKind::kCameraZ:
    case DepthKind::kDistance:
      return kNothingHit;
    case DepthKind::kNdcZeroToOne:
    case DepthKind::kNdcMinusOneToOne:
      return 1.0F;
    case DepthKind::kNdcReversedZeroToOne:
      return 0.0F;
  }
  return kNothingHit;
}

std::vector<std::string> AllChannels(const ExrInput& exr) {
  std::vector<std::string> names;
  for (int part = 0; part < exr.num_parts(); ++part) {
    names.insert(names.end(), exr.channels(part).begin(), exr.channels(part).end());
  }
  return names;
}

// The part of the name format before and after "{light}".
struct NameFormat {
  std::string prefix, suffix;
};

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

// How the channels of lights are named.
struct NameFormats {
  NameFormat shadow, facing, mapped;
};

absl::StatusOr<NameFormats> ParseNameFormats(const ReadbackExrOptions& options) {
  absl::StatusOr<NameFormat> shadow = ParseNameFormat("shadow", options.shadow_channel_format);
  if (!shadow.ok()) return shadow.status();
  absl::StatusOr<NameFormat> facing = ParseNameFormat("facing", options.facing_channel_format);
  if (!facing.ok()) return facing.status();
  absl::StatusOr<NameFormat> mapped = ParseNameFormat("mapped", options.mapped_channel_format);
  if (!mapped.ok()) return mapped.status();
  return NameFormats{*std::move(shadow), *std::move(facing), *std::move(mapped)};
}

std::string ChannelOf(const Light& light, const NameFormat& format) {
  return absl::StrCat(format.prefix, light.name, format.suffix);
}

std::vector<std::string> LightsInFile(const ExrInput& exr, const NameFormat& format) {
  std::vector<std::string> lights;
  for (const std::string& name : AllChannels(exr)) {
    if (name.size() <= format.prefix.size() + format.suffix.size() ||
        !absl::StartsWith(name, format.prefix) || !absl::EndsWith(name, format.suffix)) {
      continue;
    }
    const std::string light = name.substr(
        format.prefix.size(), name.size() - format.prefix.size() - format.suffix.size());
    if (std::find(lights.begin(), lights.end(), light) == lights.end()) lights.push_back(light);
  }
  return lights;
}

absl::StatusOr<ChannelId> FindDepth(const ExrInput& exr, const std::string& wanted) {
  if (!wanted.empty()) {
    if (std::optional<ChannelId> id = exr.Find(wanted, 0)) return *id;
    return absl::NotFoundError(
        absl::StrFormat("%s: depth_channel \"%s\" is not there; channels: %s",
                        exr.path(),
                        wanted,
                        QuotedList(AllChannels(exr))));
  }
  for (int part = 0; part < exr.num_parts(); ++part) {
    std::vector<ChannelId> candidates;
    std::vector<std::string> names;
    for (size_t channel = 0; channel < exr.channels(part).size(); ++channel) {
      const ChannelId id{part, static_cast<int>(channel)};
      if (exr.name(id) == "Z") return id;
      if (absl::EndsWith(exr.name(id), ".Z")) {
        candidates.push_back(id);
        names.push_back(exr.name(id));
      }
    }
    if (candidates.size() == 1) return candidates.front();
    if (candidates.size() > 1) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%s: depth may be any of the channels %s: name one as depth_channel",
                          exr.path(),
                          QuotedList(names)));
    }
  }
  return absl::NotFoundError(absl::StrFormat(
      "%s: has no channel \"Z\" or \"<layer>.Z\": render a depth channel, or name it as "
      "depth_channel; channels: %s",
      exr.path(),
      QuotedList(AllChannels(exr))));
}

absl::Status CheckSameSize(const ExrInput& exr, ChannelId depth, ChannelId other) {
  if (exr.width(depth.part) == exr.width(other.part) &&
      exr.height(depth.part) == exr.height(other.part)) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      absl::StrFormat("%s: channel %s is in a part of %dx%d pixels, the depth in one of %dx%d: "
                      "want one size",
                      exr.path(),
                      exr.quoted_name(other),
                      exr.width(other.part),
                      exr.height(other.part),
                      exr.width(depth.part),
                      exr.height(depth.part)));
}

absl::Status CheckShadowBits(absl::Span<const Light> lights) {
  uint32_t taken = 0;
  for (const Light& light : lights) {
    if (light.shadow_bit < 0 || light.shadow_bit >= kMaxLights ||
        (taken >> light.shadow_bit & 1U) != 0) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "light \"%s\": shadow_bit = %d, want 0 ... %d and a different one for every light",
          light.name,
          light.shadow_bit,
          kMaxLights - 1));
    }
    taken |= 1U << light.shadow_bit;
  }
  return absl::OkStatus();
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
absl::Status AddBitOfLight(ExrInput& exr,
                           ChannelId depth,
                           ChannelId id,
                           const Light& light,
                           std::vector<uint32_t>& words) {
  absl::Status status = CheckSameSize(exr, depth, id);
  if (status.ok()) status = AddBit(exr, id, light.shadow_bit, words);
  if (status.ok()) return status;
  return absl::Status(status.code(),
                      absl::StrFormat("light \"%s\": %s", light.name, status.message()));
}

absl::Status ReadShadowMask(ExrInput& exr,
                            ChannelId depth,
                            const std::string& channel,
                            std::vector<uint32_t>& shadow_bits) {
  const std::optional<ChannelId> id = exr.Find(channel, depth.part);
  if (!id) {
    return absl::NotFoundError(
        absl::StrFormat("%s: shadow_bits_channel \"%s\" is not there; channels: %s",
                        exr.path(),
                        channel,
                        QuotedList(AllChannels(exr))));
  }
  if (absl::Status status = CheckSameSize(exr, depth, *id); !status.ok()) return status;
  absl::StatusOr<std::vector<uint32_t>> bits = exr.ReadUint(*id);
  if (!bits.ok()) return bits.status();
  shadow_bits = *std::move(bits);
  return absl::OkStatus();
}

absl::Status ReadShadowOfLight(ExrInput& exr,
                               ChannelId depth,
                               const Light& light,
                               const NameFormat& format,
                               const ReadbackExrOptions& options,
                               std::vector<uint32_t>& shadow_bits) {
  const auto named = options.shadow_channels.find(light.name);
  const std::string channel =
      named != options.shadow_channels.end() ? named->second : ChannelOf(light, format);
  const std::optional<ChannelId> id = exr.Find(channel, depth.part);
  if (!id) {
    return absl::NotFoundError(
        absl::StrFormat("light \"%s\": %s has no channel \"%s\"; lights with a shadow channel: %s; "
                        "all channels: %s",
                        light.name,
                        exr.path(),
                        channel,
                        QuotedList(LightsInFile(exr, format)),
                        QuotedList(AllChannels(exr))));
  }
  return AddBitOfLight(exr, depth, *id, light, shadow_bits);
}

// Where the file has that channel of the light; else nothing happens.
absl::Status ReadOptionalOfLight(ExrInput& exr,
                                 ChannelId depth,
                                 const Light& light,
                                 const NameFormat& format,
                                 std::vector<uint32_t>& words,
                                 uint32_t& lights) {
  const std::optional<ChannelId> id = exr.Find(ChannelOf(light, format), depth.part);
  if (!id) return absl::OkStatus();
  words.resize(size_t{1} * exr.width(depth.part) * exr.height(depth.part), 0);
  absl::Status status = AddBitOfLight(exr, depth, *id, light, words);
  if (status.ok()) lights |= 1U << light.shadow_bit;
  return status;
}

absl::StatusOr<Camera> CameraFor(const ExrInput& exr,
                                 ChannelId depth,
                                 const ReadbackExrOptions& options) {
  if (!options.camera) return internal::CameraFromExr(exr, depth.part, options.camera_exr);
  if (options.camera->width != exr.width(depth.part) ||
      options.camera->height != exr.height(depth.part)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("camera: size = %dx%d, but the display window of %s is %dx%d: want the "
                        "camera of this image",
                        options.camera->width,
                        options.camera->height,
                        exr.path(),
                        exr.width(depth.part),
                        exr.height(depth.part)));
  }
  return *options.camera;
}

}  // namespace

Readback ReadbackFile::View() const {
  Readback readback;
  readback.camera = camera;
  readback.depth = depth;
  readback.depth_kind = depth_kind;
  readback.shadow_bits = shadow_bits;
  readback.facing_bits = facing_bits;
  readback.facing_lights = facing_lights;
  readback.mapped_bits = mapped_bits;
  readback.mapped_lights = mapped_lights;
  return readback;
}

absl::StatusOr<ReadbackFile> ReadReadbackExr(const std::string& path,
                                             absl::Span<const Light> lights,
                                             const ReadbackExrOptions& options) {
  if (absl::Status status = CheckShadowBits(lights); !status.ok()) return status;
  const absl::StatusOr<NameFormats> formats = ParseNameFormats(options);
  if (!formats.ok()) return formats.status();
  absl::StatusOr<ExrInput> exr = ExrInput::Open(path, options.max_pixels);
  if (!exr.ok()) return exr.status();
  const absl::StatusOr<ChannelId> depth_id = FindDepth(*exr, options.depth_channel);
  if (!depth_id.ok()) return depth_id.status();

  ReadbackFile file;
  absl::StatusOr<Camera> camera = CameraFor(*exr, *depth_id, options);
  if (!camera.ok()) return camera.status();
  file.camera = *std::move(camera);
  file.depth_kind = options.depth_kind;
  if (absl::Status status = ValidateCamera(file.camera, file.depth_kind); !status.ok()) {
    return absl::Status(status.code(), absl::StrCat(path, ": ", status.message()));
  }

  absl::StatusOr<std::vector<float>> depth =
      exr->ReadFloat(*depth_id, BackgroundDepth(options.depth_kind));
  if (!depth.ok()) return depth.status();
  file.depth = *std::move(depth);

  file.light_status.assign(lights.size(), absl::OkStatus());
  file.shadow_bits.assign(file.depth.size(), 0);
  if (!options.shadow_bits_channel.empty()) {
    absl::Status status =
        ReadShadowMask(*exr, *depth_id, options.shadow_bits_channel, file.shadow_bits);
    if (!status.ok()) return status;
  }
  for (size_t l = 0; l < lights.size(); ++l) {
    const Light& light = lights[l];
    absl::Status status;
    if (options.shadow_bits_channel.empty()) {
      status =
          ReadShadowOfLight(*exr, *depth_id, light, formats->shadow, options, file.shadow_bits);
    }
    if (status.ok()) {
      status = ReadOptionalOfLight(
          *exr, *depth_id, light, formats->facing, file.facing_bits, file.facing_lights);
    }
    if (status.ok()) {
      status = ReadOptionalOfLight(
          *exr, *depth_id, light, formats->mapped, file.mapped_bits, file.mapped_lights);
    }
    file.light_status[l] = status;
  }
  if (file.facing_lights == 0) file.facing_bits.clear();
  if (file.mapped_lights == 0) file.mapped_bits.clear();
  return file;
}

absl::StatusOr<std::vector<std::string>> ListShadowLights(const std::string& path,
                                                          const ReadbackExrOptions& options) {
  const absl::StatusOr<NameFormat> format =
      ParseNameFormat("shadow", options.shadow_channel_format);
  if (!format.ok()) return format.status();
  const absl::StatusOr<ExrInput> exr = ExrInput::Open(path, options.max_pixels);
  if (!exr.ok()) return exr.status();
  return LightsInFile(*exr, *format);
}

}  // namespace lightfit
