#include "render/generator/shapes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace lightfit {

namespace {

constexpr double kTwoPi = 6.283185307179586;

// A grid of columns around and rows along; a row more where the rows' ends are single points.
struct GridSize {
  int columns = 0;
  int rows = 0;
};

// The size nearest to `num_triangles` = 2 columns (rows - num_pole_rows) among those whose columns
// to rows are about `aspect`.
GridSize SizeOf(
    int64_t num_triangles, double aspect, int column_multiple, int min_rows, int num_pole_rows) {
  const double quads = std::max(0.5 * static_cast<double>(num_triangles), 1.0);
  const double ideal = std::sqrt(quads * aspect);
  GridSize best;
  double best_miss = 0.0;
  const int first = std::max(1, static_cast<int>(0.75 * ideal) / column_multiple);
  const int last = std::max(first, static_cast<int>(1.33 * ideal) / column_multiple + 1);
  for (int multiple = first; multiple <= last; ++multiple) {
    const int columns = std::max(multiple * column_multiple, 3);
    const int rows =
        std::max(min_rows, num_pole_rows + static_cast<int>(std::lround(quads / columns)));
    const double miss = std::abs(static_cast<double>(columns) * (rows - num_pole_rows) - quads) +
                        1e-6 * std::abs(columns - ideal);
    if (best.columns == 0 || miss < best_miss) {
      best = {columns, rows};
      best_miss = miss;
    }
  }
  return best;
}

// Two triangles between columns c, c + 1 of two rows whose first vertices are given.
void AppendQuad(int low, int high, int column, int columns, Scene* scene) {
  const int next = (column + 1) % columns;
  scene->triangles.emplace_back(low + column, high + column, low + next);
  scene->triangles.emplace_back(low + next, high + column, high + next);
}

// Corners that a column of the outline must meet exactly: their number; 1 without any.
int NumCorners(Solid::Outline outline) {
  switch (outline) {
    case Solid::Outline::kCircle:
      return 1;
    case Solid::Outline::kSquare:
      return 4;
    case Solid::Outline::kHexagon:
      return 6;
    case Solid::Outline::kStar:
      return 10;
  }
  return 1;
}

// The outline at `turns` of 0 ... 1, corners at multiples of 1 / NumCorners().
Eigen::Vector2d OutlineAt(Solid::Outline outline, double turns) {
  const int corners = NumCorners(outline);
  if (corners == 1) return {CosTurns(turns), SinTurns(turns)};
  const double place = turns * corners;
  const int corner = static_cast<int>(place);
  const auto at_corner = [outline, corners](int i) {
    const double angle = static_cast<double>(i % corners) / corners;
    const double radius = outline == Solid::Outline::kStar && i % 2 == 1 ? 0.5 : 1.0;
    return Eigen::Vector2d(radius * CosTurns(angle), radius * SinTurns(angle));
  };
  const double share = place - corner;
  return (1.0 - share) * at_corner(corner) + share * at_corner(corner + 1);
}

// Radius and height along the profile, for a place of 0 ... 1 from the lower pole to the upper.
struct ProfileCurve {
  explicit ProfileCurve(const Solid& solid) : solid_(solid) {
    const double h = solid.height;
    switch (solid.profile) {
      case Solid::Profile::kBall:
        length = 0.25 * kTwoPi * 0.5 * (2.0 + h);
        break;
      case Solid::Profile::kCylinder:
        length = 2.0 + h;
        corners = {1.0 / length, (1.0 + h) / length};
        break;
      case Solid::Profile::kCone:
        length = 1.0 + std::sqrt(1.0 + h * h);
        corners = {1.0 / length};
        break;
      case Solid::Profile::kCapsule:
        length = 0.5 * kTwoPi + h - 2.0;
        corners = {0.25 * kTwoPi / length, 1.0 - 0.25 * kTwoPi / length};
        break;
      case Solid::Profile::kVase:
        length = 1.2 + 1.2 * h;
        corners = {0.6 / length, 1.0 - 0.4 / length};
        break;
    }
  }

  std::pair<double, double> At(double place) const {
    const double h = solid_.height;
    switch (solid_.profile) {
      case Solid::Profile::kBall:
        return {SinTurns(0.5 * place), 0.5 * h * (1.0 - CosTurns(0.5 * place))};
      case Solid::Profile::kCylinder:
        if (place <= corners[0]) return {place / corners[0], 0.0};
        if (place >= corners[1]) return {(1.0 - place) / (1.0 - corners[1]), h};
        return {1.0, h * (place - corners[0]) / (corners[1] - corners[0])};
      case Solid::Profile::kCone: {
        if (place <= corners[0]) return {place / corners[0], 0.0};
        const double up = (place - corners[0]) / (1.0 - corners[0]);
        return {1.0 - up, h * up};
      }
      case Solid::Profile::kCapsule: {
        const double low = std::min(place / corners[0], 1.0);
        const double high = std::max((place - corners[1]) / (1.0 - corners[1]), 0.0);
        const double side = std::clamp((place - corners[0]) / (corners[1] - corners[0]), 0.0, 1.0);
        const double radius = high > 0.0 ? CosTurns(0.25 * high) : SinTurns(0.25 * low);
        return {radius, 1.0 - CosTurns(0.25 * low) + (h - 2.0) * side + SinTurns(0.25 * high)};
      }
      case Solid::Profile::kVase: {
        const double up = std::clamp((place - corners[0]) / (corners[1] - corners[0]), 0.0, 1.0);
        const double wall = 0.63 + 0.35 * SinTurns(0.85 * up) + 0.05 * up;
        if (place < corners[0]) return {wall * place / corners[0], 0.0};
        if (place > corners[1]) return {wall * (1.0 - place) / (1.0 - corners[1]), h};
        return {wall, h * up};
      }
    }
    return {0.0, 0.0};
  }

  double length = 0.0;          // about, in radii
  std::vector<double> corners;  // places that a row must meet exactly, ascending

 private:
  const Solid& solid_;
};

Eigen::Vector3d SolidPoint(const Solid& solid, const ProfileCurve& profile, double u, double v) {
  const auto [radius, height] = profile.At(v);
  const Eigen::Vector2d flat = radius * OutlineAt(solid.outline, u);
  const double twist = solid.twist_turns * height / solid.height;
  const double c = CosTurns(twist), s = SinTurns(twist);
  Eigen::Vector3d point(c * flat.x() - s * flat.y(), height, s * flat.x() + c * flat.y());
  if (solid.bump != 0.0) {
    constexpr double kWavesPerRadius[] = {0.37, 0.43, 0.31};
    double wave = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      wave += SinTurns(kWavesPerRadius[axis] * point[axis] + solid.bump_phase_turns[axis]);
    }
    const Eigen::Vector3d middle(0.0, 0.5 * solid.height, 0.0);
    point += solid.bump / 3.0 * wave * (point - middle);
  }
  return point;
}

// The middle of a tube, and the directions across it: away from the torus, and sideways.
struct TubeFrame {
  Eigen::Vector3d middle, out, side;
};

TubeFrame TubeFrameAt(const Tube& tube, double turns) {
  const double around = tube.around * turns, through = tube.through * turns;
  const double ca = CosTurns(around), sa = SinTurns(around);
  const double ct = CosTurns(through), st = SinTurns(through);
  const double winding = tube.through == 0 ? 0.0 : tube.winding_radius;
  const double reach = 1.0 + winding * ct;
  TubeFrame frame;
  frame.middle = Eigen::Vector3d(reach * ca, winding * st, reach * sa);
  frame.out = Eigen::Vector3d(ct * ca, st, ct * sa);
  const Eigen::Vector3d along = tube.around * Eigen::Vector3d(-reach * sa, 0.0, reach * ca) +
                                tube.through * winding * Eigen::Vector3d(-st * ca, ct, -st * sa);
  frame.side = along.cross(frame.out).normalized();
  return frame;
}

}  // namespace

double SinTurns(double turns) {
  // To -1/4 ... 1/4, where the series converges fast.
  double x = turns - std::floor(turns + 0.5);
  if (x > 0.25) x = 0.5 - x;
  if (x < -0.25) x = -0.5 - x;
  x *= kTwoPi;
  double term = x, sum = x;
  for (int i = 1; i <= 10; ++i) {
    term *= -x * x / ((2.0 * i) * (2.0 * i + 1.0));
    sum += term;
  }
  return sum;
}

double CosTurns(double turns) { return SinTurns(turns + 0.25); }

void AppendSolid(const Solid& solid, int64_t num_triangles, Scene* scene) {
  constexpr int kPoleRows = 1;
  const ProfileCurve profile(solid);
  const auto num_corners = static_cast<int>(profile.corners.size());
  const GridSize size = SizeOf(num_triangles,
                               kTwoPi / profile.length,
                               NumCorners(solid.outline),
                               std::max(num_corners + 1, 3),
                               kPoleRows);
  std::vector<double> places(size.rows + 1);
  for (int row = 0; row <= size.rows; ++row) places[row] = static_cast<double>(row) / size.rows;
  int previous = 0;
  for (int i = 0; i < num_corners; ++i) {
    const int nearest = static_cast<int>(std::lround(profile.corners[i] * size.rows));
    previous = std::clamp(nearest, previous + 1, size.rows - num_corners + i);
    places[previous] = profile.corners[i];
  }
  const auto first = static_cast<int>(scene->vertices.size());
  const auto add = [&](double u, double v) {
    scene->vertices.push_back(SolidPoint(solid, profile, u, v).cast<float>());
  };
  add(0.0, 0.0);
  for (int row = 1; row < size.rows; ++row) {
    for (int column = 0; column < size.columns; ++column) {
      add(static_cast<double>(column) / size.columns, places[row]);
    }
  }
  add(0.0, 1.0);
  const int top = static_cast<int>(scene->vertices.size()) - 1;
  const int last_ring = top - size.columns;
  for (int column = 0; column < size.columns; ++column) {
    const int next = (column + 1) % size.columns;
    scene->triangles.emplace_back(first, first + 1 + column, first + 1 + next);
    scene->triangles.emplace_back(top, last_ring + next, last_ring + column);
  }
  for (int ring = first + 1; ring < last_ring; ring += size.columns) {
    for (int column = 0; column < size.columns; ++column) {
      AppendQuad(ring, ring + size.columns, column, size.columns, scene);
    }
  }
}

void AppendTube(const Tube& tube, int64_t num_triangles, Scene* scene) {
  const double length =
      kTwoPi * std::sqrt(static_cast<double>(tube.around) * tube.around +
                         tube.winding_radius * tube.winding_radius * tube.through * tube.through);
  const GridSize size =
      SizeOf(num_triangles, kTwoPi * tube.tube_radius / length, 1, 3, /*num_pole_rows=*/0);
  const auto first = static_cast<int>(scene->vertices.size());
  for (int row = 0; row < size.rows; ++row) {
    const TubeFrame frame = TubeFrameAt(tube, static_cast<double>(row) / size.rows);
    for (int column = 0; column < size.columns; ++column) {
      const double turns = static_cast<double>(column) / size.columns;
      const Eigen::Vector3d point =
          frame.middle +
          tube.tube_radius * (CosTurns(turns) * frame.out + SinTurns(turns) * frame.side);
      scene->vertices.push_back(point.cast<float>());
    }
  }
  for (int row = 0; row < size.rows; ++row) {
    const int next_row = (row + 1) % size.rows;
    for (int column = 0; column < size.columns; ++column) {
      AppendQuad(
          first + row * size.columns, first + next_row * size.columns, column, size.columns, scene);
    }
  }
}

}  // namespace lightfit
