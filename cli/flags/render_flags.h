// cli/flags/render_flags.h
//
// The options of `lightfit render` as they stand on the command line.
// In:   words; a wrong one is refused while parsing (exit code 1).
// Out:  RenderFlags.
#pragma once

#include <string>

#include "cli/flags/scene_flags.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

inline constexpr int kDefaultReadbackHeight = 180;  // pixels

struct RenderFlags {
  SceneFlags scene;
  PixelSize size;  // 0x0: DefaultImageSize(), kDefaultReadbackHeight high
  std::string output_path;
  std::string picture_path;
  PixelSize picture_size;  // 0x0: as `size`
  std::string picture_light;
  std::string lights_path;
  bool quiet = false;
};

// Declares every option on `app`, to be parsed into `flags`, which must stay where it is.
void DeclareRenderFlags(CLI::App* app, RenderFlags* flags);

}  // namespace lightfit::cli
