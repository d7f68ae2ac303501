#include "render/generator/room_parts.h"

#include <algorithm>
#include <cmath>

namespace lightfit {

namespace {

Eigen::Vector3d Placed(const Eigen::Vector3d& point,
                       const Eigen::Vector3d& origin,
                       double cos_yaw,
                       double sin_yaw) {
  return {origin.x() + (cos_yaw * point.x() + sin_yaw * point.z()),
          origin.y() + point.y(),
          origin.z() + (cos_yaw * point.z() - sin_yaw * point.x())};
}

void AppendQuad(int a, int b, int c, int d, Scene* scene) {
  scene->triangles.emplace_back(a, b, c);
  scene->triangles.emplace_back(a, c, d);
}

}  // namespace

void AppendSlab(const Slab& slab, Scene* scene) {
  const int num_columns = static_cast<int>(slab.columns.size()) - 1;
  const int num_rows = static_cast<int>(slab.rows.size()) - 1;
  // Vertices that no solid cell touches are left out.
  std::vector<int> vertices(2 * slab.columns.size() * slab.rows.size(), -1);
  const auto vertex = [&](int column, int row, bool front) {
    int& index = vertices[2 * (row * (num_columns + 1) + column) + (front ? 1 : 0)];
    if (index < 0) {
      index = static_cast<int>(scene->vertices.size());
      const Eigen::Vector3d point(
          slab.columns[column], slab.rows[row], front ? slab.front : slab.back);
      scene->vertices.push_back(point.cast<float>());
    }
    return index;
  };
  const auto is_solid = [&](int column, int row) {
    return column >= 0 && column < num_columns && row >= 0 && row < num_rows &&
           !slab.IsOpen(column, row);
  };
  // From (c0, r0) to (c1, r1), seen with the solid below.
  const auto side = [&](int c0, int r0, int c1, int r1) {
    const int a = vertex(c0, r0, false), b = vertex(c0, r0, true);
    const int c = vertex(c1, r1, true), d = vertex(c1, r1, false);
    AppendQuad(a, b, c, d, scene);
  };
  for (int row = 0; row < num_rows; ++row) {
    for (int column = 0; column < num_columns; ++column) {
      if (!is_solid(column, row)) continue;
      for (const bool front : {false, true}) {
        const int a = vertex(column, row, front), b = vertex(column + 1, row, front);
        const int c = vertex(column + 1, row + 1, front), d = vertex(column, row + 1, front);
        if (front) {
          AppendQuad(a, b, c, d, scene);
        } else {
          AppendQuad(a, d, c, b, scene);
        }
      }
      if (!is_solid(column, row - 1)) side(column + 1, row, column, row);
      if (!is_solid(column, row + 1)) side(column, row + 1, column + 1, row + 1);
      if (!is_solid(column - 1, row)) side(column, row, column, row + 1);
      if (!is_solid(column + 1, row)) side(column + 1, row + 1, column + 1, row);
    }
  }
}

void RoomParts::SetPlace(const Eigen::Vector3d& origin, double yaw_turns) {
  origin_ = origin;
  cos_yaw_ = CosTurns(yaw_turns);
  sin_yaw_ = SinTurns(yaw_turns);
}

Eigen::Vector3d RoomParts::InRoom(const Eigen::Vector3d& point) const {
  return Placed(point, origin_, cos_yaw_, sin_yaw_);
}

void RoomParts::AddBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  AddSlab({{low.x(), high.x()}, {low.y(), high.y()}, low.z(), high.z()});
}

void RoomParts::AddSlab(const Slab& slab) {
  const size_t first = flat_.vertices.size();
  AppendSlab(slab, &flat_);
  for (size_t i = first; i < flat_.vertices.size(); ++i) {
    flat_.vertices[i] = InRoom(flat_.vertices[i].cast<double>()).cast<float>();
  }
}

void RoomParts::AddSolid(const Solid& solid,
                         const Eigen::Vector3d& foot,
                         const Eigen::Vector3d& scale,
                         double share) {
  RoundPart part;
  part.solid = solid;
  part.foot = foot;
  part.scale = scale;
  part.share = share;
  part.origin = origin_;
  part.cos_yaw = cos_yaw_;
  part.sin_yaw = sin_yaw_;
  round_.push_back(part);
}

void RoomParts::AddTube(const Tube& tube, const Eigen::Vector3d& foot, double scale, double share) {
  AddSolid({}, foot, Eigen::Vector3d::Constant(scale), share);
  round_.back().is_tube = true;
  round_.back().tube = tube;
}

void RoomParts::AddShade(const Eigen::Vector3d& foot,
                         double radius_low,
                         double radius_high,
                         double height) {
  constexpr int kColumns = 64;
  const auto first = static_cast<int>(flat_.vertices.size());
  for (const bool high : {false, true}) {
    const double radius = high ? radius_high : radius_low;
    for (int i = 0; i < kColumns; ++i) {
      const double turns = static_cast<double>(i) / kColumns;
      const Eigen::Vector3d point(foot.x() + radius * CosTurns(turns),
                                  foot.y() + (high ? height : 0.0),
                                  foot.z() + radius * SinTurns(turns));
      flat_.vertices.push_back(InRoom(point).cast<float>());
    }
  }
  for (int i = 0; i < kColumns; ++i) {
    const int next = (i + 1) % kColumns;
    AppendQuad(first + i, first + kColumns + i, first + kColumns + next, first + next, &flat_);
  }
}

Scene RoomParts::Join(int64_t num_triangles) const {
  Scene scene = flat_;
  double total_share = 0.0;
  for (const RoundPart& part : round_) total_share += part.share;
  for (const RoundPart& part : round_) {
    // What earlier parts took too much or too little, the later ones make up for.
    const auto left =
        static_cast<double>(num_triangles - static_cast<int64_t>(scene.triangles.size()));
    const auto share = static_cast<int64_t>(std::llround(left * part.share / total_share));
    total_share -= part.share;
    const size_t first = scene.vertices.size();
    double lift = 0.0;  // tubes are centred on their origin
    if (part.is_tube) {
      AppendTube(part.tube, std::max<int64_t>(share, 0), &scene);
      for (size_t i = first; i < scene.vertices.size(); ++i) {
        lift = std::max(lift, -static_cast<double>(scene.vertices[i].y()));
      }
    } else {
      AppendSolid(part.solid, std::max<int64_t>(share, 0), &scene);
    }
    for (size_t i = first; i < scene.vertices.size(); ++i) {
      Eigen::Vector3d point = scene.vertices[i].cast<double>();
      point.y() += lift;
      for (int axis = 0; axis < 3; ++axis) {
        point[axis] = part.foot[axis] + part.scale[axis] * point[axis];
      }
      scene.vertices[i] = Placed(point, part.origin, part.cos_yaw, part.sin_yaw).cast<float>();
    }
  }
  return scene;
}

}  // namespace lightfit
