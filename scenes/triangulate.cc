#include "scenes/triangulate.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/exact_sum.h"

namespace lightfit {

namespace {

// As of DropBadTriangles(): squares of coordinates stay finite.
constexpr double kMaxCoordinate = 1e18;

// Corners and boxes that are looked at for each corner of a polygon. Outlines that do not cross
// themselves take a hundred or so.
constexpr int64_t kStepsPerCorner = 2000, kMinSteps = 1'000'000;

// So many corners are looked at together.
constexpr size_t kBucket = 8;

// Shewchuk's bound for the rounding of the determinant below.
constexpr double kRoundingShare = 3.3306690738754716e-16;

// The sign of the area of the triangle a b c, exactly: 1 is counterclockwise.
int Orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const double left = (a.x() - c.x()) * (b.y() - c.y());
  const double right = (a.y() - c.y()) * (b.x() - c.x());
  const double area = left - right;
  if (std::abs(area) > kRoundingShare * (std::abs(left) + std::abs(right))) {
    return area > 0.0 ? 1 : -1;
  }
  return OrientationOfRays(a.homogeneous(), b.homogeneous(), c.homogeneous());
}

// Whether the box lies for certain beyond one side of the counterclockwise triangle.
bool IsOutside(const Eigen::Vector2d& low,
               const Eigen::Vector2d& high,
               const Eigen::Vector2d (&triangle)[3]) {
  for (int side = 0; side < 3; ++side) {
    const Eigen::Vector2d& a = triangle[side];
    const Eigen::Vector2d edge = triangle[(side + 1) % 3] - a;
    // The corner of the box that is farthest inside.
    const double x = (edge.y() > 0.0 ? low : high).x(), y = (edge.x() > 0.0 ? high : low).y();
    const double left = edge.x() * (y - a.y()), right = edge.y() * (x - a.x());
    if (left - right < -2.0 * kRoundingShare * (std::abs(left) + std::abs(right))) return true;
  }
  return false;
}

}  // namespace

bool Triangulator::Append(absl::Span<const int> corners, std::vector<Eigen::Vector3i>* triangles) {
  const auto append_fan = [corners, triangles] {
    for (size_t i = 2; i < corners.size(); ++i) {
      triangles->emplace_back(corners[0], corners[i - 1], corners[i]);
    }
  };
  if (corners.size() <= 3 || !IsFine(corners) || !Project(corners) || IsFan()) {
    append_fan();
    return true;
  }
  return ClipEars(triangles);
}

bool Triangulator::IsFine(absl::Span<const int> corners) const {
  return std::all_of(corners.begin(), corners.end(), [this](int corner) {
    return corner >= 0 && corner < static_cast<int64_t>(positions_.size()) &&
           positions_[corner].allFinite() &&
           positions_[corner].cwiseAbs().maxCoeff() <= kMaxCoordinate;
  });
}

// Leaves out the axis along which the outline has most area, so that the others stay as they are,
// and turns it counterclockwise. False for an outline without area.
bool Triangulator::Project(absl::Span<const int> corners) {
  const Eigen::Vector3d first = positions_[corners[0]];
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (size_t i = 2; i < corners.size(); ++i) {
    normal += (positions_[corners[i - 1]] - first).cross(positions_[corners[i]] - first);
  }
  int axis = 0;
  if (!(normal.cwiseAbs().maxCoeff(&axis) > 0.0)) return false;
  int right = (axis + 1) % 3, up = (axis + 2) % 3;
  if (normal[axis] < 0.0) std::swap(right, up);
  const auto count = static_cast<int>(corners.size());
  corners_.resize(corners.size());
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d& position = positions_[corners[i]];
    corners_[i] = {{position[right], position[up]},
                   corners[i],
                   i == 0 ? count - 1 : i - 1,
                   i == count - 1 ? 0 : i + 1,
                   false};
  }
  num_left_ = count;
  return true;
}

bool Triangulator::IsFan() const {
  for (size_t i = 2; i < corners_.size(); ++i) {
    if (Orientation(corners_[0].at, corners_[i - 1].at, corners_[i].at) <= 0) return false;
  }
  return true;
}

void Triangulator::BuildTree() {
  const auto count = static_cast<int>(corners_.size());
  order_.resize(corners_.size());
  std::iota(order_.begin(), order_.end(), 0);
  leaf_of_.resize(corners_.size());
  size_t num_leaves = 1;
  while (num_leaves * kBucket < corners_.size()) num_leaves *= 2;
  boxes_.assign(2 * num_leaves - 1, Box());
  boxes_[0].end = count;
  for (size_t i = 0; i < boxes_.size(); ++i) {
    Box& box = boxes_[i];
    box.num_left = box.end - box.begin;
    box.low.setConstant(std::numeric_limits<double>::infinity());
    box.high = -box.low;
    for (int k = box.begin; k < box.end; ++k) {
      box.low = box.low.cwiseMin(corners_[order_[k]].at);
      box.high = box.high.cwiseMax(corners_[order_[k]].at);
    }
    if (2 * i + 2 >= boxes_.size()) {
      for (int k = box.begin; k < box.end; ++k) leaf_of_[order_[k]] = static_cast<int>(i);
      continue;
    }
    const int middle = box.begin + box.num_left / 2;
    const int axis = box.high.x() - box.low.x() >= box.high.y() - box.low.y() ? 0 : 1;
    std::nth_element(order_.begin() + box.begin,
                     order_.begin() + middle,
                     order_.begin() + box.end,
                     [this, axis](int a, int b) {
                       return std::pair(corners_[a].at[axis], a) <
                              std::pair(corners_[b].at[axis], b);
                     });
    boxes_[2 * i + 1].begin = box.begin;
    boxes_[2 * i + 1].end = middle;
    boxes_[2 * i + 2].begin = middle;
    boxes_[2 * i + 2].end = box.end;
  }
}

int Triangulator::Turn(int corner) const {
  const Corner& c = corners_[corner];
  return Orientation(corners_[c.previous].at, c.at, corners_[c.next].at);
}

// Whether the outline at a corner lies within the ear: the corner itself, or an edge from it when
// it is on the ear's border.
bool Triangulator::EntersEar(int corner, const Eigen::Vector2d (&ear)[3]) const {
  const Corner& c = corners_[corner];
  bool is_on_side[3];
  for (int side = 0; side < 3; ++side) {
    const int orientation = Orientation(ear[side], ear[(side + 1) % 3], c.at);
    if (orientation < 0) return false;
    is_on_side[side] = orientation == 0;
  }
  // On the cut: allowed when nothing else is left, as the corner will not belong to this triangle.
  if (is_strict_ && is_on_side[2] && !is_on_side[0] && !is_on_side[1]) return true;
  const auto enters = [&](const Eigen::Vector2d& other) {
    for (int side = 0; side < 3; ++side) {
      if (is_on_side[side] && Orientation(ear[side], ear[(side + 1) % 3], other) <= 0) return false;
    }
    return true;
  };
  return enters(corners_[c.previous].at) || enters(corners_[c.next].at);
}

// A corner that is no ear waits for what is in its way, or for other neighbours.
bool Triangulator::IsEar(int corner) {
  if (Turn(corner) <= 0) return false;
  const Corner& b = corners_[corner];
  const Eigen::Vector2d ear[3] = {corners_[b.previous].at, b.at, corners_[b.next].at};
  const int entering = FirstThatEnters(corner, ear);
  if (entering >= 0) waiting_for_[entering].push_back(corner);
  return entering < 0;
}

int Triangulator::FirstThatEnters(int corner, const Eigen::Vector2d (&ear)[3]) {
  const Eigen::Vector2d low = ear[0].cwiseMin(ear[1]).cwiseMin(ear[2]);
  const Eigen::Vector2d high = ear[0].cwiseMax(ear[1]).cwiseMax(ear[2]);
  pending_.assign(1, 0);
  while (!pending_.empty()) {
    const int index = pending_.back();
    const Box& box = boxes_[index];
    pending_.pop_back();
    --steps_left_;
    if (box.num_left == 0 || (box.low.array() > high.array()).any() ||
        (box.high.array() < low.array()).any() || IsOutside(box.low, box.high, ear)) {
      continue;
    }
    if (const int child = 2 * index + 1; child < static_cast<int>(boxes_.size())) {
      pending_.push_back(child + 1);
      pending_.push_back(child);
      continue;
    }
    steps_left_ -= box.end - box.begin;
    for (int k = box.begin; k < box.end; ++k) {
      const int other = order_[k];
      const Corner &c = corners_[other], &b = corners_[corner];
      if (c.is_clipped || other == corner || other == b.previous || other == b.next) continue;
      if (EntersEar(other, ear)) return other;
    }
  }
  return -1;
}

void Triangulator::Clip(int corner, bool keep, std::vector<Eigen::Vector3i>* triangles) {
  Corner& c = corners_[corner];
  Corner &previous = corners_[c.previous], &next = corners_[c.next];
  if (keep) triangles->emplace_back(previous.position, c.position, next.position);
  previous.next = c.next;
  next.previous = c.previous;
  c.is_clipped = true;
  --num_left_;
  last_clipped_next_ = c.next;
  // Who might be an ear now: the neighbours, and those whose ears this corner was in the way of.
  Enqueue(c.previous);
  Enqueue(c.next);
  for (const int waiting : waiting_for_[corner]) Enqueue(waiting);
  waiting_for_[corner].clear();
  for (int box = leaf_of_[corner];; box = (box - 1) / 2) {
    --boxes_[box].num_left;
    if (box == 0) break;
  }
}

bool Triangulator::ClipEars(std::vector<Eigen::Vector3i>* triangles) {
  BuildTree();
  const auto count = static_cast<int>(corners_.size());
  steps_left_ = kMinSteps + kStepsPerCorner * count;
  waiting_for_.assign(corners_.size(), {});
  is_queued_.assign(corners_.size(), 0);
  queue_.clear();
  is_strict_ = true;
  EnqueueAll();
  while (num_left_ > 2) {
    if (steps_left_ <= 0) return false;
    if (queue_.empty() && is_strict_) {
      is_strict_ = false;
      EnqueueAll();
    }
    if (queue_.empty()) {
      ClipOther(triangles);
      continue;
    }
    const int corner = queue_.front();
    queue_.pop_front();
    is_queued_[corner] = 0;
    if (!corners_[corner].is_clipped && IsEar(corner)) Clip(corner, true, triangles);
  }
  return true;
}

// Every other corner first: the ears beside one another are slivers.
void Triangulator::EnqueueAll() {
  for (const size_t first : {size_t{0}, size_t{1}}) {
    for (size_t i = first; i < corners_.size(); i += 2) Enqueue(static_cast<int>(i));
  }
}

void Triangulator::Enqueue(int corner) {
  if (corners_[corner].is_clipped || is_queued_[corner] != 0) return;
  is_queued_[corner] = 1;
  queue_.push_back(corner);
}

// No ear: what is left has no area, or crosses itself. Corners that say nothing go first.
void Triangulator::ClipOther(std::vector<Eigen::Vector3i>* triangles) {
  int corner = last_clipped_next_, convex = -1;
  for (int i = 0; i < num_left_; ++i, corner = corners_[corner].next) {
    --steps_left_;
    const int turn = Turn(corner);
    if (turn == 0) return Clip(corner, false, triangles);
    if (turn > 0 && convex < 0) convex = corner;
  }
  Clip(convex >= 0 ? convex : corner, convex >= 0, triangles);
}

}  // namespace lightfit
