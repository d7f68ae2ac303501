// io/notes/readback_warnings.h
//
// Inputs that are wrong but plausible: read as they are, and told.
// In:   a read-back and its lights; what its file says of both.
// Out:  warnings, one line each, with the way out.
//
// What can be told cheaply: a background that is a finite depth; depths that are none, but 1/z or
// normalised; shadows that contradict the depth, as a pass that is the wrong way round and lights
// of another scene do; lights and a camera that differ from those in the file's header.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/types/span.h"
#include "geometry/camera.h"
#include "geometry/light.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

struct ReadbackWarning {
  std::string about;          // the kind, and the light: the same in every frame that has it
  std::string text;           // without the file's name
  bool is_of_pixels = false;  // calls that have the pixels find it themselves
};

// In which words a way out is named.
enum class WarningWords { kCommandLine, kCall };

// Of pixels alone. Sets Readback::background as SettleBackground() does.
std::vector<ReadbackWarning> PixelWarnings(absl::Span<const Light> lights,
                                           WarningWords words,
                                           Readback* readback);

// Of them, what is said of the background alone.
std::vector<ReadbackWarning> BackgroundWarnings(absl::Span<const Light> lights,
                                                WarningWords words,
                                                Readback* readback);

// Lights of the same name that are not the same: by more than a file's digits lose. `camera` tells
// how large the scene is.
std::vector<ReadbackWarning> LightWarnings(absl::Span<const Light> lights,
                                           absl::Span<const Light> of_header,
                                           const Camera& camera);

// The camera that was given, and that of the file. Both are of the same size.
std::vector<ReadbackWarning> CameraWarnings(const Camera& given, const Camera& of_file);

// A camera from the file's matrices whose lens is shifted by more than most are.
std::vector<ReadbackWarning> ShiftWarnings(const Camera& camera);

}  // namespace lightfit
