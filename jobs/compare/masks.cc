#include "jobs/compare/masks.h"

#include <set>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"

namespace lightfit {
namespace {

constexpr char kTruthLayer[] = "truth";

// One value for each pixel, 1 where `is_set` says so of its truth and its shadow.
template <typename IsSet>
ExrImage Mask(std::string channel,
              absl::Span<const Lighting> truth,
              absl::Span<const Lighting> shadows,
              const IsSet& is_set) {
  ExrImage mask = {std::move(channel), std::vector<float>(truth.size(), 0.0F), /*is_mask=*/true};
  for (size_t i = 0; i < truth.size(); ++i) {
    if (is_set(truth[i], shadows[i])) mask.values[i] = 1.0F;
  }
  return mask;
}

bool IsWrong(Lighting truth, Lighting shadow) { return IsJudged(truth) && shadow != truth; }

// Different for each method.
std::string LayerOf(const std::string& method, std::set<std::string>* taken) {
  const std::string name = absl::StrReplaceAll(method, {{" ", "_"}});
  std::string layer = name;
  for (int number = 2; !taken->insert(layer).second; ++number) {
    layer = absl::StrCat(name, "_", number);
  }
  return layer;
}

}  // namespace

absl::StatusOr<std::vector<ExrImage>> MaskImages(const LightComparison& light) {
  if (light.truth.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("light \"", light.light.name, "\": no truth to find wrong pixels by"));
  }
  const absl::Span<const Lighting> truth = light.truth;
  std::vector<ExrImage> images;
  images.push_back(
      Mask(absl::StrCat(kTruthLayer, ".shadow"), truth, truth, [](Lighting is, Lighting) {
        return is == Lighting::kShadowed;
      }));
  images.push_back(
      Mask(absl::StrCat(kTruthLayer, ".facing"), truth, truth, [](Lighting is, Lighting) {
        return IsJudged(is);
      }));
  std::set<std::string> taken = {kTruthLayer};
  for (const ComparedRow& row : light.rows) {
    if (!row.status.ok() || row.image.ideal.size() != truth.size() ||
        row.image.practical.size() != truth.size()) {
      continue;
    }
    const std::string layer = LayerOf(row.name, &taken);
    images.push_back(Mask(absl::StrCat(layer, ".ideal"), truth, row.image.ideal, IsWrong));
    images.push_back(Mask(absl::StrCat(layer, ".practical"), truth, row.image.practical, IsWrong));
  }
  return images;
}

std::vector<std::string> MaskFileNames(absl::Span<const Light> lights) {
  std::set<std::string> taken;
  std::vector<std::string> names;
  for (const Light& light : lights) {
    std::string stem = light.name;
    for (char& letter : stem) {
      if (!absl::ascii_isalnum(static_cast<unsigned char>(letter)) && letter != '.' &&
          letter != '_' && letter != '-') {
        letter = '_';
      }
    }
    // A hidden file, or a folder above.
    if (stem.empty() || stem.front() == '.') stem = absl::StrCat("_", stem);
    std::string name = stem;
    for (int number = 2; !taken.insert(name).second; ++number) {
      name = absl::StrCat(stem, "_", number);
    }
    names.push_back(name + ".exr");
  }
  return names;
}

}  // namespace lightfit
