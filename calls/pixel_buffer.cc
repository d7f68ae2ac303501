#include "calls/pixel_buffer.h"

#include <Eigen/Core>
#include <bit>
#include <cstring>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "calls/request_lights.h"
#include "optimizer/readback/kernels.h"
#include "wire/camera_proto.h"

namespace lightfit {
namespace {

static_assert(std::endian::native == std::endian::little,
              "messages are little-endian: convert words here before you port this");

constexpr size_t kMaxSourceBytes = 4096;
constexpr uint8_t kLeastBlocked = 128;  // of a plane's values

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

absl::StatusOr<v1::ShadowFormat> ShadowFormatOf(const v1::Readback& proto) {
  switch (proto.shadow_format()) {
    case v1::SHADOW_FORMAT_UNSPECIFIED:
      return proto.shadow_planes().empty() ? v1::SHADOW_FORMAT_BITS : v1::SHADOW_FORMAT_PLANES;
    case v1::SHADOW_FORMAT_BITS:
    case v1::SHADOW_FORMAT_PLANES:
      return proto.shadow_format();
    default:
      return absl::InvalidArgumentError(
          absl::StrFormat("readback.shadow_format = %d: this version does not know it, want "
                          "SHADOW_FORMAT_BITS or SHADOW_FORMAT_PLANES",
                          proto.shadow_format()));
  }
}

absl::Status InReadback(const absl::Status& status) {
  // Some messages of cameras begin with that word.
  const char* const prefix =
      absl::StartsWith(status.message(), "camera") ? "readback." : "readback.camera: ";
  return absl::Status(status.code(), absl::StrCat(prefix, status.message()));
}

// `bytes` more of `field`, of which `arrived` are there and `want` are wanted in all.
absl::Status CheckPiece(absl::string_view field,
                        absl::string_view bytes,
                        int64_t value_bytes,
                        int64_t arrived,
                        int64_t want) {
  const int64_t size = static_cast<int64_t>(bytes.size());
  if (size % value_bytes != 0) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: %d bytes, want whole values of %d bytes each", field, size, value_bytes));
  }
  if (size > want - arrived) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s: %d bytes, want %d: width * height values of %d bytes, as in "
                        "readback.camera and the formats",
                        field,
                        arrived + size,
                        want,
                        value_bytes));
  }
  return absl::OkStatus();
}

absl::Status CheckArrived(absl::string_view field, int64_t arrived, int64_t want) {
  if (arrived == want) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("%s: %d bytes, want %d: width * height values as in readback.camera and the "
                      "formats",
                      field,
                      arrived,
                      want));
}

std::string PlaneField(int plane) { return absl::StrFormat("readback.shadow_planes[%d]", plane); }

// Whether words of 4 bytes can be read where they are.
bool IsAligned(const std::string& bytes) {
  return reinterpret_cast<uintptr_t>(bytes.data()) % alignof(uint32_t) == 0;
}

template <typename Word>
absl::Span<const Word> WordsOf(const std::string& bytes) {
  return {reinterpret_cast<const Word*>(bytes.data()), bytes.size() / sizeof(Word)};
}

}  // namespace

int64_t ReadbackHeader::depth_bytes() const { return num_pixels() * BytesOf(depth_format); }

int64_t ReadbackHeader::shadow_bits_bytes() const {
  return num_pixels() * static_cast<int64_t>(sizeof(uint32_t));
}

int64_t ReadbackHeader::shadow_plane_bytes() const { return num_pixels(); }

int64_t ReadbackHeader::buffer_bytes() const {
  return num_pixels() * static_cast<int64_t>(sizeof(float) + sizeof(uint32_t));
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
  const absl::StatusOr<v1::ShadowFormat> shadow_format = ShadowFormatOf(proto);
  if (!shadow_format.ok()) return shadow_format.status();

  ReadbackHeader header;
  header.camera = camera->camera;
  header.depth_kind = camera->depth_kind.value_or(DepthKind::kCameraZ);
  header.depth_format = *depth_format;
  header.shadow_format = *shadow_format;
  header.num_lights = num_lights;
  if (absl::Status status = ValidateCamera(header.camera, header.depth_kind); !status.ok()) {
    return InReadback(status);
  }
  return header;
}

PixelBuffer::PixelBuffer(const ReadbackHeader& header)
    : header_(header), num_plane_bytes_(header.num_lights, 0) {}

absl::Status PixelBuffer::Append(const v1::Readback& proto) {
  absl::Status status = AppendDepth(proto.depth());
  if (status.ok()) status = AppendShadowBits(proto.shadow_bits());
  for (int plane = 0; plane < proto.shadow_planes_size() && status.ok(); ++plane) {
    status = AppendShadowPlane(plane, proto.shadow_planes(plane));
  }
  return status;
}

absl::Status PixelBuffer::Append(const v1::PixelChunk& chunk) {
  absl::Status status = AppendDepth(chunk.depth());
  if (status.ok()) status = AppendShadowBits(chunk.shadow_bits());
  if (status.ok() && !chunk.shadow_plane().empty()) {
    status = AppendShadowPlane(chunk.shadow_plane_index(), chunk.shadow_plane());
  }
  return status;
}

absl::Status PixelBuffer::AppendDepth(absl::string_view bytes) {
  if (bytes.empty()) return absl::OkStatus();
  const int64_t value_bytes = BytesOf(header_.depth_format);
  absl::Status status =
      CheckPiece("readback.depth", bytes, value_bytes, num_depth_bytes_, header_.depth_bytes());
  if (!status.ok()) return status;
  num_depth_bytes_ += static_cast<int64_t>(bytes.size());
  depth_.reserve(header_.num_pixels());
  const size_t first = depth_.size(), count = bytes.size() / value_bytes;
  depth_.resize(first + count);
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

absl::Status PixelBuffer::AppendShadowBits(absl::string_view bytes) {
  if (bytes.empty()) return absl::OkStatus();
  if (header_.shadow_format != v1::SHADOW_FORMAT_BITS) {
    return absl::InvalidArgumentError(
        "readback.shadow_bits: has pixels beside readback.shadow_planes, want one of them");
  }
  absl::Status status = CheckPiece("readback.shadow_bits",
                                   bytes,
                                   sizeof(uint32_t),
                                   num_shadow_bits_bytes_,
                                   header_.shadow_bits_bytes());
  if (!status.ok()) return status;
  num_shadow_bits_bytes_ += static_cast<int64_t>(bytes.size());
  shadow_bits_.reserve(header_.num_pixels());
  const size_t first = shadow_bits_.size();
  shadow_bits_.resize(first + bytes.size() / sizeof(uint32_t));
  std::memcpy(shadow_bits_.data() + first, bytes.data(), bytes.size());
  return absl::OkStatus();
}

absl::Status PixelBuffer::AppendShadowPlane(int plane, absl::string_view bytes) {
  if (header_.shadow_format != v1::SHADOW_FORMAT_PLANES) {
    return absl::InvalidArgumentError(
        "readback.shadow_planes: has pixels, but readback.shadow_format says bits; want "
        "SHADOW_FORMAT_PLANES before planes in chunks");
  }
  if (plane < 0 || plane >= header_.num_lights) {
    return absl::InvalidArgumentError(
        absl::StrFormat("shadow plane %d: there are %d lights, want one plane for each, counted "
                        "from 0",
                        plane,
                        header_.num_lights));
  }
  int64_t& arrived = num_plane_bytes_[plane];
  if (absl::Status status =
          CheckPiece(PlaneField(plane), bytes, 1, arrived, header_.shadow_plane_bytes());
      !status.ok()) {
    return status;
  }
  shadow_bits_.resize(header_.num_pixels());
  uint32_t* const words = shadow_bits_.data() + arrived;
  const uint32_t bit = uint32_t{1} << plane;
  for (size_t i = 0; i < bytes.size(); ++i) {
    if (static_cast<uint8_t>(bytes[i]) >= kLeastBlocked) words[i] |= bit;
  }
  arrived += static_cast<int64_t>(bytes.size());
  return absl::OkStatus();
}

absl::Status PixelBuffer::CheckComplete() const {
  absl::Status status = CheckArrived("readback.depth", num_depth_bytes_, header_.depth_bytes());
  if (header_.shadow_format == v1::SHADOW_FORMAT_BITS) {
    if (status.ok()) {
      status =
          CheckArrived("readback.shadow_bits", num_shadow_bits_bytes_, header_.shadow_bits_bytes());
    }
    return status;
  }
  for (int plane = 0; plane < header_.num_lights && status.ok(); ++plane) {
    status = CheckArrived(PlaneField(plane), num_plane_bytes_[plane], header_.shadow_plane_bytes());
  }
  return status;
}

absl::Status CheckBoundary(const Readback& readback, const CallLimits& limits) {
  const size_t width = readback.width();
  constexpr uint32_t kAllLights = ~uint32_t{0};
  std::vector<int32_t> columns(width);
  int64_t count = 0;
  for (int y = 1; y + 1 < readback.height(); ++y) {
    const uint32_t* const row = readback.shadow_bits.data() + width * y;
    count +=
        static_cast<int64_t>(internal::ScanBoundary(row, width, width, kAllLights, columns.data()));
  }
  if (count <= limits.max_boundary_pixels) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrFormat(
      "readback: %d pixels at the borders of shadows, and this server takes at most "
      "%d: is a shadow noise? Else send a smaller read-back, or fewer lights at a "
      "time",
      count,
      limits.max_boundary_pixels));
}

absl::StatusOr<ReadbackView> ReadbackView::Of(const v1::Readback& proto,
                                              int num_lights,
                                              const CallLimits& limits) {
  const absl::StatusOr<ReadbackHeader> header = ReadbackHeaderFromProto(proto, num_lights, limits);
  if (!header.ok()) return header.status();
  ReadbackView result(*header);
  const bool is_usable_as_is =
      header->depth_format == v1::DEPTH_FORMAT_FLOAT32 &&
      header->shadow_format == v1::SHADOW_FORMAT_BITS && proto.shadow_planes().empty() &&
      static_cast<int64_t>(proto.depth().size()) == header->depth_bytes() &&
      static_cast<int64_t>(proto.shadow_bits().size()) == header->shadow_bits_bytes() &&
      IsAligned(proto.depth()) && IsAligned(proto.shadow_bits());
  if (is_usable_as_is) {
    result.view_ = {header->camera,
                    WordsOf<float>(proto.depth()),
                    header->depth_kind,
                    WordsOf<uint32_t>(proto.shadow_bits())};
  } else {
    absl::Status status = result.buffer_.Append(proto);
    if (status.ok()) status = result.buffer_.CheckComplete();
    if (!status.ok()) return status;
    result.view_ = result.buffer_.View();
  }
  if (absl::Status status = CheckBoundary(result.view_, limits); !status.ok()) return status;
  return result;
}

}  // namespace lightfit
