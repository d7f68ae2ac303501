#include "optimizer/readback/fine_cover.h"

#include "absl/strings/str_format.h"
#include "geometry/sized_camera.h"

namespace lightfit {

absl::Status ValidateFineCover(const Readback& readback) {
  const FineCover& fine = *readback.fine_cover;
  if (fine.columns < 1 || fine.rows < 1) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "readback.fine_cover: %d x %d cells, want at least one", fine.columns, fine.rows));
  }
  const size_t want = static_cast<size_t>(fine.columns) * fine.rows;
  const auto check = [&](const char* field, size_t size, bool is_optional) {
    if (size == want || (is_optional && size == 0)) return absl::OkStatus();
    return absl::InvalidArgumentError(
        absl::StrFormat("readback.fine_cover.%s: %d values, want %d x %d = %d",
                        field,
                        size,
                        fine.columns,
                        fine.rows,
                        want));
  };
  if (absl::Status s = check("nearest", fine.nearest.size(), false); !s.ok()) return s;
  if (absl::Status s = check("furthest", fine.furthest.size(), true); !s.ok()) return s;
  if (absl::Status s = check("shadow_bits", fine.shadow_bits.size(), false); !s.ok()) return s;
  return check("lit_bits", fine.lit_bits.size(), true);
}

int NumFineLayers(const FineCover& fine) { return fine.furthest.empty() ? 1 : 2; }

Readback FineLayer(const Readback& readback, int layer, absl::Span<const uint32_t> words) {
  const FineCover& fine = *readback.fine_cover;
  Readback finer;
  finer.camera = ResizedCamera(readback.camera, fine.columns, fine.rows);
  finer.depth = layer == 0 ? fine.nearest : fine.furthest;
  finer.depth_kind = readback.depth_kind;
  finer.background = readback.background;
  finer.shadow_bits = words;
  return finer;
}

}  // namespace lightfit
