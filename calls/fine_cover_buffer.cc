#include "calls/fine_cover_buffer.h"

#include <cstring>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "calls/bit_buffer.h"
#include "calls/grow.h"
#include "geometry/light.h"

namespace lightfit {
namespace {

constexpr int64_t kValueBytes = 4;
constexpr ValueCount kOnePerCell = {"columns * rows", "readback.fine_cover"};

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
absl::Status FineCoverBuffer::AppendTo(const Array& array, std::vector<Word>* words) const {
  static_assert(sizeof(Word) == kValueBytes);
  if (array.bytes.empty()) return absl::OkStatus();
  const std::string field = FieldOf(array.name);
  if (array.missing != nullptr) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s: %d bytes, and the header says that there are none; want %s there, or "
                        "leave them out",
                        field,
                        array.bytes.size(),
                        FieldOf(array.missing)));
  }
  absl::Status status = CheckPiece(field,
                                   array.bytes,
                                   kValueBytes,
                                   static_cast<int64_t>(words->size()) * kValueBytes,
                                   header_.num_cells() * kValueBytes,
                                   kOnePerCell);
  if (!status.ok()) return status;
  const size_t first = words->size();
  GrowTo(first + array.bytes.size() / sizeof(Word), header_.num_cells(), words);
  std::memcpy(words->data() + first, array.bytes.data(), array.bytes.size());
  return absl::OkStatus();
}

absl::Status FineCoverBuffer::AppendAll(absl::string_view nearest,
                                        absl::string_view furthest,
                                        absl::string_view shadow_bits,
                                        absl::string_view lit_bits) {
  // What the header must say for an array to come; null where it does.
  const char* const cells = header_.is_absent() ? "columns and rows" : nullptr;
  const char* const deep = header_.has_furthest ? nullptr : "with_furthest";
  const char* const lit = header_.lit_lights != 0 ? nullptr : "lit_lights";
  absl::Status status = AppendTo({"nearest", nearest, cells}, &nearest_);
  if (status.ok()) status = AppendTo({"furthest", furthest, deep}, &furthest_);
  if (status.ok()) status = AppendTo({"shadow_bits", shadow_bits, cells}, &shadow_bits_);
  if (status.ok()) status = AppendTo({"lit_bits", lit_bits, lit}, &lit_bits_);
  return status;
}

absl::Status FineCoverBuffer::Append(const v1::FineCover& proto) {
  return AppendAll(proto.nearest(), proto.furthest(), proto.shadow_bits(), proto.lit_bits());
}

absl::Status FineCoverBuffer::Append(const v1::PixelChunk& chunk) {
  return AppendAll(
      chunk.fine_nearest(), chunk.fine_furthest(), chunk.fine_shadow_bits(), chunk.fine_lit_bits());
}

absl::Status FineCoverBuffer::CheckComplete() const {
  const auto check = [&](const char* name, size_t num_words, bool is_wanted) {
    return CheckArrived(FieldOf(name),
                        static_cast<int64_t>(num_words) * kValueBytes,
                        is_wanted ? header_.num_cells() * kValueBytes : 0,
                        kOnePerCell);
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
