// bench/fit.cc : how long fitting takes, against the method as published and against reading the
// input once.
//
// In:   boxes on a floor at four sizes with 32 lights, and the read-backs of a renderer where there
//       are any, under their own names.
// Out:  times by Google Benchmark, then tables of ratios of medians within this run.
//
//   BM_FitLights/default/<input>/<lights>       the library as it comes
//   BM_FitLights/squared/<input>/<lights>       ... with squared footprints and all receivers: the
//                                               same objective as published
//   BM_FitLights/as_published/<input>/<lights>  Chong & Gortler's Algorithm 1: every candidate
//                                               projects all receivers and sums all samples
//   BM_Search/as_published/<input>              its search alone, one light
//   BM_Search/hull_once/<input>                 ... with the receivers' hull taken once: a stronger
//                                               baseline
//   BM_Search/summary/<input>                   ... from the summary
//   BM_Summarize/<input>                        all that looks at pixels, one light, squared
//   BM_ReadOnce/<input>                         a plain sum over the same bytes
//   BM_FindReceivers, BM_CoverReceivers, BM_SelectSamples, BM_SummarizeSamples: the stages of it
//   BM_CoverShadowed, BM_EdgeNormals            what the default cover and metric add to them
//   BM_Fit/tiny_solver, BM_Fit/ceres            from the summary to the matrix
//
// --benchmark_filter, --benchmark_out=FILE and the rest work as usual. --slow adds the published
// method where one fit takes minutes.
#include "optimizer/fit.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "bench/fit_input.h"
#include "bench/medians.h"
#include "bench/quality_case.h"
#include "optimizer/readback/cover.h"
#include "optimizer/readback/edge_normals.h"
#include "optimizer/readback/samples.h"
#include "optimizer/readback/surfaces.h"
#include "optimizer/search/axis_evaluator.h"
#include "optimizer/search/line_search.h"

namespace lightfit {
namespace {

constexpr int kLightCounts[] = {1, 8, 32};
// The published method takes about a quarter of a microsecond per pixel and light. It is timed up
// to this many pixels times lights, and only once above the second.
constexpr int64_t kMaxPublished = 80'000'000;
constexpr int64_t kMaxRepeated = 500'000;

using Body = std::function<void()>;

benchmark::internal::Benchmark* Register(const std::string& name, int64_t items, Body body) {
  return benchmark::RegisterBenchmark(name.c_str(),
                                      [items, body = std::move(body)](benchmark::State& state) {
                                        for (auto _ : state) body();
                                        state.SetItemsProcessed(state.iterations() * items);
                                      })
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
}

void RegisterFitLights(const FitInput& input, int num_lights, bool slow) {
  const std::string suffix = absl::StrCat(input.name, "/", num_lights);
  Register("BM_FitLights/default/" + suffix, num_lights, [&input, num_lights] {
    benchmark::DoNotOptimize(FitLights(input.input.View(), input.Lights(num_lights), kFitMap));
  });
  Register("BM_FitLights/squared/" + suffix, num_lights, [&input, num_lights] {
    benchmark::DoNotOptimize(
        FitLights(input.input.View(), input.Lights(num_lights), kFitMap, QualityObjective()));
  });
  const bool is_slow = input.num_pixels() * num_lights > kMaxPublished;
  if (is_slow && !slow) return;
  auto* published =
      Register("BM_FitLights/as_published/" + suffix, num_lights, [&input, num_lights] {
        benchmark::DoNotOptimize(FitLights(
            input.input.View(), input.Lights(num_lights), kFitMap, FitOptions::AsPublished()));
      });
  if (input.num_pixels() * num_lights > kMaxRepeated) {
    published->Iterations(1)->Repetitions(1);
  }
}

// Adds up the input's bytes as a memory-bound pass would read them.
void ReadOnce(const Readback& readback) {
  float depth_sum[8] = {};
  uint32_t bits = 0;
  const size_t size = readback.depth.size();
  for (size_t i = 0; i + 8 <= size; i += 8) {
    for (size_t k = 0; k < 8; ++k) {
      depth_sum[k] += readback.depth[i + k];
      bits += readback.shadow_bits[i + k];
    }
  }
  benchmark::DoNotOptimize(depth_sum);
  benchmark::DoNotOptimize(bits);
}

void RegisterStages(const FitInput& input) {
  const int64_t pixels = input.num_pixels();
  const Light& light = input.input.lights.front();
  const uint32_t mask = uint32_t{1} << light.shadow_bit;
  const SampleOptions published_samples = QualityObjective().samples;
  Register("BM_ReadOnce/" + input.name, pixels, [&input] { ReadOnce(input.input.View()); });
  Register("BM_Summarize/" + input.name, pixels, [&input, &light] {
    benchmark::DoNotOptimize(Summarize(input.input.View(), light, QualityObjective()));
  });
  Register("BM_FindReceivers/" + input.name, pixels, [&input, mask, published_samples] {
    benchmark::DoNotOptimize(FindSurfaces(input.input.View(), mask, published_samples));
  });

  const auto receivers =
      std::make_shared<const Surfaces>(*FindSurfaces(input.input.View(), mask, published_samples));
  const auto cover =
      std::make_shared<const RayCover>(*CoverReceivers(*receivers, light, Cover::kReceivers));
  const auto samples = std::make_shared<const Samples>(SelectSamples(*receivers,
                                                                     light,
                                                                     receivers->options,
                                                                     cover->normalized_from_ray,
                                                                     /*with_edge_normals=*/false));
  const auto summary =
      std::make_shared<const Summary>(SummarizeSamples(*samples, *cover, MetricWeights()));
  const auto num_samples = static_cast<int64_t>(samples->size());
  Register("BM_CoverReceivers/" + input.name, pixels, [receivers, &light] {
    benchmark::DoNotOptimize(CoverReceivers(*receivers, light, Cover::kReceivers));
  });
  Register("BM_CoverShadowed/" + input.name, pixels, [receivers, &light] {
    benchmark::DoNotOptimize(CoverReceivers(*receivers, light, Cover::kShadowed));
  });
  Register("BM_EdgeNormals/" + input.name, num_samples, [receivers, samples, &light] {
    const EdgeNormals normals(receivers->readback,
                              receivers->affine_depth,
                              light.shadow_bit,
                              receivers->options.edge_window);
    for (size_t i = 0; i < samples->size(); ++i) {
      benchmark::DoNotOptimize(
          normals.At(static_cast<int>(samples->x[i]), static_cast<int>(samples->y[i])));
    }
  });
  Register("BM_SelectSamples/" + input.name, num_samples, [receivers, cover, &light] {
    benchmark::DoNotOptimize(
        SelectSamples(*receivers, light, receivers->options, cover->normalized_from_ray, false));
  });
  Register("BM_SummarizeSamples/" + input.name, num_samples, [samples, cover] {
    benchmark::DoNotOptimize(SummarizeSamples(*samples, *cover, MetricWeights()));
  });
  for (const Refiner refiner : {Refiner::kTinySolver, Refiner::kCeres}) {
    FitOptions options = QualityObjective();
    options.refiner = refiner;
    const char* variant = refiner == Refiner::kCeres ? "ceres/" : "tiny_solver/";
    Register(absl::StrCat("BM_Fit/", variant, input.name), 1, [summary, &light, options] {
      benchmark::DoNotOptimize(Fit(*summary, light, kFitMap, options));
    });
  }

  // The published search three ways, from the focused start.
  const FitOptions published = FitOptions::AsPublished();
  AffineProblem problem;
  problem.map = kFitMap;
  problem.affine = published.affine;
  problem.ray_space = published.ray_space;
  problem.normalized_from_ray = cover->normalized_from_ray;
  problem.margin_percent = published.margin_percent;
  const auto search = [published](AxisEvaluator& evaluator) {
    const std::optional<AffineFit> start = evaluator.Evaluate(Eigen::Vector3d::UnitZ());
    benchmark::DoNotOptimize(RotationLineSearch(evaluator, *start, published.line_search_rounds));
  };
  std::vector<Eigen::Vector3d> hull_rays;
  for (const Eigen::Vector2d& ray : cover->hull) hull_rays.emplace_back(ray.x(), ray.y(), 1.0);
  const double min_w = published.min_w;
  auto* as_published = Register(
      "BM_Search/as_published/" + input.name, pixels, [samples, search, problem, min_w, receivers] {
        SampleEvaluator evaluator(*samples, *receivers, MetricWeights(), problem, min_w);
        search(evaluator);
      });
  if (pixels > kMaxRepeated) as_published->Iterations(1)->Repetitions(1);
  Register("BM_Search/hull_once/" + input.name,
           num_samples,
           [samples, search, problem, min_w, hull_rays = std::move(hull_rays)] {
             SampleEvaluator evaluator(*samples, hull_rays, MetricWeights(), problem, min_w);
             search(evaluator);
           });
  Register("BM_Search/summary/" + input.name, 1, [summary, search, problem, min_w] {
    SummaryEvaluator evaluator(*summary, problem, min_w);
    search(evaluator);
  });
}

void PrintRatios(const std::deque<FitInput>& inputs, const MedianReporter& medians) {
  std::printf("\nAs published / default, one call of FitLights (default, ms)\n%-14s", "");
  for (const int count : kLightCounts)
    std::printf(" %24s", absl::StrCat(count, count == 1 ? " light" : " lights").c_str());
  for (const FitInput& input : inputs) {
    std::printf("\n%-14s", input.name.c_str());
    for (const int count : kLightCounts) {
      const std::string suffix = absl::StrCat(input.name, "/", count);
      const std::string ours = "BM_FitLights/default/" + suffix;
      const double ms = medians.Milliseconds(ours);
      std::printf(
          " %24s",
          ms > 0.0
              ? absl::StrFormat(
                    "%s (%.3g)", medians.Ratio("BM_FitLights/as_published/" + suffix, ours), ms)
                    .c_str()
              : "");
    }
  }
  struct Column {
    const char *title, *numerator, *denominator;
  };
  constexpr Column kColumns[] = {
      {"summary / read once", "BM_Summarize/", "BM_ReadOnce/"},
      {"search: published / summary", "BM_Search/as_published/", "BM_Search/summary/"},
      {"search: hull once / summary", "BM_Search/hull_once/", "BM_Search/summary/"},
      {"fit: Ceres / TinySolver", "BM_Fit/ceres/", "BM_Fit/tiny_solver/"}};
  std::printf("\n\nOne light\n%-14s", "");
  for (const Column& column : kColumns) std::printf(" %28s", column.title);
  for (const FitInput& input : inputs) {
    std::printf("\n%-14s", input.name.c_str());
    for (const Column& column : kColumns) {
      std::printf(
          " %28s",
          medians.Ratio(column.numerator + input.name, column.denominator + input.name).c_str());
    }
  }
  std::printf("\n");
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {
  bool slow = false;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--slow") != 0) continue;
    slow = true;
    std::rotate(argv + i, argv + i + 1, argv + argc);
    --argc;
  }
  std::vector<std::string> defaults = {"--benchmark_repetitions=5",
                                       "--benchmark_min_time=0.05",
                                       "--benchmark_report_aggregates_only=true"};
  std::vector<char*> flags = lightfit::WithDefaultFlags(argc, argv, &defaults);
  int num_flags = static_cast<int>(flags.size());
  benchmark::Initialize(&num_flags, flags.data());
  if (benchmark::ReportUnrecognizedArguments(num_flags, flags.data())) return 2;
  lightfit::AddRunContext();

  const std::deque<lightfit::FitInput> inputs = lightfit::MakeFitInputs();
  for (const lightfit::FitInput& input : inputs) {
    for (const int count : lightfit::kLightCounts) {
      if (count <= input.num_lights()) lightfit::RegisterFitLights(input, count, slow);
    }
    lightfit::RegisterStages(input);
  }
  lightfit::MedianReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();
  lightfit::PrintRatios(inputs, reporter);
}
