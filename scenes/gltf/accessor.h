// scenes/gltf/accessor.h
//
// The numbers of an accessor: any component type, normalized or not, sparse or not.
// In:   a Document and the accessor's index.
// Out:  its numbers as doubles.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "scenes/gltf/document.h"

namespace lightfit::gltf {

struct Numbers {
  int64_t count = 0;   // of elements
  int components = 1;  // of each
  std::vector<double> values;

  double At(int64_t element, int component) const {
    return values[static_cast<size_t>(element * components + component)];
  }
  // Of elements with three components or more.
  Eigen::Vector3d VectorAt(int64_t element) const {
    return {At(element, 0), At(element, 1), At(element, 2)};
  }
};

// InvalidArgument unless each element has `components` numbers, and when the bytes are not there.
absl::StatusOr<Numbers> ReadAccessor(Document* document, int64_t index, int components);

// How many elements the accessor states.
absl::StatusOr<int64_t> CountOf(const Document& document, int64_t index);

}  // namespace lightfit::gltf
