// io/readback_origin.h
//
// Where a read-back was found in its file: for reports, so that a wrong choice does not pass
// unseen. In:   what io/readback_exr.h chose. Out:  one line of text; a message for results.
#pragma once

#include <string>

#include "lightfit/v1/result.pb.h"

namespace lightfit {

struct ReadbackOrigin {
  std::string depth_channel;  // as the file writes it
  std::string depth_part;     // empty in files of one part
  std::string view;           // empty in files without views
  std::string camera_part;    // empty in files of one part, and where the camera was given
};

// As far as there is any of it: depth "Z" of part "depth", camera of part "rgba", view "left".
std::string OriginText(const ReadbackOrigin& origin);

v1::ReadbackOrigin OriginToProto(const ReadbackOrigin& origin);

}  // namespace lightfit
