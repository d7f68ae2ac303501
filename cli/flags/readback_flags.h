// cli/flags/readback_flags.h
//
// What a read-back's file means, for all verbs that read one: its channels, its camera.
// In:   words; a wrong one is refused while parsing (exit code 1).
// Out:  the fields of FitFlags that fit_inputs.h and frame_inputs.h read files by.
#pragma once

#include <string>

#include "cli/flags/fit_flags.h"
#include "io/camera_exr.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

// What its channels mean, and which of its parts and views.
void DeclareReadbackFlags(CLI::App* app, const std::string& group, FitFlags* flags);

// The same frame finer.
void DeclareCoverReadbackFlag(CLI::App* app, const std::string& group, FitFlags* flags);

// Its camera; of that what the attributes in its header mean.
void DeclareCameraFlags(CLI::App* app, const std::string& group, FitFlags* flags);
void DeclareCameraExrFlags(CLI::App* app, const std::string& group, CameraExrOptions* camera);

}  // namespace lightfit::cli
