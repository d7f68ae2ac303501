// scenes/ply_file.h
//
// Stanford polygon files (.ply), text and binary.
// In:   a file's bytes.
// Out:  Scene: the element `vertex` with x, y, z, the polygons of the element `face` and the strips
//       of the element `tristrips`.
#pragma once

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "scenes/scene.h"

namespace lightfit {

// Indices are as in the file, maybe of vertices that are not there: DropBadTriangles() looks. In
// text what stands on a line beyond what the header lists is left out. InvalidArgument says what is
// wrong, without the file's name.
absl::StatusOr<Scene> ParsePly(absl::string_view bytes);

}  // namespace lightfit
