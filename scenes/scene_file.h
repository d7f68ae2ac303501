// scenes/scene_file.h
//
// Scenes from files: glTF 2.0 (.gltf, .glb), Wavefront (.obj), Stanford (.ply).
// In:   a path.
// Out:  Scene in world space: all meshes of the file under their nodes' transforms.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "scenes/scene.h"

namespace lightfit {

struct SceneFile {
  Scene scene;
  int64_t num_dropped =
      0;  // triangles without area or with bad coordinates, see DropBadTriangles()
};

// Polygons are triangulated; points and lines are left out. NotFound and InvalidArgument name the
// file and what is wrong with it; a file without any triangle of positive area is an error.
absl::StatusOr<SceneFile> ReadScene(const std::string& path);

}  // namespace lightfit
