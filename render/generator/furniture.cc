#include "render/generator/furniture.h"

#include <algorithm>
#include <vector>

#include "render/generator/furniture_parts.h"

namespace lightfit {

namespace {

// A chair with the middle of its seat over (x, z); sz = 1: its front looks along z, -1: against it.
void AddChair(double x, double z, double sz, bool has_slats, PartList* list) {
  constexpr double kHalf = 0.21, kSeat = 0.45, kBack = 0.92, kLeg = 0.035;
  AddLegs({kHalf, kHalf}, {x, 0.0, z}, kSeat - 0.03, kLeg, list);
  list->AddBox({x - kHalf, kSeat - 0.03, z - kHalf}, {x + kHalf, kSeat, z + kHalf});
  const double outer = z - sz * kHalf, inner = outer + sz * 0.03;
  Slab back;
  back.back = std::min(outer, inner);
  back.front = std::max(outer, inner);
  if (has_slats) {
    back.columns = {-kHalf, -kHalf + kLeg};
    for (int i = 0; i < 4; ++i) {
      const double slat = -0.135 + 0.09 * i;
      back.columns.push_back(slat - 0.015);
      back.columns.push_back(slat + 0.015);
    }
    back.columns.push_back(kHalf - kLeg);
    back.columns.push_back(kHalf);
    back.rows = {kSeat, kBack - 0.07, kBack};
    for (size_t column = 0; column + 1 < back.columns.size(); ++column) {
      back.open.push_back(column % 2 == 1 ? 1 : 0);
    }
    back.open.insert(back.open.end(), back.columns.size() - 1, 0);
  } else {
    back.columns = {-kHalf, -kHalf + kLeg, kHalf - kLeg, kHalf};
    back.rows = {kSeat, kSeat + 0.18, kSeat + 0.28, kBack - 0.12, kBack};
    back.open = {0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0};
  }
  for (double& column : back.columns) column += x;
  list->AddSlab(back);
}

// Sides and boards around open compartments; returns the compartments' (x, x, y, y).
std::vector<Eigen::Vector4d> AddCompartments(
    double width, double height, double depth, int num_columns, int num_rows, PartList* list) {
  constexpr double kBoard = 0.025, kFoot = 0.06;
  Slab slab;
  slab.back = -0.5 * depth;
  slab.front = 0.5 * depth;
  for (int i = 0; i <= num_columns; ++i) {
    const double x = -0.5 * width + (width - kBoard) * i / num_columns;
    slab.columns.push_back(x);
    slab.columns.push_back(x + kBoard);
  }
  slab.rows.push_back(0.0);
  for (int i = 0; i <= num_rows; ++i) {
    const double y = kFoot + (height - kFoot - kBoard) * i / num_rows;
    slab.rows.push_back(y);
    slab.rows.push_back(y + kBoard);
  }
  std::vector<Eigen::Vector4d> compartments;
  for (size_t row = 0; row + 1 < slab.rows.size(); ++row) {
    for (size_t column = 0; column + 1 < slab.columns.size(); ++column) {
      // Row 0 is the space below the lowest board, between the feet.
      const bool is_open = row % 2 == 0 && column % 2 == 1;
      slab.open.push_back(is_open ? 1 : 0);
      if (is_open && row > 0) {
        compartments.emplace_back(
            slab.columns[column], slab.columns[column + 1], slab.rows[row], slab.rows[row + 1]);
      }
    }
  }
  list->AddSlab(slab);
  return compartments;
}

Piece Shelves(Dice* dice, bool at_wall) {
  const double width = dice->Uniform(0.9, 1.7);
  const double height = at_wall ? dice->Uniform(1.5, 2.2) : dice->Uniform(1.1, 1.7);
  const double depth = dice->Uniform(0.28, 0.36);
  const int num_rows = std::max(3, static_cast<int>(height / 0.36));
  const int num_columns = 1 + dice->Below(3);
  PartList list;
  for (const Eigen::Vector4d& c :
       AddCompartments(width, height, depth, num_columns, num_rows, &list)) {
    const double tall = 0.8 * (c[3] - c[2]);
    const int kind = dice->Below(4);
    const double fill = dice->Uniform(0.3, 1.0);
    if (kind <= 1) {
      AddBooks(dice, c[0], c[0] + fill * (c[1] - c[0]), c[2], 0.5 * depth - 0.03, tall, &list);
    } else if (kind == 2) {
      AddThings(dice, c[0], c[1], c[2], depth, tall, &list);
    }
  }
  if (at_wall) {  // a back that does not lie on the shelves' own
    list.AddBox({-0.5 * width + 0.01, 0.07, -0.5 * depth - 0.01},
                {0.5 * width - 0.01, height - 0.01, -0.5 * depth + 0.01});
  }
  Piece piece;
  piece.half_size = {0.5 * width, 0.5 * depth + 0.015};
  piece.at_wall = at_wall;
  piece.build = list.All();
  return piece;
}

}  // namespace

Piece DiningTable(Dice* dice) {
  const double width = dice->Uniform(1.3, 1.8), depth = dice->Uniform(0.8, 0.95);
  const double height = dice->Uniform(0.72, 0.76);
  const bool has_slats = dice->Chance(0.6);
  PartList list;
  const double top = height - 0.035;
  list.AddBox({-0.5 * width, top, -0.5 * depth}, {0.5 * width, height, 0.5 * depth});
  AddLegs({0.5 * width - 0.04, 0.5 * depth - 0.04}, Eigen::Vector3d::Zero(), top, 0.07, &list);
  // Rails between the legs.
  for (const double sz : {-1.0, 1.0}) {
    const double z = sz * (0.5 * depth - 0.07);
    list.AddBox({-0.5 * width + 0.1, top - 0.09, z - 0.01}, {0.5 * width - 0.1, top, z + 0.01});
  }
  AddThings(dice, -0.5 * width, 0.5 * width, height, 0.6 * depth, 0.35, &list);
  const bool four = dice->Chance(0.6);
  for (const double sz : {-1.0, 1.0}) {
    for (const double side : {-0.25, 0.25}) {
      if (!four && side * sz > 0.0) continue;
      const double out = dice->Uniform(0.0, 0.15), along = dice->Uniform(-0.05, 0.05);
      AddChair(side * width + along, sz * (0.5 * depth + out), -sz, has_slats, &list);
    }
  }
  Piece piece;
  piece.half_size = {0.5 * width, 0.5 * depth + 0.36};
  piece.build = list.All();
  return piece;
}

Piece SideTable(Dice* dice) {
  const double width = dice->Uniform(0.9, 1.5), depth = dice->Uniform(0.35, 0.5);
  const double height = dice->Uniform(0.75, 0.9);
  PartList list;
  list.AddBox({-0.5 * width, height - 0.03, -0.5 * depth}, {0.5 * width, height, 0.5 * depth});
  AddLegs({0.5 * width - 0.02, 0.5 * depth - 0.02},
          Eigen::Vector3d::Zero(),
          height - 0.03,
          0.04,
          &list);
  list.AddBox({-0.5 * width + 0.07, 0.2, -0.5 * depth + 0.03},
              {0.5 * width - 0.07, 0.22, 0.5 * depth - 0.03});
  AddThings(dice, -0.5 * width, 0.5 * width, height, depth, 0.4, &list);
  AddThings(dice, -0.5 * width + 0.1, 0.5 * width - 0.1, 0.22, depth - 0.08, 0.35, &list);
  Piece piece;
  piece.half_size = {0.5 * width, 0.5 * depth};
  piece.at_wall = true;
  piece.build = list.All();
  return piece;
}

Piece Bookcase(Dice* dice) { return Shelves(dice, /*at_wall=*/true); }

Piece RoomDivider(Dice* dice) { return Shelves(dice, /*at_wall=*/false); }

Piece SlattedScreen(Dice* dice) {
  const double wing = dice->Uniform(0.7, 0.95), height = dice->Uniform(1.5, 1.8);
  const double pitch = dice->Uniform(0.06, 0.09), thick = dice->Uniform(0.35, 0.5);
  PartList list;
  // Two wings in one line, one a little in front of the other.
  for (const double side : {-1.0, 1.0}) {
    Slab slab;
    slab.back = side < 0.0 ? -0.06 : 0.02;
    slab.front = slab.back + 0.03;
    const double low = side < 0.0 ? -wing : 0.0;
    const int num_slats = static_cast<int>(wing / pitch);
    for (int i = 0; i <= num_slats; ++i) {
      const double x = low + (wing - thick * pitch) * i / num_slats;
      slab.columns.push_back(x);
      slab.columns.push_back(x + thick * pitch);
    }
    slab.rows = {0.0, 0.08, 0.13, 0.62 * height, 0.62 * height + 0.05, height - 0.06, height};
    for (size_t row = 0; row + 1 < slab.rows.size(); ++row) {
      for (size_t column = 0; column + 1 < slab.columns.size(); ++column) {
        // The outermost slats are its feet.
        const bool is_post = column == 0 || column + 2 == slab.columns.size();
        slab.open.push_back(!is_post && row % 2 == 0 && (row == 0 || column % 2 == 1) ? 1 : 0);
      }
    }
    list.AddSlab(slab);
  }
  for (const double x : {-wing + 0.015, wing - 0.015}) {
    list.AddBox({x - 0.03, 0.0, -0.2}, {x + 0.03, 0.03, 0.2});
  }
  Piece piece;
  piece.half_size = {wing + 0.02, 0.2};
  piece.build = list.All();
  return piece;
}

Piece FloorLamp(Dice* dice) {
  const double height = dice->Uniform(1.45, 1.75), radius = dice->Uniform(0.18, 0.25);
  const double neck = dice->Uniform(0.5, 0.9);
  PartList list;
  list.AddSolid(Cylinder(0.2), Eigen::Vector3d::Zero(), {0.15, 0.15, 0.15}, 0.3);
  constexpr double kPole = 0.013;
  list.AddSolid(Cylinder((height - 0.03) / kPole), {0.0, 0.03, 0.0}, {kPole, kPole, kPole}, 0.1);
  list.Add([=](RoomParts* parts) {
    parts->AddShade({0.0, height - 0.3, 0.0}, radius, neck * radius, 0.32);
  });
  list.AddSolid({}, {0.0, height - 0.2, 0.0}, {0.04, 0.05, 0.04}, 0.3);
  Piece piece;
  piece.half_size = {radius, radius};
  piece.build = list.All();
  return piece;
}

Piece Bench(Dice* dice) {
  const double width = dice->Uniform(1.2, 1.8);
  constexpr double kHalfDepth = 0.2, kHeight = 0.45;
  PartList list;
  // Slats along it.
  for (int i = 0; i < 4; ++i) {
    const double z = -kHalfDepth + 0.108 * i;
    list.AddBox({-0.5 * width, kHeight - 0.03, z}, {0.5 * width, kHeight, z + 0.076});
  }
  for (const double sx : {-1.0, 1.0}) {
    const double x = sx * (0.5 * width - 0.12);
    list.AddBox({x - 0.02, 0.0, -kHalfDepth}, {x + 0.02, kHeight - 0.03, kHalfDepth});
  }
  Piece piece;
  piece.half_size = {0.5 * width, kHalfDepth};
  piece.build = list.All();
  return piece;
}

Piece Armchair(Dice* dice) {
  const double width = dice->Uniform(0.75, 0.9), depth = dice->Uniform(0.75, 0.85);
  const double arm = dice->Uniform(0.1, 0.16);
  const double w = 0.5 * width, d = 0.5 * depth;
  PartList list;
  AddLegs({w - 0.03, d - 0.03}, Eigen::Vector3d::Zero(), 0.13, 0.05, &list);
  list.AddBox({-w + arm, 0.12, -d + 0.1}, {w - arm, 0.42, d});
  list.AddBox({-w, 0.1, -d}, {-w + arm, 0.62, d - 0.02});
  list.AddBox({w - arm, 0.1, -d}, {w, 0.62, d - 0.02});
  list.AddBox({-w + 0.02, 0.11, -d - 0.02}, {w - 0.02, 0.86, -d + 0.16});
  Solid cushion;
  cushion.outline = Solid::Outline::kSquare;
  cushion.profile = Solid::Profile::kCapsule;
  cushion.height = 3.0;
  list.AddSolid(cushion, {0.0, 0.42, 0.08}, {0.27, 0.04, 0.27}, 1.0);
  Piece piece;
  piece.half_size = {w, d + 0.02};
  piece.build = list.All();
  return piece;
}

Piece StackOfBoxes(Dice* dice) {
  PartList list;
  double low = 0.0, half = dice->Uniform(0.2, 0.32);
  const double widest = half;
  const int count = 1 + dice->Below(3);
  for (int i = 0; i < count; ++i) {
    const double height = dice->Uniform(0.2, 0.4);
    const double shift_x = dice->Uniform(-1.0, 1.0) * (widest - half);
    const double shift_z = dice->Uniform(-1.0, 1.0) * 0.7 * (widest - half);
    list.AddBox({shift_x - half, low, shift_z - 0.7 * half},
                {shift_x + half, low + height, shift_z + 0.7 * half});
    low += height;
    half *= dice->Uniform(0.6, 0.9);
  }
  Piece piece;
  piece.half_size = {widest, 0.7 * widest};
  piece.build = list.All();
  return piece;
}

Piece RoundThing(Dice* dice) {
  const int kind = dice->Below(4);
  const double radius = dice->Uniform(0.15, 0.32);
  PartList list;
  Solid solid;
  if (kind == 0) {  // ball
    list.AddSolid(solid, Eigen::Vector3d::Zero(), {radius, radius, radius}, 2.0);
  } else if (kind == 1) {  // drum
    list.AddSolid(Cylinder(1.6), Eigen::Vector3d::Zero(), {radius, radius, radius}, 1.5);
  } else if (kind == 2) {  // vase
    solid.profile = Solid::Profile::kVase;
    solid.height = 2.8;
    list.AddSolid(solid, Eigen::Vector3d::Zero(), {radius, radius, radius}, 2.0);
  } else {  // ring
    Tube tube;
    tube.tube_radius = 0.22;
    list.Add([=](RoomParts* parts) {
      parts->AddTube(tube, Eigen::Vector3d::Zero(), radius / 1.22, 2.0);
    });
  }
  Piece piece;
  piece.half_size = {radius, radius};
  piece.build = list.All();
  return piece;
}

}  // namespace lightfit
