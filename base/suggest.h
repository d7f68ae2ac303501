// base/suggest.h
//
// The word that was probably meant.
#pragma once

#include <string>
#include <vector>

namespace lightfit {

// "; did you mean \"sun\"?" when one of `choices` is close to `word`, else "".
std::string DidYouMean(const std::string& word, const std::vector<std::string>& choices);

}  // namespace lightfit
