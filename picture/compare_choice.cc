#include "picture/compare_choice.h"

#include <algorithm>
#include <cstdlib>
#include <tuple>

#include "methods/method.h"

namespace lightfit {

int64_t CountOf(const ComparedRow& map, Bias bias) {
  return bias == Bias::kIdeal ? map.wrong->ideal : map.wrong->practical;
}

const std::vector<Lighting>& ShadowsOf(const ComparedRow& map, Bias bias) {
  return bias == Bias::kIdeal ? map.image.ideal : map.image.practical;
}

bool HasImage(const ComparedRow& map) { return map.status.ok() && map.wrong.has_value(); }

std::vector<const ComparedRow*> InOrder(const LightComparison& light, Bias bias) {
  std::vector<const ComparedRow*> maps;
  for (const ComparedRow& map : light.rows) maps.push_back(&map);
  const auto key = [&](const ComparedRow* map) {
    const bool is_ours = map == &light.lightfit();
    const int64_t count = HasImage(*map) ? CountOf(*map, bias) : 0;
    return std::tuple(!is_ours, !HasImage(*map), count);
  };
  std::stable_sort(maps.begin(), maps.end(), [&](const ComparedRow* a, const ComparedRow* b) {
    return key(a) < key(b);
  });
  return maps;
}

const ComparedRow* Rival(const LightComparison& light, Bias bias) {
  const ComparedRow* focused = light.Find(MethodName(Method::kFocused));
  if (focused != nullptr && HasImage(*focused)) return focused;
  const ComparedRow* worst = nullptr;
  for (const ComparedRow& map : light.rows) {
    if (!HasImage(map) || &map == &light.lightfit()) continue;
    if (worst == nullptr || CountOf(map, bias) > CountOf(*worst, bias)) worst = &map;
  }
  return worst;
}

CropBox ChooseCrop(const LightComparison& light, Bias bias, int width, int height, CropBox size) {
  std::vector<int32_t> gain(static_cast<size_t>(width) * height, 0);
  const auto add = [&](const ComparedRow* map, int32_t sign) {
    if (map == nullptr || !HasImage(*map)) return;
    const std::vector<uint8_t> wrong = WrongMask(light.truth, ShadowsOf(*map, bias));
    for (size_t i = 0; i < wrong.size(); ++i) gain[i] += sign * wrong[i];
  };
  add(Rival(light, bias), 1);
  add(&light.lightfit(), -1);
  return BestCrop(gain, width, height, size);
}

size_t MostTellingLight(absl::Span<const LightComparison> lights, Bias bias) {
  size_t best = 0;
  int64_t best_difference = -1;
  for (size_t i = 0; i < lights.size(); ++i) {
    const ComparedRow* focused = lights[i].Find(MethodName(Method::kFocused));
    if (focused == nullptr || !HasImage(*focused) || !HasImage(lights[i].lightfit())) continue;
    const int64_t difference =
        std::abs(CountOf(*focused, bias) - CountOf(lights[i].lightfit(), bias));
    if (difference <= best_difference) continue;
    best_difference = difference;
    best = i;
  }
  return best;
}

}  // namespace lightfit
