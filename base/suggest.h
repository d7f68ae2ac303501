// base/suggest.h
//
// The word that was probably meant.
#pragma once

#include <string>
#include <vector>

namespace lightfit {

// "; did you mean \"sun\"?" when one of `choices` is close to `word`, else "".
std::string DidYouMean(const std::string& word, const std::vector<std::string>& choices);

// The choices that `word` may have been meant as, the likeliest first, at most three: those at the
// fewest letters inserted, removed, replaced or swapped with their neighbour, where these are few;
// else those that begin with `word`, or have it after a dash. Upper and lower case are the same.
std::vector<std::string> LikelyMeant(const std::string& word,
                                     const std::vector<std::string>& choices);

}  // namespace lightfit
