#include "bench/wrong_pixel_table.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/text_file.h"

namespace lightfit {

const char* BiasName(Bias bias) { return bias == Bias::kIdeal ? "ideal" : "practical"; }

WrongPixelTable::WrongPixelTable(std::vector<std::string> methods) : methods_(std::move(methods)) {
  ours_ = Column(kLightfitName);
}

size_t WrongPixelTable::Column(const std::string& method) const {
  return std::find(methods_.begin(), methods_.end(), method) - methods_.begin();
}

void WrongPixelTable::Add(const std::string& scene, const LightComparison& comparison) {
  LightRow row;
  row.scene = scene;
  row.light = comparison.light.name;
  for (const std::string& method : methods_) {
    const ComparedRow* map = comparison.Find(method);
    if (map == nullptr || !map->status.ok() || !map->wrong.has_value()) {
      ++num_left_out_;
      return;
    }
    row.wrong[0].push_back(map->wrong->ideal);
    row.wrong[1].push_back(map->wrong->practical);
  }
  lights_.push_back(std::move(row));
}

std::vector<size_t> WrongPixelTable::WorstTenth(Bias bias, size_t method) const {
  std::vector<size_t> order(lights_.size());
  std::iota(order.begin(), order.end(), 0);
  const int b = static_cast<int>(bias);
  std::stable_sort(order.begin(), order.end(), [&](size_t i, size_t j) {
    return lights_[i].wrong[b][method] > lights_[j].wrong[b][method];
  });
  order.resize((lights_.size() + 9) / 10);
  return order;
}

std::vector<int64_t> WrongPixelTable::Totals(Bias bias, const std::string& worst_of) const {
  std::vector<size_t> chosen(lights_.size());
  std::iota(chosen.begin(), chosen.end(), 0);
  if (!worst_of.empty()) chosen = WorstTenth(bias, Column(worst_of));
  std::vector<int64_t> totals(methods_.size(), 0);
  for (const size_t light : chosen) {
    for (size_t i = 0; i < methods_.size(); ++i) {
      totals[i] += lights_[light].wrong[static_cast<int>(bias)][i];
    }
  }
  return totals;
}

std::vector<double> WrongPixelTable::MeanRatios(Bias bias) const {
  std::vector<double> means(methods_.size(), 0.0);
  for (const LightRow& light : lights_) {
    const std::vector<int64_t>& wrong = light.wrong[static_cast<int>(bias)];
    for (size_t i = 0; i < methods_.size(); ++i) {
      means[i] += std::log((wrong[i] + 1.0) / (wrong[ours_] + 1.0));
    }
  }
  for (double& mean : means) mean = std::exp(mean / std::max<size_t>(1, lights_.size()));
  return means;
}

std::string WrongPixelTable::RatioText(Bias bias) const {
  const std::vector<int64_t> totals = Totals(bias);
  const std::vector<double> means = MeanRatios(bias);
  std::string text = absl::StrFormat("%-15s %12s %12s %12s %12s %7s\n",
                                     absl::StrCat(BiasName(bias), " bias"),
                                     "wrong pixels",
                                     "ours / total",
                                     "ours / mean",
                                     "worst light",
                                     "ahead");
  for (size_t i = 0; i < methods_.size(); ++i) {
    int num_ahead = 0;
    double worst = 0.0;
    for (const LightRow& light : lights_) {
      const std::vector<int64_t>& wrong = light.wrong[static_cast<int>(bias)];
      if (wrong[i] < wrong[ours_]) ++num_ahead;
      worst = std::max(worst, (wrong[ours_] + 1.0) / (wrong[i] + 1.0));
    }
    absl::StrAppend(&text,
                    absl::StrFormat("%-15s %12d %12.3f %12.3f %12.2f %7d\n",
                                    methods_[i],
                                    totals[i],
                                    static_cast<double>(totals[ours_]) /
                                        static_cast<double>(std::max<int64_t>(1, totals[i])),
                                    1.0 / means[i],
                                    worst,
                                    num_ahead));
  }
  return text;
}

std::string WrongPixelTable::RankingText(Bias bias,
                                         const std::string& reference,
                                         const std::vector<std::string>& columns,
                                         const std::vector<PublishedRow>& published) const {
  const size_t reference_column = Column(reference);
  std::string text =
      absl::StrFormat("%-24s %12s", absl::StrCat(BiasName(bias), " bias"), reference);
  for (const std::string& column : columns)
    absl::StrAppend(&text, absl::StrFormat(" %22s", column));
  absl::StrAppend(&text, absl::StrFormat(" %10s %12s\n", kLightfitName, "ahead of it"));
  for (const PublishedRow& row : published) {
    const std::vector<int64_t> totals = Totals(bias, row.ranking);
    const auto percent_more = [&](size_t column) {
      return 100.0 * (static_cast<double>(totals[column]) /
                          static_cast<double>(std::max<int64_t>(1, totals[reference_column])) -
                      1.0);
    };
    absl::StrAppend(&text,
                    absl::StrFormat("%-24s %12d",
                                    row.ranking.empty() ? "all lights" : "worst of " + row.ranking,
                                    totals[reference_column]));
    for (size_t i = 0; i < columns.size(); ++i) {
      const std::string theirs = i < row.percent_more.size()
                                     ? absl::StrFormat(" (%+.0f %%)", row.percent_more[i])
                                     : std::string();
      absl::StrAppend(
          &text,
          absl::StrFormat(" %22s",
                          absl::StrFormat("%+.0f %%", percent_more(Column(columns[i]))) + theirs));
    }
    std::string ahead;
    for (size_t i = 0; i < methods_.size(); ++i) {
      if (totals[i] < totals[ours_])
        absl::StrAppend(&ahead, ahead.empty() ? "" : ", ", methods_[i]);
    }
    absl::StrAppend(&text,
                    absl::StrFormat(" %10s %12s\n",
                                    absl::StrFormat("%+.0f %%", percent_more(ours_)),
                                    ahead.empty() ? "none" : ahead));
  }
  return text;
}

std::string WrongPixelTable::BehindText(Bias bias, double factor, int num_shown) const {
  struct Behind {
    double ratio;
    size_t light, method;
  };
  std::vector<Behind> behind;
  const int b = static_cast<int>(bias);
  for (size_t light = 0; light < lights_.size(); ++light) {
    const std::vector<int64_t>& wrong = lights_[light].wrong[b];
    size_t best = ours_;
    for (size_t i = 0; i < wrong.size(); ++i) {
      if (i != ours_ && (best == ours_ || wrong[i] < wrong[best])) best = i;
    }
    if (best == ours_) continue;
    const double ratio = (wrong[ours_] + 1.0) / (wrong[best] + 1.0);
    if (ratio > factor) behind.push_back({ratio, light, best});
  }
  std::stable_sort(behind.begin(), behind.end(), [](const Behind& x, const Behind& y) {
    return x.ratio > y.ratio;
  });
  std::string text = absl::StrFormat(
      "%s bias: ours has more than %g times the fewest wrong pixels of any other method on %d of "
      "%d lights\n",
      BiasName(bias),
      factor,
      behind.size(),
      lights_.size());
  for (size_t i = 0; i < behind.size() && i < static_cast<size_t>(num_shown); ++i) {
    const LightRow& light = lights_[behind[i].light];
    absl::StrAppend(&text,
                    absl::StrFormat("  %.2fx %s %s: %d, %s %d\n",
                                    behind[i].ratio,
                                    light.scene,
                                    light.light,
                                    light.wrong[b][ours_],
                                    methods_[behind[i].method],
                                    light.wrong[b][behind[i].method]));
  }
  return text;
}

absl::Status WrongPixelTable::WriteCsv(const std::string& path) const {
  std::string text = "scene,light";
  for (const std::string& method : methods_) {
    absl::StrAppend(&text, ",", method, " ideal,", method, " practical");
  }
  absl::StrAppend(&text, "\n");
  for (const LightRow& light : lights_) {
    absl::StrAppend(&text, light.scene, ",", light.light);
    for (size_t i = 0; i < methods_.size(); ++i) {
      absl::StrAppend(&text, ",", light.wrong[0][i], ",", light.wrong[1][i]);
    }
    absl::StrAppend(&text, "\n");
  }
  return WriteTextFileAtomically(path, text);
}

}  // namespace lightfit
