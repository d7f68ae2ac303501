#include "bench/fit_input.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "optimizer/fit.h"

namespace lightfit {

namespace {

constexpr uint64_t kSeed = 7;
constexpr MapSize kReadbackSizes[] = {{180, 180}, {640, 360}, {1920, 1080}, {3840, 2160}};

FitInput MakeFitInput(Input input, std::string name) {
  FitOptions published = FitOptions::AsPublished();
  published.sample_by_sample = false;  // the same search, quickly
  const auto fits = FitLights(input.View(), input.lights, kFitMap, published);
  std::vector<std::pair<int, Light>> fitted;
  for (size_t i = 0; i < fits.size(); ++i) {
    if (fits[i].ok()) fitted.emplace_back(fits[i]->search.evaluations, input.lights[i]);
  }
  std::stable_sort(
      fitted.begin(), fitted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::rotate(fitted.begin(), fitted.begin() + fitted.size() / 2, fitted.end());
  input.lights.clear();
  for (const auto& [evaluations, light] : fitted) input.lights.push_back(light);
  return {std::move(name), std::move(input)};
}

}  // namespace

std::deque<FitInput> MakeFitInputs() {
  std::deque<FitInput> inputs;
  for (const MapSize size : kReadbackSizes) {
    inputs.push_back(MakeFitInput(BoxInput(kSeed, size.width, size.height, kMaxLights),
                                  absl::StrCat(size.width, "x", size.height)));
  }
  for (const char* set : {"yard_180", "yard_640", "room_1080p"}) {
    absl::StatusOr<Input> input =
        ReadInput(absl::StrCat(DefaultReadbackFolder(), "/", set), "0001");
    if (input.ok()) inputs.push_back(MakeFitInput(*std::move(input), set));
  }
  const auto is_empty = [](const FitInput& input) { return input.num_lights() == 0; };
  inputs.erase(std::remove_if(inputs.begin(), inputs.end(), is_empty), inputs.end());
  return inputs;
}

}  // namespace lightfit
