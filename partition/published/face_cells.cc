#include "partition/published/face_cells.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "methods/view_body.h"
#include "partition/published/z_partition.h"

namespace lightfit {

namespace {

// Sine of an angle: what is seen at less has no area to speak of.
constexpr double kEdgeOn = 1e-5;

constexpr int kNumSides = 4;

// The view's edges, from corner to corner around the image.
struct ViewEdges {
  Eigen::Vector3d eye, forward;
  std::array<Eigen::Vector3d, kNumSides> near, far;

  Eigen::Vector3d At(int edge, double share) const {
    return near[edge % kNumSides] + share * (far[edge % kNumSides] - near[edge % kNumSides]);
  }
  Eigen::Vector3d Direction(int edge) const { return (far[edge % kNumSides] - eye).normalized(); }
};

ViewEdges EdgesOf(const Camera& camera) {
  const std::array<Eigen::Vector3d, 8> corners = FrustumCorners(camera);
  ViewEdges view = {EyePosition(camera), ViewDirection(camera), {}, {}};
  for (int i = 0; i < kNumSides; ++i) {
    view.near[i] = corners[i];
    view.far[i] = corners[kNumSides + i];
  }
  return view;
}

// The plane through the light and two points, with `inside` on its positive side.
Eigen::Vector4d PlaneThroughLight(const Light& light,
                                  const Eigen::Vector3d& from,
                                  const Eigen::Vector3d& to,
                                  const Eigen::Vector3d& inside) {
  const Eigen::Vector3d ray = light.kind == Light::Kind::kPoint
                                  ? Eigen::Vector3d(from - light.position)
                                  : light.direction.stableNormalized();
  const Eigen::Vector3d normal = ray.cross(to - from).normalized();
  return (normal.dot(inside - from) < 0.0 ? -1.0 : 1.0) *
         Eigen::Vector4d(normal.x(), normal.y(), normal.z(), -normal.dot(from));
}

// Sine of the angle at which the light shines onto a side from within the view, < 0 from without.
double SineOnto(const Light& light, const ViewEdges& view, int side) {
  const Eigen::Vector3d normal = view.Direction(side).cross(view.Direction(side + 1)).normalized();
  const double turn = normal.dot(view.Direction(side + 2)) < 0.0 ? -1.0 : 1.0;
  if (light.kind == Light::Kind::kDirectional) {
    return -turn * normal.dot(light.direction.stableNormalized());
  }
  const Eigen::Vector3d middle = 0.5 * (view.At(side, 1.0) + view.At(side + 1, 1.0));
  return turn * normal.dot((light.position - middle).stableNormalized());
}

// The sides whose cells the light's beams pass, and which of the other two faces have cells.
struct UsedFaces {
  std::array<bool, kNumSides> side = {};
  bool near = false, far = false;

  bool HasSides() const { return std::find(side.begin(), side.end(), true) != side.end(); }
};

UsedFaces FacesFor(const Light& light, const Camera& camera, const ViewEdges& view) {
  std::array<double, kNumSides> sines;
  for (int i = 0; i < kNumSides; ++i) sines[i] = SineOnto(light, view, i);
  UsedFaces faces;
  bool enters = light.direction.dot(view.forward) >= 0.0;
  if (light.kind == Light::Kind::kPoint) {
    const double depth = CameraDepth(camera, light.position);
    const double least_sine = *std::min_element(sines.begin(), sines.end());
    const bool is_within = least_sine > 0.0 && depth > camera.near && depth < camera.far;
    faces.near = faces.far = is_within;
    enters = depth <= camera.far && !is_within;
  }
  for (int i = 0; i < kNumSides; ++i) {
    faces.side[i] = (enters ? -sines[i] : sines[i]) > kEdgeOn;
  }
  return faces;
}

}  // namespace

std::vector<FaceCell> FaceCells(const Light& light,
                                const Camera& camera,
                                int num_parts,
                                bool has_near_face) {
  const ViewEdges view = EdgesOf(camera);
  UsedFaces faces = FacesFor(light, camera, view);
  if (!faces.HasSides()) return {FaceCell{}};
  faces.near = faces.near || has_near_face;
  const std::vector<double> depths = DepthSplits(camera.near, camera.far, num_parts, 1.0);
  // Cells overlap by the rounding of coordinates, so that none is lost where several meet.
  constexpr double kRounding = 1e-12;
  const double overlap = kRounding * (view.eye.norm() + camera.far);
  const auto grown = [overlap](Eigen::Vector4d plane) {
    plane.w() += overlap;
    return plane;
  };
  FaceCell near_face, far_face;
  std::vector<FaceCell> cells;
  for (int side = 0; side < kNumSides; ++side) {
    if (!faces.side[side]) continue;
    const int next = (side + 1) % kNumSides, before = (side + kNumSides - 1) % kNumSides;
    FaceCell whole;
    whole.side = side;
    whole.edges = {view.Direction(side), view.Direction(next)};
    // The plane of an edge is the same for the faces on both sides of it, but for its sign.
    const auto plane_of_edge = [&](int edge) {
      return PlaneThroughLight(light, view.eye, view.At(edge, 1.0), view.At(edge + 1, 1.0));
    };
    if (faces.side[before]) whole.half_spaces.push_back(grown(plane_of_edge(side)));
    if (faces.side[next]) whole.half_spaces.push_back(grown(-plane_of_edge(next)));
    std::vector<Eigen::Vector4d> beyond;  // each of the depths on this side
    for (const double depth : depths) {
      const double share = (depth - camera.near) / (camera.far - camera.near);
      beyond.push_back(PlaneThroughLight(
          light, view.At(side, share), view.At(next, share), view.At(side, share + 1.0)));
    }
    for (int i = 0; i < num_parts; ++i) {
      FaceCell cell = whole;
      cell.part = i;
      if (i > 0 || faces.near) cell.half_spaces.push_back(grown(beyond[i]));
      if (i + 1 < num_parts || faces.far) cell.half_spaces.push_back(grown(-beyond[i + 1]));
      cells.push_back(std::move(cell));
    }
    near_face.half_spaces.push_back(grown(-beyond.front()));
    far_face.half_spaces.push_back(grown(beyond.back()));
  }
  if (faces.near) cells.push_back(std::move(near_face));
  if (faces.far) cells.push_back(std::move(far_face));
  return cells;
}

}  // namespace lightfit
