#include "calls/pixel_buffer.h"

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "calls/grow.h"
#include "calls/request_lights.h"
#include "optimizer/readback/kernels.h"
#include "wire/camera_proto.h"

namespace lightfit {
namespace {

static_assert(std::endian::native == std::endian::little,
              "messages are little-endian: convert words here before you port this");

constexpr size_t kMaxSourceBytes = 4096;

int64_t BytesOf(v1::DepthFormat format) { return format == v1::DEPTH_FORMAT_FLOAT16 ? 2 : 4; }

absl::StatusOr<v1::DepthFormat> DepthFormatOf(const v1::Readback& proto) {
  switch (proto.depth_format()) {
    case v1::DEPTH_FORMAT_UNSPECIFIED:
    case v1::DEPTH_FORMAT_FLOAT32:
      return v1::DEPTH_FORMAT_FLOAT32;
    case v1::DEPTH_FORMAT_FLOAT16:
      return v1::DEPTH_FORMAT_FLOAT16;
    default:
      return absl::InvalidArgumentError(
          absl::StrFormat("readback.depth_format = %d: this version does not know it, want "
                          "DEPTH_FORMAT_FLOAT32 or DEPTH_FORMAT_FLOAT16",
                          proto.depth_format()));
  }
}

absl::Status InReadback(const absl::Status& status) {
  // Some messages of cameras begin with that word.
  const char* const prefix =
      absl::StartsWith(status.message(), "camera") ? "readback." : "readback.camera: ";
  return absl::Status(status.code(), absl::StrCat(prefix, status.message()));
}

// Whether words of 4 bytes can be read where they are.
bool IsAligned(const std::string& bytes) {
  return reinterpret_cast<uintptr_t>(bytes.data()) % alignof(uint32_t) == 0;
}

absl::Status CheckWholeDepth(const ReadbackHeader& header, absl::string_view bytes) {
  constexpr char kField[] = "readback.depth";
  absl::Status status =
      CheckPiece(kField, bytes, BytesOf(header.depth_format), 0, header.depth_bytes());
  if (!status.ok()) return status;
  return CheckArrived(kField, static_cast<int64_t>(bytes.size()), header.depth_bytes());
}

// Whether a BitBuffer would hold what is there already.
bool IsUsableAsIs(const BitsFields& fields, const BitsHeader& header) {
  if (header.is_absent()) return fields.bits.empty();
  return header.has_bits() && fields.planes.empty() &&
         static_cast<int64_t>(fields.bits.size()) == header.bits_bytes() && IsAligned(fields.bits);
}

absl::Status AppendTo(const std::string& bits,
                      int plane_index,
                      const std::string& plane,
                      BitBuffer* buffer) {
  absl::Status status = buffer->AppendBits(bits);
  if (status.ok() && !plane.empty()) status = buffer->AppendPlane(plane_index, plane);
  return status;
}

template <typename Word>
absl::Span<const Word> WordsOf(const std::string& bytes) {
  return {reinterpret_cast<const Word*>(bytes.data()), bytes.size() / sizeof(Word)};
}

}  // namespace

int64_t ReadbackHeader::depth_bytes() const { return num_pixels() * BytesOf(depth_format); }

int64_t ReadbackHeader::buffer_bytes() const {
  return num_pixels() * int64_t{sizeof(float)} + shadow.buffer_bytes() + facing.buffer_bytes() +
         mapped.buffer_bytes() + fine.buffer_bytes();
}

absl::StatusOr<ReadbackHeader> ReadbackHeaderFromProto(const v1::Readback& proto,
                                                       int num_lights,
                                                       const CallLimits& limits) {
  if (absl::Status status = CheckNumLights(num_lights); !status.ok()) return status;
  if (!proto.has_camera()) {
    return absl::InvalidArgumentError(
        "readback.camera: is missing, want size, pose and projection");
  }
  const int64_t num_pixels = int64_t{proto.camera().width()} * proto.camera().height();
  if (num_pixels > limits.max_pixels) {
    return absl::ResourceExhaustedError(
        absl::StrFormat("readback.camera: %d x %d = %d pixels, and this server takes at most %d; a "
                        "read-back of a few hundred rows does as well",
                        proto.camera().width(),
                        proto.camera().height(),
                        num_pixels,
                        limits.max_pixels));
  }
  if (proto.source().size() > kMaxSourceBytes) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "readback.source: %d bytes, want at most %d", proto.source().size(), kMaxSourceBytes));
  }
  const absl::StatusOr<StatedCamera> camera = CameraFromProto(proto.camera());
  if (!camera.ok()) return InReadback(camera.status());
  const absl::StatusOr<v1::DepthFormat> depth_format = DepthFormatOf(proto);
  if (!depth_format.ok()) return depth_format.status();
  absl::StatusOr<BitsHeader> shadow = ShadowHeaderFromProto(proto, num_lights, num_pixels);
  if (!shadow.ok()) return shadow.status();
  absl::StatusOr<BitsHeader> facing = FacingHeaderFromProto(proto, num_lights, num_pixels);
  if (!facing.ok()) return facing.status();
  absl::StatusOr<BitsHeader> mapped = MappedHeaderFromProto(proto, num_lights, num_pixels);
  if (!mapped.ok()) return mapped.status();
  const absl::StatusOr<FineCoverHeader> fine = FineCoverHeaderFromProto(proto, num_lights, limits);
  if (!fine.ok()) return fine.status();

  ReadbackHeader header;
  header.camera = camera->camera;
  header.depth_kind = camera->depth_kind.value_or(DepthKind::kCameraZ);
  if (proto.has_background()) header.background = static_cast<float>(proto.background());
  header.depth_format = *depth_format;
  header.shadow = *std::move(shadow);
  header.facing = *std::move(facing);
  header.mapped = *std::move(mapped);
  header.fine = *fine;
  if (absl::Status status = ValidateCamera(header.camera, header.depth_kind); !status.ok()) {
    return InReadback(status);
  }
  return header;
}

void ClearPixels(v1::Readback* readback) {
  readback->clear_depth();
  readback->clear_shadow_bits();
  readback->clear_shadow_planes();
  readback->clear_facing_bits();
  readback->clear_facing_planes();
  readback->clear_mapped_bits();
  readback->clear_mapped_planes();
  if (!readback->has_fine_cover()) return;
  readback->mutable_fine_cover()->clear_nearest();
  readback->mutable_fine_cover()->clear_furthest();
  readback->mutable_fine_cover()->clear_shadow_bits();
  readback->mutable_fine_cover()->clear_lit_bits();
}

PixelBuffer::PixelBuffer(const ReadbackHeader& header)
    : header_(header),
      shadow_(header.shadow),
      facing_(header.facing),
      mapped_(header.mapped),
      fine_(header.fine) {}

absl::Status PixelBuffer::Append(const v1::Readback& proto) {
  absl::Status status = AppendDepth(proto.depth());
  if (status.ok()) status = shadow_.Append(ShadowFields(proto));
  if (status.ok()) status = facing_.Append(FacingFields(proto));
  if (status.ok()) status = mapped_.Append(MappedFields(proto));
  if (status.ok()) status = fine_.Append(proto.fine_cover());
  return status;
}

absl::Status PixelBuffer::Append(const v1::PixelChunk& chunk) {
  absl::Status status = AppendDepth(chunk.depth());
  if (status.ok()) {
    status =
        AppendTo(chunk.shadow_bits(), chunk.shadow_plane_index(), chunk.shadow_plane(), &shadow_);
  }
  if (status.ok()) {
    status =
        AppendTo(chunk.facing_bits(), chunk.facing_plane_index(), chunk.facing_plane(), &facing_);
  }
  if (status.ok()) {
    status =
        AppendTo(chunk.mapped_bits(), chunk.mapped_plane_index(), chunk.mapped_plane(), &mapped_);
  }
  if (status.ok()) status = fine_.Append(chunk);
  return status;
}

absl::Status PixelBuffer::AppendDepth(absl::string_view bytes) {
  if (bytes.empty()) return absl::OkStatus();
  const int64_t value_bytes = BytesOf(header_.depth_format);
  absl::Status status =
      CheckPiece("readback.depth", bytes, value_bytes, num_depth_bytes_, header_.depth_bytes());
  if (!status.ok()) return status;
  num_depth_bytes_ += static_cast<int64_t>(bytes.size());
  const size_t first = depth_.size(), count = bytes.size() / value_bytes;
  GrowTo(first + count, header_.num_pixels(), &depth_);
  if (header_.depth_format == v1::DEPTH_FORMAT_FLOAT32) {
    std::memcpy(depth_.data() + first, bytes.data(), bytes.size());
    return absl::OkStatus();
  }
  for (size_t i = 0; i < count; ++i) {
    uint16_t half;
    std::memcpy(&half, bytes.data() + i * sizeof(half), sizeof(half));
    depth_[first + i] = Eigen::half_impl::half_to_float(Eigen::half_impl::raw_uint16_to_half(half));
  }
  return absl::OkStatus();
}

absl::Status PixelBuffer::CheckComplete() const {
  absl::Status status = CheckArrived("readback.depth", num_depth_bytes_, header_.depth_bytes());
  for (const BitBuffer* bits : {&shadow_, &facing_, &mapped_}) {
    if (status.ok()) status = bits->CheckComplete();
  }
  if (status.ok() && !header_.fine.is_absent()) status = fine_.CheckComplete();
  return status;
}

Readback PixelBuffer::View(FineCover* fine_cover) const {
  Readback view = ReadbackOf(header_, depth_, shadow_.words(), facing_.words(), mapped_.words());
  if (!header_.fine.is_absent() && fine_cover != nullptr) {
    *fine_cover = fine_.View();
    view.fine_cover = fine_cover;
  }
  return view;
}

Readback ReadbackOf(const ReadbackHeader& header,
                    absl::Span<const float> depth,
                    absl::Span<const uint32_t> shadow_bits,
                    absl::Span<const uint32_t> facing_bits,
                    absl::Span<const uint32_t> mapped_bits) {
  Readback readback;
  readback.camera = header.camera;
  readback.depth = depth;
  readback.depth_kind = header.depth_kind;
  readback.background = header.background;
  readback.shadow_bits = shadow_bits;
  readback.facing_bits = facing_bits;
  readback.facing_lights = header.facing.lights;
  readback.mapped_bits = mapped_bits;
  readback.mapped_lights = header.mapped.lights;
  return readback;
}

absl::Status CheckBoundary(const Readback& readback, const CallLimits& limits) {
  const size_t width = readback.width();
  std::vector<int32_t> columns(width);
  int64_t count = 0;
  const auto add = [&](absl::Span<const uint32_t> bits, uint32_t lights) {
    for (int y = 1; y + 1 < readback.height() && !bits.empty(); ++y) {
      count += static_cast<int64_t>(
          internal::ScanBoundary(bits.data() + width * y, width, width, lights, columns.data()));
    }
  };
  add(readback.shadow_bits, ~uint32_t{0});
  add(readback.facing_bits, readback.facing_lights);
  if (count <= limits.max_boundary_pixels) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrFormat(
      "readback: %d pixels at the borders of shadows%s, and this server takes at most "
      "%d: is a shadow noise? Else send a smaller read-back, or fewer lights at a "
      "time",
      count,
      readback.facing_bits.empty() ? "" : " and of surfaces that face a light",
      limits.max_boundary_pixels));
}

absl::StatusOr<ReadbackView> ReadbackView::Of(const v1::Readback& proto,
                                              int num_lights,
                                              const CallLimits& limits) {
  const absl::StatusOr<ReadbackHeader> header = ReadbackHeaderFromProto(proto, num_lights, limits);
  if (!header.ok()) return header.status();
  ReadbackView result(*header);
  const BitsFields shadow = ShadowFields(proto), facing = FacingFields(proto),
                   mapped = MappedFields(proto);
  const bool is_usable_as_is =
      header->fine.is_absent() && header->depth_format == v1::DEPTH_FORMAT_FLOAT32 &&
      static_cast<int64_t>(proto.depth().size()) == header->depth_bytes() &&
      IsAligned(proto.depth()) && IsUsableAsIs(shadow, header->shadow) &&
      IsUsableAsIs(facing, header->facing) && IsUsableAsIs(mapped, header->mapped);
  if (is_usable_as_is) {
    result.view_ = ReadbackOf(*header,
                              WordsOf<float>(proto.depth()),
                              WordsOf<uint32_t>(shadow.bits),
                              WordsOf<uint32_t>(facing.bits),
                              WordsOf<uint32_t>(mapped.bits));
  } else {
    // First, as a single byte of a plane takes words for all pixels.
    absl::Status status = CheckWholeDepth(*header, proto.depth());
    if (status.ok()) status = result.buffer_.Append(proto);
    if (status.ok()) status = result.buffer_.CheckComplete();
    if (!status.ok()) return status;
    result.view_ = result.buffer_.View(result.fine_cover_.get());
  }
  if (absl::Status status = CheckBoundary(result.view_, limits); !status.ok()) return status;
  return result;
}

}  // namespace lightfit
