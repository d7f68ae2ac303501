// cli/render.h
//
// `lightfit render`: a read-back with exact depth and shadows, and a picture, from a scene.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace lightfit::cli {

// Declares the options; what it returns runs the verb and returns an ExitCode.
std::function<int()> DeclareRender(CLI::App* app);

}  // namespace lightfit::cli
