// tests/testing/fit_candidates.h
//
// What FitByForecast() may choose among, every fit made and foretold by hand.
// In:   a read-back, a light, the map and options of a fit.
// Out:  the candidates in their order, and the one of them that the thresholds say.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/fit.h"
#include "optimizer/light_matrix.h"

namespace lightfit::testing {

struct FitCandidate {
  std::string name;
  double below;  // taken if below this share of what is foretold for the best before it
  absl::StatusOr<LightMatrix> matrix;
  double share = 1.0;  // foretold; where there is a matrix
};

// `options` with one border, from the read-back anew.
inline FitCandidate CandidateOf(const std::string& name,
                                double below,
                                const Readback& readback,
                                const Light& light,
                                MapSize map,
                                const FitOptions& options,
                                const SampleOptions& asked_for) {
  FitCandidate candidate = {name, below, FitLight(readback, light, map, options)};
  if (!candidate.matrix.ok()) return candidate;
  candidate.share = *ForetellWrongShare(
      readback, light, candidate.matrix->map_from_world, map, asked_for, candidate.matrix->border);
  return candidate;
}

// docs/defaults.md has the shares.
inline std::vector<FitCandidate> FitCandidates(const Readback& readback,
                                               const Light& light,
                                               MapSize map,
                                               const FitOptions& options) {
  std::vector<FitCandidate> all;
  const auto add = [&](const std::string& name, double below, FitOptions of, BorderChoice border) {
    of.border = border;
    all.push_back(CandidateOf(name, below, readback, light, map, of, options.samples));
  };
  const bool knows_facing =
      !readback.facing_bits.empty() && (readback.facing_lights >> light.shadow_bit & 1u) != 0;
  FitOptions coarse = options;
  coarse.use_fine_cover = false;
  add("lit", 1.0, coarse, BorderChoice::kLit);
  if (knows_facing) add("dark", 0.85, coarse, BorderChoice::kDark);
  if (readback.fine_cover != nullptr && options.use_fine_cover) {
    add("lit, fine", 1.0, options, BorderChoice::kLit);
    if (knows_facing) add("dark, fine", 0.85, options, BorderChoice::kDark);
  }
  if (knows_facing && options.search == Search::kGlobal) {
    add("focused", 0.9, FitOptions::Focused(options), BorderChoice::kLit);
    add("published", 0.9, FitOptions::AsPublished(options), BorderChoice::kLit);
  }
  return all;
}

inline const FitCandidate& ChosenOf(const std::vector<FitCandidate>& candidates) {
  const FitCandidate* best = &candidates.front();
  for (const FitCandidate& candidate : candidates) {
    if (!candidate.matrix.ok()) continue;
    if (!best->matrix.ok()) {
      best = &candidate;
      continue;
    }
    // Between two dark borders less is enough.
    const bool both_dark =
        candidate.matrix->border == Border::kDark && best->matrix->border == Border::kDark;
    if (candidate.share < (both_dark ? 1.0 : candidate.below) * best->share) best = &candidate;
  }
  return *best;
}

}  // namespace lightfit::testing
