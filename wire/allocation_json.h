// wire/allocation_json.h
//
// Allocations as lightfit.v1.Allocation, and as JSON files.
// In:   a fit for each light at the size found for it, and how that size came about.
// Out:  v1::Allocation; a JSON text file, the same bytes for the same allocation, that readers of
//       FitResult take too.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "lightfit/v1/allocation.pb.h"
#include "optimizer/sizing/map_sizes.h"
#include "optimizer/sizing/tolerance.h"
#include "wire/result_json.h"

namespace lightfit {

// What a tolerance came to for one light: as in ToleranceMap.
struct ReachedTolerance {
  bool is_met = false;
  double reached_px = 0.0;
  int64_t num_samples = 0;
};

// Beside the light's fit.
struct AllocationEntry {
  double weight = 1.0;
  std::optional<double> equal_split_energy;  // in a square map of an equal share of the budget
  std::optional<ReachedTolerance> reached;
};

struct AllocationReport {
  FitReport fit;                         // FitReport::map is that of lights without one: 0 x 0
  std::vector<AllocationEntry> entries;  // element i belongs to fit.lights[i]
  MapSizeRules rules;
  std::optional<int64_t> budget_texels;  // or
  std::optional<Tolerance> tolerance;

  int64_t Texels() const;  // of all maps together

  // The share of the budget, or of all maps together, that light i has; 0 ... 1.
  double Share(size_t i) const;
};

// Footprints are finite numbers of a read-back's pixels, and stay so.
inline constexpr double kMaxImageScale = 1e6;

// InvalidArgument names the field: "tolerance.limit_px = ...". An image_scale of 0 is 1.
absl::StatusOr<Tolerance> ToleranceFromProto(const v1::Tolerance& proto);

v1::Allocation AllocationToProto(const AllocationReport& report);

// Replaces `path` in one step, see WriteTextFileAtomically().
absl::Status WriteAllocationJson(const std::string& path, const v1::Allocation& allocation);

absl::StatusOr<v1::Allocation> ReadAllocationJson(const std::string& path);

}  // namespace lightfit
