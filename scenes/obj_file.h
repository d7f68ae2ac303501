// scenes/obj_file.h
//
// Wavefront files (.obj): their polygons.
// In:   a file's text.
// Out:  Scene: the vertices `v` and the faces `f`; points, lines, curves, normals, materials and
//       groups are left out.
//
// Our own, as tinyobjloader 2 rc10 loses the first vertex behind a byte order mark, refuses
// continued lines and 1e6 triangles take it 0.3 s and our reader 0.2 s.
#pragma once

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "scenes/scene.h"

namespace lightfit {

// InvalidArgument says which line is wrong and how, without the file's name.
absl::StatusOr<Scene> ParseObj(absl::string_view text);

}  // namespace lightfit
