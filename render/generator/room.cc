#include "render/generator/room.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "render/generator/dice.h"
#include "render/generator/furniture.h"
#include "render/generator/room_parts.h"

namespace lightfit {

namespace {

constexpr double kThickness = 0.25;  // of walls, floor and ceiling

struct Opening {
  double left, right, low, high;  // on its wall, seen from inside
  int panes_across = 2, panes_up = 2;
};

// A wall in its own coordinates: its inner side is z = 0, its middle is x = 0, and it looks into
// the room along z.
struct Wall {
  Eigen::Vector3d origin;
  double yaw_turns = 0.0;
  double half_width = 0.0;
  std::vector<Opening> openings;  // from left to right
};

Opening DrawWindow(Dice* dice, double middle, double height) {
  const double half_width = dice->Uniform(0.65, 0.95);
  const double sill = dice->Chance(0.25) ? 0.12 : dice->Uniform(0.7, 0.95);
  const double top = height - dice->Uniform(0.3, 0.5);
  Opening opening{middle - half_width, middle + half_width, sill, top};
  opening.panes_across = 2 + dice->Below(2);
  opening.panes_up = 1 + dice->Below(3);
  return opening;
}

// Corners lie inside the neighbouring walls, floor and ceiling: no two surfaces in one plane, no
// gap.
void BuildWall(const Wall& wall, double height, RoomParts* parts) {
  constexpr double kInto = 0.5 * kThickness;
  Slab slab;
  slab.back = -kThickness;
  slab.front = 0.0;
  slab.columns = {-wall.half_width - kInto, wall.half_width + kInto};
  slab.rows = {-kInto, height + kInto};
  for (const Opening& opening : wall.openings) {
    slab.columns.insert(slab.columns.end(), {opening.left, opening.right});
    slab.rows.insert(slab.rows.end(), {opening.low, opening.high});
  }
  for (std::vector<double>* lines : {&slab.columns, &slab.rows}) {
    std::sort(lines->begin(), lines->end());
    lines->erase(std::unique(lines->begin(), lines->end()), lines->end());
  }
  for (size_t row = 0; row + 1 < slab.rows.size(); ++row) {
    for (size_t column = 0; column + 1 < slab.columns.size(); ++column) {
      bool is_open = false;
      for (const Opening& o : wall.openings) {
        is_open =
            is_open || (slab.columns[column] >= o.left && slab.columns[column + 1] <= o.right &&
                        slab.rows[row] >= o.low && slab.rows[row + 1] <= o.high);
      }
      slab.open.push_back(is_open ? 1 : 0);
    }
  }
  parts->SetPlace(wall.origin, wall.yaw_turns);
  parts->AddSlab(slab);
}

// Lines of bars across [low, high], the outer ones hidden in the wall by a centimetre.
std::vector<double> BarLines(double low, double high, int num_panes) {
  constexpr double kHidden = 0.01, kFrame = 0.06, kBar = 0.03;
  std::vector<double> lines = {low - kHidden, low + kFrame};
  for (int i = 1; i < num_panes; ++i) {
    const double middle = low + (high - low) * i / num_panes;
    lines.push_back(middle - 0.5 * kBar);
    lines.push_back(middle + 0.5 * kBar);
  }
  lines.push_back(high - kFrame);
  lines.push_back(high + kHidden);
  return lines;
}

// The frame with its bars, and a sill; RoomParts' place is the wall's.
void BuildWindow(const Opening& opening, RoomParts* parts) {
  Slab frame;
  frame.columns = BarLines(opening.left, opening.right, opening.panes_across);
  frame.rows = BarLines(opening.low, opening.high, opening.panes_up);
  frame.back = -0.17;
  frame.front = -0.12;
  for (size_t row = 0; row + 1 < frame.rows.size(); ++row) {
    for (size_t column = 0; column + 1 < frame.columns.size(); ++column) {
      frame.open.push_back(row % 2 == 1 && column % 2 == 1 ? 1 : 0);
    }
  }
  parts->AddSlab(frame);
  if (opening.low > 0.3) {
    parts->AddBox({opening.left - 0.05, opening.low - 0.04, -0.11},
                  {opening.right + 0.05, opening.low + 0.005, 0.08});
  }
}

Eigen::AlignedBox3d OpeningInRoom(const Wall& wall, const Opening& opening) {
  const double c = CosTurns(wall.yaw_turns), s = SinTurns(wall.yaw_turns);
  Eigen::AlignedBox3d box;
  for (const double x : {opening.left, opening.right}) {
    for (const double y : {opening.low, opening.high}) {
      for (const double z : {-kThickness, 0.0}) {
        box.extend(wall.origin + Eigen::Vector3d(c * x + s * z, y, c * z - s * x));
      }
    }
  }
  return box;
}

// Where pieces stand: boxes on the floor that keep clear of one another.
class Floor {
 public:
  explicit Floor(const Eigen::Vector2d& half_size) : half_size_(half_size) {
    const double r = kRoomViewerSpace;
    for (const Eigen::Vector2d& viewer : kRoomViewers) {
      taken_.emplace_back(viewer - Eigen::Vector2d(r, r), viewer + Eigen::Vector2d(r, r));
    }
  }

  // Whether the box is free, and takes it then.
  bool Take(const Eigen::Vector2d& middle, const Eigen::Vector2d& half_size) {
    constexpr double kGap = 0.06;
    const Eigen::AlignedBox2d box(middle - half_size, middle + half_size);
    for (int axis = 0; axis < 2; ++axis) {
      if (box.min()[axis] < -half_size_[axis] || box.max()[axis] > half_size_[axis]) return false;
    }
    const Eigen::Vector2d gap = Eigen::Vector2d::Constant(kGap);
    const Eigen::AlignedBox2d wide(box.min() - gap, box.max() + gap);
    for (const Eigen::AlignedBox2d& other : taken_) {
      if (wide.intersects(other)) return false;
    }
    taken_.push_back(box);
    return true;
  }

 private:
  Eigen::Vector2d half_size_;
  std::vector<Eigen::AlignedBox2d> taken_;
};

// x and z half sizes of the box around a turned one.
Eigen::Vector2d Turned(const Eigen::Vector2d& half_size, double yaw_turns) {
  const double c = std::abs(CosTurns(yaw_turns)), s = std::abs(SinTurns(yaw_turns));
  return {c * half_size.x() + s * half_size.y(), s * half_size.x() + c * half_size.y()};
}

// Builds the piece where there is room for it; without room it is left out.
void Place(const Piece& piece,
           const std::vector<Wall>& walls,
           const Eigen::Vector2d& half_room,
           Dice* dice,
           Floor* floor,
           RoomParts* parts) {
  constexpr int kTries = 150;
  constexpr double kOffWall = 0.02;
  for (int i = 0; i < kTries; ++i) {
    Eigen::Vector2d middle;
    double yaw_turns;
    if (piece.at_wall) {
      const Wall& wall = walls[dice->Below(static_cast<int>(walls.size()))];
      const double along = dice->Uniform(-1.0, 1.0);
      if (!wall.openings.empty()) continue;
      yaw_turns = wall.yaw_turns;
      const double c = CosTurns(yaw_turns), s = SinTurns(yaw_turns);
      const double x = along * (wall.half_width - piece.half_size.x());
      const double z = piece.half_size.y() + kOffWall;
      middle = {wall.origin.x() + (c * x + s * z), wall.origin.z() + (c * z - s * x)};
    } else {
      const double x = dice->Uniform(-1.0, 1.0);
      const double z = dice->Uniform(-1.0, 1.0);
      const int quarter = dice->Below(4);
      const double askew = dice->Uniform(-0.06, 0.06);
      middle = {x * half_room.x(), z * half_room.y()};
      yaw_turns = 0.25 * quarter + askew;
    }
    if (!floor->Take(middle, Turned(piece.half_size, yaw_turns))) continue;
    parts->SetPlace({middle.x(), 0.0, middle.y()}, yaw_turns);
    piece.build(parts);
    return;
  }
}

// A shade on a cord from the ceiling.
void HangLamp(double height, Dice* dice, RoomParts* parts) {
  const double x = dice->Uniform(-1.0, 1.0);
  const double z = dice->Uniform(-2.0, 2.0);
  const double drop = dice->Uniform(0.6, 0.95);
  const double radius = dice->Uniform(0.2, 0.32);
  const double neck = dice->Uniform(0.2, 0.6);
  parts->SetPlace({x, height - drop, z}, 0.0);
  parts->AddShade(Eigen::Vector3d::Zero(), radius, neck * radius, 0.22);
  Solid bulb;
  parts->AddSolid(bulb, {0.0, 0.04, 0.0}, {0.045, 0.055, 0.045}, 0.3);
  parts->AddBox({-0.005, 0.14, -0.005}, {0.005, drop + 0.05, 0.005});
}

}  // namespace

Room MakeRoom(uint64_t seed, int64_t num_triangles) {
  Dice dice(seed);
  const double half_x = dice.Uniform(2.9, 3.1);
  const double half_z = dice.Uniform(3.9, 4.1);
  const double height = dice.Uniform(2.7, 2.9);
  Room room;
  room.inside = Eigen::AlignedBox3d(Eigen::Vector3d(-half_x, 0.0, -half_z),
                                    Eigen::Vector3d(half_x, height, half_z));
  RoomParts parts;
  // Floor and ceiling reach under and over the walls.
  const double out = kThickness;
  parts.AddBox({-half_x - out, -kThickness, -half_z - out}, {half_x + out, 0.0, half_z + out});
  parts.AddBox({-half_x - out, height, -half_z - out},
               {half_x + out, height + kThickness, half_z + out});

  std::vector<Wall> walls = {{{-half_x, 0.0, 0.0}, 0.25, half_z, {}},
                             {{0.0, 0.0, -half_z}, 0.0, half_x, {}},
                             {{half_x, 0.0, 0.0}, 0.75, half_z, {}},
                             {{0.0, 0.0, half_z}, 0.5, half_x, {}}};
  for (const double side : {-1.0, 1.0}) {
    const double middle = side * dice.Uniform(1.3, 2.4);
    walls[0].openings.push_back(DrawWindow(&dice, middle, height));
  }
  if (dice.Chance(0.5)) {
    const double middle = dice.Uniform(-1.5, 1.0);
    walls[1].openings.push_back(DrawWindow(&dice, middle, height));
  }
  for (const Wall& wall : walls) {
    BuildWall(wall, height, &parts);
    for (const Opening& opening : wall.openings) {
      BuildWindow(opening, &parts);
      room.windows.push_back(OpeningInRoom(wall, opening));
    }
  }

  HangLamp(height, &dice, &parts);
  const Eigen::Vector2d half_room(half_x, half_z);
  Floor floor(half_room);
  // Large pieces first, and small ones in what they leave.
  using Design = Piece (*)(Dice*);
  const std::pair<Design, int> designs[] = {{DiningTable, 1},
                                            {Bookcase, 2},
                                            {SlattedScreen, 1},
                                            {RoomDivider, 1},
                                            {Armchair, 2},
                                            {SideTable, 2},
                                            {DiningTable, 1},
                                            {Bookcase, 1},
                                            {Bench, 1},
                                            {FloorLamp, 2},
                                            {StackOfBoxes, 3},
                                            {RoundThing, 6}};
  for (const auto& [design, count] : designs) {
    for (int i = 0; i < count; ++i) {
      const Piece piece = design(&dice);
      Place(piece, walls, half_room, &dice, &floor, &parts);
    }
  }
  room.scene = parts.Join(num_triangles);
  return room;
}

}  // namespace lightfit
