// cli/flags/compare_flags.h
//
// The options of `lightfit compare` as they stand on the command line.
// In:   words; a wrong one is refused while parsing (exit code 1).
// Out:  CompareFlags.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/flags/fit_flags.h"
#include "cli/flags/scene_flags.h"
#include "jobs/compare/camera_step.h"
#include "jobs/compare/rows.h"
#include "picture/compare_choice.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

// --matrix NAME=FILE.
struct MatrixFlag {
  std::string name, path;
};

// Where crawl is measured to.
struct CrawlFlags {
  bool is_wanted = false;          // --crawl, or any of the others
  std::optional<int> next_frame;   // of the --camera scene file
  std::optional<CameraStep> step;  // absent: DefaultCameraStep()
  std::string next_readback_path;
};

inline constexpr int kDefaultScreenHeight = 750;  // pixels

struct CompareFlags {
  SceneFlags scene;  // its positional may be a read-back

  // FitFlags::options are those of "lightfit"; of the rest only what says how a read-back is to be
  // understood.
  FitFlags fit;

  std::optional<PixelSize> screen;    // absent: DefaultImageSize(), kDefaultScreenHeight high
  std::optional<PixelSize> readback;  // absent: DefaultReadbackSize()
  MapSize map = FitFlags().map;
  std::vector<MatrixFlag> matrices;
  JudgeOptions judge = CompareOptions().judge;
  CrawlFlags crawl;

  bool per_light = false;
  std::string csv_path;
  std::string json_path;
  std::string picture_path;
  std::string picture_light;  // empty: MostTellingLight()
  Bias picture_bias = Bias::kIdeal;
  std::string masks_path;  // a folder
  bool legend = false;     // say what the columns of tables mean
  bool quiet = false;

  bool is_readback() const;  // rather than a scene
};

// Declares every option on `app`, to be parsed into `flags`, which must stay where it is.
void DeclareCompareFlags(CLI::App* app, CompareFlags* flags);

// Of them --screen, --readback and --map, for verbs that judge on a scene too.
void DeclareSizeFlags(CLI::App* app, CompareFlags* flags);

// "engine=matrices.json". The name must not be that of a row which is there already.
absl::StatusOr<MatrixFlag> ParseMatrixFlag(const std::string& text);

// As many pixels as 180x180 in the screen's ratio of width to height.
PixelSize DefaultReadbackSize(PixelSize screen);

}  // namespace lightfit::cli
