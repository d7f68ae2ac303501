// render/generator/furniture_parts.h
//
// What pieces of furniture are made of, and what stands on their boards.
// In:   Dice, and where on a piece there is room.
// Out:  parts of a PartList, in the coordinates of the piece (furniture.h).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <utility>
#include <vector>

#include "render/generator/dice.h"
#include "render/generator/room_parts.h"

namespace lightfit {

using Parts = std::function<void(RoomParts*)>;

// Many parts built one after the other.
class PartList {
 public:
  void Add(Parts part) { parts_.push_back(std::move(part)); }
  void AddBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    parts_.emplace_back([low, high](RoomParts* parts) { parts->AddBox(low, high); });
  }
  void AddSlab(const Slab& slab) {
    parts_.emplace_back([slab](RoomParts* parts) { parts->AddSlab(slab); });
  }
  void AddSolid(const Solid& solid,
                const Eigen::Vector3d& foot,
                const Eigen::Vector3d& scale,
                double share = 1.0) {
    parts_.emplace_back([=](RoomParts* parts) { parts->AddSolid(solid, foot, scale, share); });
  }

  Parts All() const {
    return [list = parts_](RoomParts* parts) {
      for (const Parts& part : list) part(parts);
    };
  }

 private:
  std::vector<Parts> parts_;
};

Solid Cylinder(double height_in_radii);

// Four square legs under a plate, with their outer edges at +-half_size.
void AddLegs(const Eigen::Vector2d& half_size,
             const Eigen::Vector3d& middle,
             double height,
             double thickness,
             PartList* list);

// Something of a given radius to stand on a board.
void AddThing(
    Dice* dice, const Eigen::Vector3d& foot, double radius, double height, PartList* list);

// Things in a row along x, clear of one another.
void AddThings(
    Dice* dice, double x_low, double x_high, double y, double depth, double height, PartList* list);

// Books standing side by side, their backs at `front`.
void AddBooks(
    Dice* dice, double x_low, double x_high, double y, double front, double height, PartList* list);

}  // namespace lightfit
