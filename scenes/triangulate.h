// scenes/triangulate.h
//
// Polygons as triangles, concave ones too.
// In:   a polygon's corners in order, as indices of positions.
// Out:  triangles of the same corners that fill the polygon once.
//
// Ears are clipped where nothing of the outline enters them, told exactly: corners that lie on
// another edge or on another corner (holes that are joined to the outline by an edge there and
// back) are allowed. A polygon that is not flat is judged by its outline along its mean normal
// (Newell's); one that crosses itself gives some triangles of its corners.
//
// Of the triangulators at hand earcut has no C++ package in Debian 12, CGAL's may be left out of a
// build, and tinyobjloader's fills notches whose corners touch the outline.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <vector>

#include "absl/types/span.h"

namespace lightfit {

class Triangulator {
 public:
  // Refers to the positions, in which indices are looked up.
  explicit Triangulator(absl::Span<const Eigen::Vector3d> positions) : positions_(positions) {}

  // Appends the triangles. A convex polygon is a fan around its first corner, and so is one with a
  // corner that is not there or not finite: DropBadTriangles() looks. False when it would take time
  // out of proportion to the number of corners.
  bool Append(absl::Span<const int> corners, std::vector<Eigen::Vector3i>* triangles);

 private:
  struct Corner {
    Eigen::Vector2d at;
    int position = 0;  // index of
    int previous = 0, next = 0;
    bool is_clipped = false;
  };

  bool IsFine(absl::Span<const int> corners) const;
  bool Project(absl::Span<const int> corners);
  bool IsFan() const;
  void BuildTree();
  bool ClipEars(std::vector<Eigen::Vector3i>* triangles);
  bool IsEar(int corner);
  int FirstThatEnters(int corner, const Eigen::Vector2d (&ear)[3]);
  bool EntersEar(int corner, const Eigen::Vector2d (&ear)[3]) const;
  void EnqueueAll();
  void Enqueue(int corner);
  void ClipOther(std::vector<Eigen::Vector3i>* triangles);
  void Clip(int corner, bool keep, std::vector<Eigen::Vector3i>* triangles);
  int Turn(int corner) const;

  absl::Span<const Eigen::Vector3d> positions_;
  std::vector<Corner> corners_;
  int num_left_ = 0, last_clipped_next_ = 0;
  int64_t steps_left_ = 0;
  bool is_strict_ = true;

  // Corners that may be ears, and those that are none as long as another corner is there.
  std::deque<int> queue_;
  std::vector<uint8_t> is_queued_;
  std::vector<std::vector<int>> waiting_for_;

  // The corners in a tree of boxes, so that those in a triangle are found without looking at the
  // others: node i has the children 2 i + 1 and 2 i + 2, the last level's are buckets of corners.
  struct Box {
    Eigen::Vector2d low, high;
    int begin = 0, end = 0;  // in `order_`
    int num_left = 0;        // corners that are not clipped
  };
  std::vector<Box> boxes_;
  std::vector<int> order_, leaf_of_;
  std::vector<int> pending_;
};

}  // namespace lightfit
