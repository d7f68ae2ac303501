// fuzz/exr_variants.h
//
// An OpenEXR file in the other forms that the format has: a part of its own for shadows, a UINT
// channel, tiles, two views, and every kind of compression.
#pragma once

#include <string>

namespace lightfit::fuzz {

// Writes FOLDER/COMPRESSION and the like for each of the forms of the file at `path`, whose first
// two channels they take. False when one cannot be written; the reason goes to the standard error.
bool WriteExrVariants(const std::string& path, const std::string& folder);

}  // namespace lightfit::fuzz
