// cli/flags/fit_flags.h
//
// The options of `lightfit fit` as they stand on the command line.
// In:   words; a wrong one is refused while parsing (exit code 1).
// Out:  FitFlags.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "base/frame_number.h"
#include "cli/flags/light_flags.h"
#include "cli/flags/plan_flags.h"
#include "geometry/clip.h"
#include "io/camera_exr.h"
#include "optimizer/fit_options.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

struct FitFlags {
  std::string readback_path;               // or:
  std::vector<std::string> summary_paths;  // --summary, which has lights and samples in it

  LightFlags lights;
  std::vector<std::string> only;  // names; empty: all

  MapSize map = {1024, 1024};
  FitOptions options;
  bool has_metric = false, has_cover = false, has_border = false;  // whether they were given
  bool as_published = false;
  PlanFlags plan;
  ClipConvention clip = ClipConvention::Vulkan();

  std::optional<DepthKind> depth_kind;  // absent: the camera file's, or kCameraZ
  std::optional<float> background;      // absent: looked for
  std::string depth_channel;
  std::string view;  // of a stereo file
  std::string shadow_channel_format;
  std::string shadow_bits_channel;
  std::string cover_readback_path;  // the same view finer, for the cover
  std::string facing_channel_format;
  std::string mapped_channel_format;

  std::string camera_path;
  std::optional<FrameNumber> frame;  // of the camera file; absent: by the read-back's own number
  CameraExrOptions camera_exr;

  std::string json_path;
  std::string csv_path;
  std::string picture_path;
  std::string footprint_path;
  bool legend = false;  // say what the columns of tables mean
  bool quiet = false;
};

// Declares every option on `app`, to be parsed into `flags`, which must stay where it is; those
// that do not go together are refused.
void DeclareFitFlags(CLI::App* app, FitFlags* flags);

// Parts of it, for verbs that fit too (readback_flags.h has those about the read-back): which of
// the lights; how a light is fitted, and of that what its samples are summed by; the map's size and
// clip space; clip space alone; whether tables are explained. The border that `options` has when
// the method is declared is the default.
void DeclareOnlyFlag(CLI::App* app, const std::string& group, std::vector<std::string>* only);
void DeclareMethodFlags(CLI::App* app, FitOptions* options);
void DeclareSummingFlags(CLI::App* app, FitOptions* options);
void DeclareMapFlags(CLI::App* app, const std::string& group, FitFlags* flags);
void DeclareClipFlag(CLI::App* app, const std::string& group, ClipConvention* clip);
void DeclareLegendFlag(CLI::App* app, const std::string& group, bool* legend);

// For verbs that take a read-back or summaries: throws CLI::ValidationError unless it is one of the
// two, and with summaries no option of the groups that are about a read-back.
void CheckSource(const CLI::App& app,
                 const FitFlags& flags,
                 const std::vector<std::string>& readback_groups);

}  // namespace lightfit::cli
