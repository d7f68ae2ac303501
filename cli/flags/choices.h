// cli/flags/choices.h
//
// The words of the command line for the library's enumerations, both ways: options, help and
// completion have them from here. What else people call them is understood too.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "geometry/camera.h"
#include "geometry/clip.h"
#include "optimizer/fit_options.h"
#include "render/judge.h"

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
const Words<Bias>& BiasWords();
const Words<std::string>& LogLevelWords();

// "Reversed_Z" is "reversed-z": upper case and underscores do not count.
std::string PlainWord(std::string text);

// The words that mean what `text` says: itself, and where it is what others call them, as "d3d" is
// "direct3d", that. Of several the first that a table has counts.
std::vector<std::string> MeantBy(const std::string& text);

template <typename Value>
std::vector<std::string> WordsOnly(const Words<Value>& words) {
  std::vector<std::string> only;
  only.reserve(words.size());
  for (const auto& [word, value] : words) only.push_back(word);
  return only;
}

// The value that `text` stands for, in any case and by any name; null where there is none.
template <typename Value>
const Value* FindValue(const Words<Value>& words, const std::string& text) {
  for (const std::string& meant : MeantBy(text)) {
    for (const auto& [word, value] : words) {
      if (word == meant) return &value;
    }
  }
  return nullptr;
}

template <typename Value>
std::string WordFor(const Words<Value>& words, Value wanted) {
  for (const auto& [word, value] : words) {
    if (value == wanted) return word;
  }
  return "?";
}

}  // namespace lightfit::cli
