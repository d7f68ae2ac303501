// bench/wrong_pixel_table.h
//
// Wrong shadow pixels of many lights under every method, and the tables that they make.
// In:   LightComparisons with the same rows.
// Out:  text: ratios of totals and means, rankings by the worst lights, where ours is behind.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "jobs/compare/rows.h"
#include "picture/compare_choice.h"

namespace lightfit {

const char* BiasName(Bias bias);

class WrongPixelTable {
 public:
  // `methods` names the rows of the comparisons to keep, ours ("lightfit") among them.
  explicit WrongPixelTable(std::vector<std::string> methods);

  // Lights for which one of the methods has no matrix are left out and counted.
  void Add(const std::string& scene, const LightComparison& comparison);

  int num_lights() const { return static_cast<int>(lights_.size()); }
  int num_left_out() const { return num_left_out_; }

  // Of lights [0, num_lights()) or, with `worst_of` a method, of the tenth of them on which that
  // method has the most wrong pixels.
  std::vector<int64_t> Totals(Bias bias, const std::string& worst_of = "") const;

  // Geometric mean over all lights of (wrong + 1) over (ours + 1).
  std::vector<double> MeanRatios(Bias bias) const;

  // Totals and their ratio to ours, geometric means, and on how many lights a method is ahead.
  std::string RatioText(Bias bias) const;

  // Chong & Gortler's Table 1: per ranking the total of `reference` and, of every other method, how
  // many per cent more. `published` has their percentages, one row per ranking (all lights first).
  struct PublishedRow {
    std::string ranking;  // "" for all lights, else a method
    std::vector<double> percent_more;
  };
  std::string RankingText(Bias bias,
                          const std::string& reference,
                          const std::vector<std::string>& columns,
                          const std::vector<PublishedRow>& published) const;

  // Lights on which ours has more than `factor` times the fewest wrong pixels of any other method,
  // worst first, and how many there are.
  std::string BehindText(Bias bias, double factor, int num_shown) const;

  // One row per light: scene, light, and per method the ideal and the practical count.
  absl::Status WriteCsv(const std::string& path) const;

 private:
  struct LightRow {
    std::string scene, light;
    std::vector<int64_t> wrong[2];  // by Bias, then method
  };

  size_t Column(const std::string& method) const;
  std::vector<size_t> WorstTenth(Bias bias, size_t method) const;

  std::vector<std::string> methods_;
  size_t ours_;
  std::vector<LightRow> lights_;
  int num_left_out_ = 0;
};

}  // namespace lightfit
