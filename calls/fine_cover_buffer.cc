#include "calls/fine_cover_buffer.h"

#include <cstring>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "calls/bit_buffer.h"
#include "geometry/light.h"

namespace lightfit {
namespace {

constexpr int64_t kValueBytes = 4;

std::string FieldOf(const char* name) { return absl::StrCat("readback.fine_cover.", name); }

}  // namespace

int64_t FineCoverHeader::buffer_bytes() const {
  const int num_arrays = 2 + (has_furthest ? 1 : 0) + (lit_lights != 0 ? 1 : 0);
  return num_arrays * kValueBytes * num_cells();
}

absl::StatusOr<FineCoverHeader> FineCoverHeaderFromProto(const v1::Readback& proto,
                                                         int num_lights,
                                                         const CallLimits& limits) {
  FineCoverHeader header;
  if (!proto.has_fine_cover()) return header;
  const v1::FineCover& fine = proto.fine_cover();
  const int width = proto.camera().width(), height = proto.camera().height();
  if (fine.columns() <= width || fine.rows() <= height) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "readback.fine_cover: %d x %d cells, want more than the read-back's %d x %d pixels: it is "
        "there for what lies between them",
        fine.columns(),
        fine.rows(),
        width,
        height));
  }
  header.columns = fine.columns();
  header.rows = fine.rows();
  if (header.num_cells() > limits.max_pixels) {
    return absl::ResourceExhaustedError(
        absl::StrFormat("readback.fine_cover: %d x %d = %d cells, and this server takes at most "
                        "%d; reduce the image to fewer cells",
                        header.columns,
                        header.rows,
                        header.num_cells(),
                        limits.max_pixels));
  }
  const uint32_t all = ~uint32_t{0} >> (kMaxLights - num_lights);
  if ((fine.lit_lights() & ~all) != 0) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "readback.fine_cover.lit_lights = %#x: there are %d lights, want no bit beyond theirs",
        fine.lit_lights(),
        num_lights));
  }
  header.has_furthest = fine.with_furthest() || !fine.furthest().empty();
  header.lit_lights = fine.lit_lights();
  return header;
}

template <typename Word>
absl::Status FineCoverBuffer::AppendTo(const char* name,
                                       absl::string_view bytes,
                                       bool is_announced,
                                       std::vector<Word>* words) const {
  static_assert(sizeof(Word) == kValueBytes);
  if (bytes.empty()) return absl::OkStatus();
  if (!is_announced) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: %d bytes, and the header says that there are none", FieldOf(name), bytes.size()));
  }
  absl::Status status = CheckPiece(FieldOf(name),
                                   bytes,
                                   kValueBytes,
                                   static_cast<int64_t>(words->size()) * kValueBytes,
                                   header_.num_cells() * kValueBytes);
  if (!status.ok()) return status;
  words->reserve(header_.num_cells());
  const size_t first = words->size();
  words->resize(first + bytes.size() / sizeof(Word));
  std::memcpy(words->data() + first, bytes.data(), bytes.size());
  return absl::OkStatus();
}

absl::Status FineCoverBuffer::Append(const v1::FineCover& proto) {
  const bool has_lit = header_.lit_lights != 0;
  absl::Status status = AppendTo("nearest", proto.nearest(), !header_.is_absent(), &nearest_);
  if (status.ok()) {
    status = AppendTo("furthest", proto.furthest(), header_.has_furthest, &furthest_);
  }
  if (status.ok()) {
    status = AppendTo("shadow_bits", proto.shadow_bits(), !header_.is_absent(), &shadow_bits_);
  }
  if (status.ok()) status = AppendTo("lit_bits", proto.lit_bits(), has_lit, &lit_bits_);
  return status;
}

absl::Status FineCoverBuffer::Append(const v1::PixelChunk& chunk) {
  const bool has_lit = header_.lit_lights != 0;
  absl::Status status = AppendTo("nearest", chunk.fine_nearest(), !header_.is_absent(), &nearest_);
  if (status.ok()) {
    status = AppendTo("furthest", chunk.fine_furthest(), header_.has_furthest, &furthest_);
  }
  if (status.ok()) {
    status = AppendTo("shadow_bits", chunk.fine_shadow_bits(), !header_.is_absent(), &shadow_bits_);
  }
  if (status.ok()) status = AppendTo("lit_bits", chunk.fine_lit_bits(), has_lit, &lit_bits_);
  return status;
}

absl::Status FineCoverBuffer::CheckComplete() const {
  const auto check = [&](const char* name, size_t num_words, bool is_wanted) {
    return CheckArrived(FieldOf(name),
                        static_cast<int64_t>(num_words) * kValueBytes,
                        is_wanted ? header_.num_cells() * kValueBytes : 0);
  };
  absl::Status status = check("nearest", nearest_.size(), true);
  if (status.ok()) status = check("furthest", furthest_.size(), header_.has_furthest);
  if (status.ok()) status = check("shadow_bits", shadow_bits_.size(), true);
  if (status.ok()) status = check("lit_bits", lit_bits_.size(), header_.lit_lights != 0);
  return status;
}

FineCover FineCoverBuffer::View() const {
  FineCover view;
  view.columns = header_.columns;
  view.rows = header_.rows;
  view.nearest = nearest_;
  view.furthest = furthest_;
  view.shadow_bits = shadow_bits_;
  view.lit_bits = lit_bits_;
  view.lit_lights = header_.lit_lights;
  return view;
}

}  // namespace lightfit
