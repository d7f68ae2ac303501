// partition/ray_leaves.h
//
// Rays sorted into groups of those that lie close together.
// In:   items, each with a unit direction and a key of its own.
// Out:  the leaves of a tree of halves, left to right; the same on every machine.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <tuple>

#include "base/scratch.h"

namespace lightfit {

// So that there are about `max_leaves`, none of fewer items than are worth a bin.
inline size_t MostInLeaf(size_t num_items, int max_leaves) {
  constexpr size_t kLeast = 8;
  return std::max(kLeast, (num_items + max_leaves - 1) / static_cast<size_t>(max_leaves));
}

// Sorts items [begin, end) and calls visit(begin, end) for each leaf. `Item` has `direction`, an
// Eigen::Vector3d, and `Key()`, which no other item has.
template <typename Item, typename Visitor>
void ForEachLeaf(ScratchVector<Item>& items,
                 size_t begin,
                 size_t end,
                 size_t most_in_leaf,
                 const Visitor& visit) {
  if (end - begin <= most_in_leaf) {
    visit(begin, end);
    return;
  }
  Eigen::AlignedBox3d box;
  for (size_t i = begin; i < end; ++i) box.extend(items[i].direction);
  int along = 0;
  box.sizes().maxCoeff(&along);
  const size_t middle = begin + (end - begin) / 2;
  std::nth_element(items.begin() + begin,
                   items.begin() + middle,
                   items.begin() + end,
                   [along](const Item& a, const Item& b) {
                     return std::tuple(a.direction(along), a.Key()) <
                            std::tuple(b.direction(along), b.Key());
                   });
  ForEachLeaf(items, begin, middle, most_in_leaf, visit);
  ForEachLeaf(items, middle, end, most_in_leaf, visit);
}

}  // namespace lightfit
