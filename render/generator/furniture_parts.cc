#include "render/generator/furniture_parts.h"

#include <algorithm>

namespace lightfit {

Solid Cylinder(double height_in_radii) {
  Solid solid;
  solid.profile = Solid::Profile::kCylinder;
  solid.height = height_in_radii;
  return solid;
}

void AddLegs(const Eigen::Vector2d& half_size,
             const Eigen::Vector3d& middle,
             double height,
             double thickness,
             PartList* list) {
  for (const double sx : {-1.0, 1.0}) {
    for (const double sz : {-1.0, 1.0}) {
      const double x = middle.x() + sx * (half_size.x() - 0.5 * thickness);
      const double z = middle.z() + sz * (half_size.y() - 0.5 * thickness);
      const double h = 0.5 * thickness;
      list->AddBox({x - h, middle.y(), z - h}, {x + h, middle.y() + height, z + h});
    }
  }
}

void AddThing(
    Dice* dice, const Eigen::Vector3d& foot, double radius, double height, PartList* list) {
  const int kind = dice->Below(5);
  const double slim = dice->Uniform(0.7, 1.0);
  const double tall = dice->Uniform(0.6, 1.0);
  const double r = slim * radius, h = std::min(tall * height, 5.0 * r);
  Solid solid;
  if (kind == 0) {  // ball
    const double ball = std::min(r, 0.5 * height);
    list->AddSolid(solid, foot, {ball, ball, ball}, 1.5);
  } else if (kind == 1) {  // vase
    solid.profile = Solid::Profile::kVase;
    solid.height = h / r;
    list->AddSolid(solid, foot, {r, r, r}, 2.0);
  } else if (kind == 2) {  // tin
    list->AddSolid(Cylinder(h / r), foot, {r, r, r});
  } else if (kind == 3) {  // cone
    solid.profile = Solid::Profile::kCone;
    solid.height = h / r;
    list->AddSolid(solid, foot, {r, r, r});
  } else {  // box
    const double depth = 0.7 * r;
    list->AddBox({foot.x() - 0.7 * r, foot.y(), foot.z() - depth},
                 {foot.x() + 0.7 * r, foot.y() + h, foot.z() + depth});
  }
}

void AddThings(Dice* dice,
               double x_low,
               double x_high,
               double y,
               double depth,
               double height,
               PartList* list) {
  double x = x_low + 0.02;
  while (true) {
    const double radius = std::min(dice->Uniform(0.05, 0.13), 0.5 * depth);
    const double gap = dice->Uniform(0.03, 0.3);
    const double sideways = dice->Uniform(-1.0, 1.0);
    if (x + 2.0 * radius > x_high - 0.02) break;
    AddThing(dice, {x + radius, y, sideways * (0.5 * depth - radius)}, radius, height, list);
    x += 2.0 * radius + gap;
  }
}

void AddBooks(Dice* dice,
              double x_low,
              double x_high,
              double y,
              double front,
              double height,
              PartList* list) {
  double x = x_low;
  while (true) {
    const double thick = dice->Uniform(0.015, 0.05);
    const double tall = dice->Uniform(0.6, 0.92) * height;
    const double deep = dice->Uniform(0.12, 0.19);
    if (x + thick > x_high) break;
    list->AddBox({x, y, front - deep}, {x + 0.97 * thick, y + tall, front});
    x += thick;
  }
}

}  // namespace lightfit
