// render/generator/room_parts.h
//
// What a furnished room is joined from: boards, slabs with holes, round things.
// In:   parts in the coordinates of the piece that is being made: x to its right, y up, z out of
//       its front; metres.
// Out:  their triangles in the room's coordinates, the same on every machine.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "render/generator/shapes.h"
#include "scenes/scene.h"

namespace lightfit {

// An upright slab with rectangular holes through it: a wall with windows, their frames, a slatted
// screen, shelves.
struct Slab {
  // Lines that cut it into cells, along x and y: ascending, two at least.
  std::vector<double> columns, rows;
  double back = 0.0, front = 0.0;  // z
  std::vector<uint8_t> open = {};  // cells, row by row, that are holes; empty: none are

  bool IsOpen(int column, int row) const {
    return !open.empty() && open[row * (columns.size() - 1) + column] != 0;
  }
};

// A closed mesh of the slab's solid cells, in its own space.
void AppendSlab(const Slab& slab, Scene* scene);

class RoomParts {
 public:
  // Where the piece stands that the next parts belong to. A yaw of a quarter turn lets its front
  // look along +x.
  void SetPlace(const Eigen::Vector3d& origin, double yaw_turns);

  void AddBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high);
  void AddSlab(const Slab& slab);

  // A solid that stands on `foot`, scaled; a tube around it that lies on `foot`.
  void AddSolid(const Solid& solid,
                const Eigen::Vector3d& foot,
                const Eigen::Vector3d& scale,
                double share = 1.0);
  void AddTube(const Tube& tube, const Eigen::Vector3d& foot, double scale, double share = 1.0);

  // A thin shade, open above and below.
  void AddShade(const Eigen::Vector3d& foot, double radius_low, double radius_high, double height);

  // All parts; the round ones share what is left of `num_triangles`, at least some dozen each.
  Scene Join(int64_t num_triangles) const;

 private:
  struct RoundPart {
    bool is_tube = false;
    Solid solid;
    Tube tube;
    Eigen::Vector3d foot, scale;
    double share = 1.0;  // of the triangles
    Eigen::Vector3d origin;
    double cos_yaw = 1.0, sin_yaw = 0.0;
  };

  Eigen::Vector3d InRoom(const Eigen::Vector3d& point) const;

  Scene flat_;
  std::vector<RoundPart> round_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  double cos_yaw_ = 1.0, sin_yaw_ = 0.0;
};

}  // namespace lightfit
