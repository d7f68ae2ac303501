// render/ply_file.h
//
// Stanford polygon files (.ply), text and binary.
// In:   a file's bytes.
// Out:  Scene: the element `vertex` with x, y, z and the lists of the element `face`.
//
// assimp reads this format too, but goes round in circles on files that are cut short.
#pragma once

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "render/scene.h"

namespace lightfit {

// Polygons become fans around their first corner, which suits convex ones. Indices are as in the
// file, maybe of vertices that are not there: DropBadTriangles() looks. InvalidArgument says what
// is wrong, without the file's name.
absl::StatusOr<Scene> ParsePly(absl::string_view bytes);

}  // namespace lightfit
