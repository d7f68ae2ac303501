// jobs/shot/totals.h
//
// A shot in a few numbers per mode and light.
// In:   ShotRows.
// Out:  ShotTotals; the energy of one row beside that of the frame's own best matrix.
#pragma once

#include <optional>

#include "jobs/shot/result.h"

namespace lightfit {

// Energy over that of the per-frame matrix of the same frame and light. Absent without either, and
// where their borders differ, as then they serve other edges.
std::optional<double> EnergyRatio(const ShotRows& rows, const ShotRow& row);

struct ShotTotals {
  int num_frames = 0;   // that have a matrix
  int num_failed = 0;   // that have none
  int num_updates = 0;  // in which texels moved over surfaces, the first frame among them
  int num_maps = 0;     // of all frames together
  int num_moved = 0;    // of these, whose texels moved

  // Over the frames that have it; absent where none has.
  std::optional<double> energy_ratio;        // geometric mean of EnergyRatio()
  std::optional<double> phase_drift_texels;  // means of Crawl
  std::optional<double> edge_crawl_px;
  std::optional<double> wrong_share;  // mean of what is foretold, 0 ... 1
};

// Of one light, or of all.
ShotTotals TotalsOf(const ShotRows& rows,
                    ShotMode mode,
                    std::optional<size_t> light = std::nullopt);

}  // namespace lightfit
