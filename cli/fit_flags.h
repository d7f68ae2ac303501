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
#include "cli/light_flags.h"
#include "geometry/clip.h"
#include "io/camera_exr.h"
#include "optimizer/fit_options.h"

namespace lightfit {

struct FitFlags {
  std::string readback_path;

  LightFlags lights;
  std::vector<std::string> only;  // names; empty: all

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

// Parts of it, for verbs that fit or read a read-back too: what its channels mean; what the
// camera's attributes in its header mean; how it is fitted.
void DeclareReadbackFlags(CLI::App* app, const std::string& group, FitFlags* flags);
void DeclareCameraExrFlags(CLI::App* app, const std::string& group, CameraExrOptions* camera);
void DeclareMethodFlags(CLI::App* app, FitOptions* options);

// "1024x512"; both at least 1 and at most 65536.
absl::StatusOr<MapSize> ParseMapSize(const std::string& text);

}  // namespace lightfit
