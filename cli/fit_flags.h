// cli/fit_flags.h
//
// The options of `lightfit fit` as they stand on the command line.
// In:   words; a wrong one is refused while parsing (exit code 1).
// Out:  FitFlags.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/optional.h"
#include "geometry/clip.h"
#include "geometry/light.h"
#include "io/camera_exr.h"
#include "optimizer/fit_options.h"

namespace lightfit {

struct FitFlags {
  std::string readback_path;

  std::string lights_path;
  std::vector<Light> extra_lights;  // --light; replace those of the file by name
  std::vector<std::string> only;    // names; empty: all

  MapSize map = {1024, 1024};
  FitOptions options;
  bool as_published = false;
  ClipConvention clip = ClipConvention::Vulkan();

  absl::optional<DepthKind> depth_kind;  // absent: the camera file's, or kCameraZ
  std::string depth_channel;
  std::string shadow_channel_format;
  std::string shadow_bits_channel;

  std::string camera_path;
  int frame = 0;
  CameraExrOptions camera_exr;

  std::string json_path;
  std::string picture_path;
  bool quiet = false;
};

// Declares every option on `app`, to be parsed into `flags`, which must stay where it is.
void DeclareFitFlags(CLI::App* app, FitFlags* flags);

// "1024x512"; both at least 1 and at most 65536.
absl::StatusOr<MapSize> ParseMapSize(const std::string& text);

}  // namespace lightfit
