#include "bench/plans/plan_table.h"

#include <algorithm>
#include <cstdio>

#include "absl/strings/str_format.h"
#include "base/text_file.h"
#include "bench/wrong_ratio.h"

namespace lightfit {
namespace {

using Lights = std::vector<const PlannedLightRow*>;

// Of a row over another, over the lights that have both.
std::string RatioText(const Lights& lights,
                      size_t row,
                      size_t reference,
                      double MeasuredPlan::*kind,
                      bool with_worst = false) {
  WrongRatio ratio;
  for (const PlannedLightRow* light : lights) {
    const MeasuredPlan& measured = light->rows[row];
    const MeasuredPlan& other = light->rows[reference];
    if (measured.is_there && other.is_there) ratio.Add(measured.*kind, other.*kind);
  }
  return ratio.Text(with_worst);
}

void PrintRatios(const std::string& title, const std::vector<PlanRow>& rows, const Lights& lights) {
  if (lights.empty()) return;
  std::printf("\n== %s: %d lights\n", title.c_str(), static_cast<int>(lights.size()));
  std::printf("%-24s %-16s %-16s %-12s %-12s %-12s %-6s %-8s %-6s %s\n",
              "over one map:",
              "ideal, worst",
              "practical",
              "/one chosen",
              "/published",
              "/ZP4+LiSPSM",
              "maps",
              "overlap",
              "draws",
              "time in fits");
  for (size_t row = 0; row < rows.size(); ++row) {
    double seconds = 0.0, seconds_of_one = 0.0, num_maps = 0.0, overlap = 0.0, draws = 0.0;
    int count = 0, num_plans = 0;
    for (const PlannedLightRow* light : lights) {
      const MeasuredPlan& measured = light->rows[row];
      if (!measured.is_there) continue;
      ++count;
      num_plans += measured.is_plan ? 1 : 0;
      seconds += measured.seconds;
      seconds_of_one += light->rows[0].seconds;
      num_maps += measured.num_maps;
      overlap += measured.overlap;
      draws += measured.draws;
    }
    if (count == 0) continue;
    const auto of_plans = [num_plans](double sum) {
      return num_plans > 0 ? absl::StrFormat("%.2f", sum / num_plans) : "-";
    };
    std::printf("%-24s %-16s %-16s %-12s %-12s %-12s %-6.1f %-8s %-6s %.1f\n",
                rows[row].name.c_str(),
                RatioText(lights, row, kOneMap, &MeasuredPlan::ideal, true).c_str(),
                RatioText(lights, row, kOneMap, &MeasuredPlan::practical).c_str(),
                RatioText(lights, row, kOneChosen, &MeasuredPlan::ideal).c_str(),
                RatioText(lights, row, kAsPublishedMap, &MeasuredPlan::ideal).c_str(),
                RatioText(lights, row, kZp4, &MeasuredPlan::ideal).c_str(),
                num_maps / count,
                of_plans(overlap).c_str(),
                of_plans(draws).c_str(),
                seconds / seconds_of_one);
  }
}

// How many lights a row has more than `factor` times the wrong pixels of another on.
int NumBehind(const Lights& lights, size_t row, size_t other, double factor) {
  return static_cast<int>(
      std::count_if(lights.begin(), lights.end(), [&](const PlannedLightRow* light) {
        const MeasuredPlan& measured = light->rows[row];
        const MeasuredPlan& reference = light->rows[other];
        return measured.is_there && reference.is_there &&
               measured.ideal > factor * reference.ideal + 1.0;
      }));
}

// On how many lights plans of several maps are behind others.
void PrintBehind(const std::vector<PlanRow>& rows, const Lights& lights) {
  std::printf("\n== lights of %d on which a row has more wrong pixels than ...\n",
              static_cast<int>(lights.size()));
  std::printf("%-24s %-18s", "", "1.1 ZP4+LiSPSM");
  for (const PlanRow& row : rows) {
    if (row.kind == PlanRow::Kind::kPublished) std::printf(" %s", row.name.c_str());
  }
  std::printf("\n");
  for (size_t row = 0; row < rows.size(); ++row) {
    if (rows[row].kind != PlanRow::Kind::kOurs) continue;
    std::printf("%-24s %-18d", rows[row].name.c_str(), NumBehind(lights, row, kZp4, 1.1));
    for (size_t other = 0; other < rows.size(); ++other) {
      if (rows[other].kind != PlanRow::Kind::kPublished) continue;
      std::printf(
          " %*d", static_cast<int>(rows[other].name.size()), NumBehind(lights, row, other, 1.0));
    }
    std::printf("\n");
  }
}

}  // namespace

void PrintPlanTables(const std::vector<PlanRow>& rows, const std::vector<PlannedLightRow>& lights) {
  Lights all, indoors;
  for (size_t begin = 0; begin < lights.size();) {
    Lights of_scene;
    size_t end = begin;
    for (; end < lights.size() && lights[end].scene == lights[begin].scene; ++end) {
      of_scene.push_back(&lights[end]);
      all.push_back(&lights[end]);
      const std::string& name = lights[end].scene;
      if (name == "sponza_atrium" || name.find("room") != std::string::npos)
        indoors.push_back(&lights[end]);
    }
    PrintRatios(lights[begin].scene, rows, of_scene);
    begin = end;
  }
  PrintRatios("indoors", rows, indoors);
  PrintRatios("all", rows, all);
  PrintBehind(rows, all);
}

absl::Status WritePlanCsv(const std::string& path,
                          const std::vector<PlanRow>& rows,
                          const std::vector<PlannedLightRow>& lights) {
  std::string text =
      "scene,light,row,maps,ideal,practical,outside,overlap,draws,foretold,seconds\n";
  for (const PlannedLightRow& light : lights) {
    for (size_t row = 0; row < rows.size(); ++row) {
      const MeasuredPlan& measured = light.rows[row];
      if (!measured.is_there) continue;
      const std::string of_plan =
          measured.is_plan
              ? absl::StrFormat("%g,%g,%g", measured.overlap, measured.draws, measured.foretold)
              : ",,";
      absl::StrAppendFormat(&text,
                            "%s,%s,\"%s\",%d,%g,%g,%g,%s,%g\n",
                            light.scene,
                            light.light,
                            rows[row].name,
                            measured.num_maps,
                            measured.ideal,
                            measured.practical,
                            measured.outside,
                            of_plan,
                            measured.seconds);
    }
  }
  return WriteTextFileAtomically(path, text);
}

}  // namespace lightfit
