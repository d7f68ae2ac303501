// io/readback_exr.h
//
// Read-backs from OpenEXR files, as renderers write them.
// In:   an EXR file with a depth channel and shadow channels, the lights, and what the file means.
// Out:  ReadbackFile: depth, bits and camera, owned; where they were found; one status per light.
//
// Depth is the channel "Z" or one that is called depth, in any part (io/exr/depth.h): a Z that
// stands beside an X is a vector's, and two that are equally good are refused. Shadows are one
// channel per light, "shadow.<light>", above 0.5 where that light is blocked, or one UINT channel
// of bits. Optional, per light as well: "facing.<light>", above 0.5 where the surface faces the
// light, and "mapped.<light>", where the map that is drawn with says shadow. They may lie in any
// part of the depth's size.
//
// A channel that an option names is CHANNEL, of the depth's part if it has one, or PART.CHANNEL. Of
// a stereo file depth, bits and camera are of one view, whose name may be left out of those of
// channels and parts.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/camera.h"
#include "geometry/light.h"
#include "io/camera_exr.h"
#include "io/notes/readback_warnings.h"
#include "io/readback_origin.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

struct ReadbackExrOptions {
  DepthKind depth_kind = DepthKind::kCameraZ;

  // Where the background begins: as Readback::background.
  std::optional<float> background;

  // Empty: the best by io/exr/depth.h: "Z", "depth", "ViewLayer.Depth.Z", "depth.V" and so on.
  std::string depth_channel;

  // The view of a stereo file: "left". Empty: the only one that has a depth.
  std::string view;

  // The shadow channel of a light; "{light}" stands for the light's name, once.
  std::string shadow_channel_format = "shadow.{light}";

  // Light name to channel name, for lights that do not follow the format.
  std::map<std::string, std::string> shadow_channels;

  // Not empty: all shadows are in this one UINT channel, light l in bit Light::shadow_bit.
  std::string shadow_bits_channel;

  // The same for the optional channels: Readback::facing_bits and mapped_bits.
  std::string facing_channel_format = "facing.{light}";
  std::string mapped_channel_format = "mapped.{light}";

  // Set: this camera; its size must be the display window's. Else: the file's attributes, which
  // `camera_exr` says how to read.
  std::optional<Camera> camera;
  CameraExrOptions camera_exr;

  // Files that declare more pixels than this (display or data window) are refused unread. >= 1.
  int64_t max_pixels = int64_t{64} << 20;
};

struct ReadbackFile {
  ReadbackOrigin origin;
  Camera camera;
  DepthKind depth_kind = DepthKind::kCameraZ;
  std::optional<float> background;    // as stated, or looked for
  std::vector<float> depth;           // row-major, top row first, the display window
  std::vector<uint32_t> shadow_bits;  // likewise; light l in bit lights[l].shadow_bit

  // Likewise; empty where no light has such a channel. `..._lights` has the bits of those that do.
  std::vector<uint32_t> facing_bits, mapped_bits;
  uint32_t facing_lights = 0, mapped_lights = 0;

  // Element l belongs to lights[l]: ok, or why its channels could not be read (NotFound lists those
  // there are, when it is the shadow that is missing). The other lights are good to use.
  std::vector<absl::Status> light_status;

  // What may be a mistake (io/notes/readback_warnings.h).
  std::vector<ReadbackWarning> warnings;

  // Refers to this object's buffers.
  Readback View() const;
};

// Reads one file. Fails as a whole when the file, its depth or its camera cannot be used; a light
// without a shadow channel, or with an optional one that cannot be read, fails alone, in
// light_status. Outside the data window there is background, no shadow and nothing that faces a
// light; what lies outside the display window is dropped. Each light needs its
// own shadow_bit; ReadLightsFile() numbers them in order.
absl::StatusOr<ReadbackFile> ReadReadbackExr(const std::string& path,
                                             absl::Span<const Light> lights,
                                             const ReadbackExrOptions& options = {});

// Names of the lights that have a channel of the form `shadow_channel_format`, in file order.
absl::StatusOr<std::vector<std::string>> ListShadowLights(const std::string& path,
                                                          const ReadbackExrOptions& options = {});

}  // namespace lightfit
