// io/frames/exr_frame.h
//
// The frame number in the header of an OpenEXR file.
// In:   a file.
// Out:  the number, where it says one.
//
// It is an attribute of any part called frame, frameNumber, frame_number or imageCounter, in any
// case, also with a program in front ("exr/frame", "nuke/input/frame"): int, float, double or text.
#pragma once

#include <optional>
#include <string>

#include "base/frame_number.h"

namespace lightfit {

// Nothing also where the file cannot be read, or its parts disagree.
std::optional<FrameNumber> FrameOfExr(const std::string& path);

}  // namespace lightfit
