#include "io/exr/claims.h"

#include <OpenEXR/ImfCompression.h>

#include <algorithm>
#include <limits>

#include "absl/strings/str_format.h"

namespace lightfit::internal {

namespace {

constexpr int64_t kBytesOfOffset = 8;  // of a chunk, in the table

// Memory for a chunk that needs no reason: tiles of 1024 x 1024 pixels of two channels. Beyond that
// it may be four times what the image has.
constexpr int64_t kFreeChunkBytes = int64_t{8} << 20;
constexpr int64_t kMostOfImage = 4;

// OpenEXR takes memory for whole tiles, also where the image is smaller.
constexpr int64_t kMaxTileSide = 1024;

// Deflate gives 1032 at most, and a third more where floats are cut to 24 bits; the others less.
constexpr int64_t kMostCompressed = 2048;

int64_t LinesOfChunk(int compression) {
  switch (compression) {
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
      return 16;
    case Imf::PIZ_COMPRESSION:
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION:
      return 32;
    case Imf::DWAB_COMPRESSION:
      return 256;
    default:
      return 1;
  }
}

int64_t DividedUp(int64_t a, int64_t b) { return (a + b - 1) / b; }

// Windows and tiles have sides of up to 2^32, so that products do not fit.
int64_t Times(int64_t a, int64_t b) {
  constexpr int64_t kMost = std::numeric_limits<int64_t>::max();
  return a != 0 && b > kMost / a ? kMost : a * b;
}

}  // namespace

int64_t MostPixelBytes(int compression, int64_t file_bytes) {
  return compression == Imf::NO_COMPRESSION ? file_bytes : Times(kMostCompressed, file_bytes);
}

absl::Status CheckExrClaims(const ExrClaims& part, int64_t bytes_left) {
  if (part.width < 1 || part.height < 1) return absl::OkStatus();  // OpenEXR's to refuse
  const int64_t width = part.width, height = part.height;
  if (part.is_tiled) {
    if (part.tile_width < 1 || part.tile_height < 1) return absl::OkStatus();
    const int64_t max_width = std::max(kMaxTileSide, width);
    const int64_t max_height = std::max(kMaxTileSide, height);
    if (part.tile_width > max_width || part.tile_height > max_height) {
      return absl::InvalidArgumentError(
          absl::StrFormat("has tiles of %dx%d pixels, want at most %dx%d: the file is damaged, or "
                          "render the read-back without tiles",
                          part.tile_width,
                          part.tile_height,
                          max_width,
                          max_height));
    }
  }
  const int64_t lines = LinesOfChunk(part.compression);
  const int64_t num_chunks =
      part.is_tiled ? Times(DividedUp(width, part.tile_width), DividedUp(height, part.tile_height))
                    : DividedUp(height, lines);
  const int64_t stated = std::max(num_chunks, part.chunk_count.value_or(0));
  if (stated > bytes_left / kBytesOfOffset) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "has %d chunks of pixels (%dx%d), whose table alone takes %d bytes, where %d are left of "
        "the file: the file is damaged or cut short",
        stated,
        width,
        height,
        Times(kBytesOfOffset, stated),
        bytes_left));
  }
  // Flags and type of a damaged file may differ, so that lines count for tiles as well.
  const int64_t tile_pixels = part.is_tiled ? Times(part.tile_width, part.tile_height) : 0;
  const int64_t chunk_pixels = std::max(tile_pixels, Times(width, lines));
  const int64_t chunk_bytes = Times(chunk_pixels, part.bytes_per_pixel);
  const int64_t image_bytes = std::min(Times(Times(width, height), part.bytes_per_pixel),
                                       MostPixelBytes(part.compression, bytes_left));
  const int64_t allowed = std::max(kFreeChunkBytes, Times(kMostOfImage, image_bytes));
  if (chunk_bytes > allowed) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "has chunks of %d bytes of pixels, more than %d bytes of a file can hold (%d): the file is "
        "damaged, or render the read-back with smaller tiles or less compression",
        chunk_bytes,
        bytes_left,
        allowed));
  }
  return absl::OkStatus();
}

}  // namespace lightfit::internal
