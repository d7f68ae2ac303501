// cli/flags/frame_flag.h
//
// --frame, for verbs that take a file with several cameras.
#pragma once

#include <optional>
#include <string>

#include "base/frame_number.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

// Declares it on `app`, to be parsed into `frame`, which must stay where it is.
void DeclareFrameFlag(CLI::App* app,
                      const std::string& group,
                      const std::string& meaning,
                      std::optional<FrameNumber>* frame);

}  // namespace lightfit::cli
