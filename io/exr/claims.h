// io/exr/claims.h
//
// What the header of a part of an OpenEXR file asks for, held against the size of the file.
// In:   windows, tiles, compression and channels, as the header states them; the file's bytes.
// Out:  a status: whether memory and time may be spent on it.
//
// OpenEXR takes memory for its table of chunks, and for a chunk for each of its threads, before it
// has seen a pixel. The table has 8 bytes for every chunk and is in the file whole, so the file
// bounds their number; no compression of OpenEXR's makes more than some thousand bytes of one.
#pragma once

#include <cstdint>
#include <optional>

#include "absl/status/status.h"

namespace lightfit::internal {

// As OpenEXR has it where the header does not say.
struct ExrClaims {
  int64_t width = 64, height = 64;  // of the data window
  bool is_tiled = false;
  int64_t tile_width = 0, tile_height = 0;
  std::optional<int64_t> chunk_count;  // as stated
  int compression = 3;                 // Imf::Compression, ZIP
  int64_t bytes_per_pixel = 0;         // of all channels
};

// The most bytes of pixels that so many bytes of a file may hold.
int64_t MostPixelBytes(int compression, int64_t file_bytes);

// Of one part; `bytes_left` of the file follow all headers. InvalidArgument, which does not name
// the part.
absl::Status CheckExrClaims(const ExrClaims& part, int64_t bytes_left);

}  // namespace lightfit::internal
