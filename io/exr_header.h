// io/exr_header.h
//
// Whether the headers of an OpenEXR file ask for more than the file can have.
// In:   the bytes of a file.
// Out:  a status.
//
// OpenEXR takes memory for an attribute as soon as it knows how long it says it is, up to 2 GB. So
// lengths are looked at first: they must lie in the file, and be those of the type, as OpenEXR
// reads what belongs to a type whatever the length says. It also takes half a kilobyte for every
// name, so these are counted; and for chunks of pixels, see io/exr_claims.h. Other values are
// OpenEXR's own to check.
//
// Layout ("OpenEXR File Layout"), integers little-endian: 4 bytes magic, 4 bytes version and flags;
// then for each part its attributes, each a name and a type, which end in 0, an int32 and as many
// bytes of value; a 0 after the last attribute, and a 0 after the last part of a multi-part file.
#pragma once

#include <istream>

#include "absl/status/status.h"

namespace lightfit::internal {

// InvalidArgument without a path. `file` is at its beginning again afterwards.
absl::Status CheckExrHeader(std::istream& file);

}  // namespace lightfit::internal
