// render/generator/room.h
//
// A furnished room made by rule: walls with windows, and things that stand in the sun they let in.
// In:   a seed and about how many triangles.
// Out:  the same Room on every machine.
//
// About 6 x 2.8 x 8 metres (x, y, z); y is up, the floor is at y = 0 around the origin. Two windows
// look towards -x, some rooms have a third one towards -z.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "scenes/scene.h"

namespace lightfit {

struct Room {
  Scene scene;
  Eigen::AlignedBox3d inside;  // between the walls, floor to ceiling
  std::vector<Eigen::AlignedBox3d>
      windows;  // the openings, as deep as the wall; frames are in them
};

// Nothing stands within this distance of these places on the floor (x, z), and no lamp hangs there.
inline const Eigen::Vector2d kRoomViewers[] = {{2.3, 3.3}, {-2.2, 3.3}, {2.3, -3.3}};
inline constexpr double kRoomViewerSpace = 0.7;

// `num_triangles` is split among what is round: flat things take about ten thousand.
Room MakeRoom(uint64_t seed, int64_t num_triangles);

}  // namespace lightfit
