// cli/flags/choices.h
//
// The words of the command line for the library's enumerations, both ways.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "geometry/camera.h"
#include "geometry/clip.h"
#include "optimizer/fit_options.h"

namespace lightfit::cli {

template <typename Value>
using Words = std::vector<std::pair<std::string, Value>>;

const Words<Search>& SearchWords();
const Words<Affine>& AffineWords();
const Words<Metric>& MetricWords();
const Words<Cover>& CoverWords();
const Words<BorderChoice>& BorderWords();
const Words<DepthKind>& DepthKindWords();
const Words<ClipConvention>& ClipWords();

template <typename Value>
std::vector<std::string> WordsOnly(const Words<Value>& words) {
  std::vector<std::string> only;
  only.reserve(words.size());
  for (const auto& [word, value] : words) only.push_back(word);
  return only;
}

template <typename Value>
std::string WordFor(const Words<Value>& words, Value wanted) {
  for (const auto& [word, value] : words) {
    if (value == wanted) return word;
  }
  return "?";
}

}  // namespace lightfit::cli
