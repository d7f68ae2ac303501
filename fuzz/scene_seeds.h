// fuzz/scene_seeds.h
//
// The first inputs of the targets that read scene files: a few triangles in many forms.
// In:   nothing.
// Out:  names as TARGET/NAME, and bytes.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lightfit::fuzz {

std::vector<std::pair<std::string, std::string>> SceneSeeds();

}  // namespace lightfit::fuzz
