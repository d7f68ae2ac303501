#include "calls/bit_buffer.h"

#include <algorithm>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "calls/grow.h"
#include "geometry/light.h"

namespace lightfit {
namespace {

constexpr uint8_t kLeastSet = 128;  // of a plane's values

std::string BitsField(const BitsHeader& header) {
  return absl::StrCat("readback.", header.name, "_bits");
}

std::string PlaneField(const BitsHeader& header, int plane) {
  return absl::StrFormat("readback.%s_planes[%d]", header.name, plane);
}

absl::Status Unannounced(const BitsHeader& header, const char* kind, const char* format) {
  return absl::InvalidArgumentError(
      absl::StrFormat("readback.%s_%s: has pixels, but readback.%s_format says none; want "
                      "%s before %s in chunks",
                      header.name,
                      kind,
                      header.name,
                      format,
                      kind));
}

// The lights whose planes are here.
uint32_t LightsWithPlanes(const BitsFields& fields) {
  uint32_t lights = 0;
  for (int plane = 0; plane < std::min<int>(fields.planes.size(), kMaxLights); ++plane) {
    if (!fields.planes[plane].empty()) lights |= uint32_t{1} << plane;
  }
  return lights;
}

absl::StatusOr<BitsHeader> BitsHeaderOf(const BitsFields& fields,
                                        int num_lights,
                                        int64_t num_pixels) {
  const uint32_t all = ~uint32_t{0} >> (kMaxLights - num_lights);
  BitsHeader header = {fields.name, fields.format, all, num_lights, num_pixels};
  switch (fields.format) {
    case v1::SHADOW_FORMAT_UNSPECIFIED:
      if (!fields.bits.empty()) header.format = v1::SHADOW_FORMAT_BITS;
      if (!fields.planes.empty()) header.format = v1::SHADOW_FORMAT_PLANES;
      return header;
    case v1::SHADOW_FORMAT_BITS:
    case v1::SHADOW_FORMAT_PLANES:
      return header;
    default:
      return absl::InvalidArgumentError(
          absl::StrFormat("readback.%s_format = %d: this version does not know it, want "
                          "SHADOW_FORMAT_BITS or SHADOW_FORMAT_PLANES",
                          fields.name,
                          fields.format));
  }
}

// Bits that there may be none of, or of some lights alone.
absl::StatusOr<BitsHeader> OptionalHeaderOf(const BitsFields& fields,
                                            int num_lights,
                                            int64_t num_pixels) {
  absl::StatusOr<BitsHeader> header = BitsHeaderOf(fields, num_lights, num_pixels);
  if (!header.ok()) return header.status();
  if ((fields.lights & ~header->lights) != 0) {
    return absl::InvalidArgumentError(
        absl::StrFormat("readback.%s_lights = %#x: there are %d lights, want no bit beyond theirs",
                        fields.name,
                        fields.lights,
                        num_lights));
  }
  if (fields.lights != 0) {
    header->lights = fields.lights;
  } else if (!fields.planes.empty()) {
    header->lights = LightsWithPlanes(fields);
  }
  if (header->lights == 0) header->format = v1::SHADOW_FORMAT_UNSPECIFIED;
  return header;
}

}  // namespace

BitsFields ShadowFields(const v1::Readback& proto) {
  return {"shadow", proto.shadow_format(), proto.shadow_bits(), proto.shadow_planes(), 0};
}

BitsFields FacingFields(const v1::Readback& proto) {
  return {"facing",
          proto.facing_format(),
          proto.facing_bits(),
          proto.facing_planes(),
          proto.facing_lights()};
}

BitsFields MappedFields(const v1::Readback& proto) {
  return {"mapped",
          proto.mapped_format(),
          proto.mapped_bits(),
          proto.mapped_planes(),
          proto.mapped_lights()};
}

absl::StatusOr<BitsHeader> ShadowHeaderFromProto(const v1::Readback& proto,
                                                 int num_lights,
                                                 int64_t num_pixels) {
  absl::StatusOr<BitsHeader> header = BitsHeaderOf(ShadowFields(proto), num_lights, num_pixels);
  if (header.ok() && header->is_absent()) header->format = v1::SHADOW_FORMAT_BITS;
  return header;
}

absl::StatusOr<BitsHeader> FacingHeaderFromProto(const v1::Readback& proto,
                                                 int num_lights,
                                                 int64_t num_pixels) {
  return OptionalHeaderOf(FacingFields(proto), num_lights, num_pixels);
}

absl::StatusOr<BitsHeader> MappedHeaderFromProto(const v1::Readback& proto,
                                                 int num_lights,
                                                 int64_t num_pixels) {
  return OptionalHeaderOf(MappedFields(proto), num_lights, num_pixels);
}

absl::Status CheckPiece(absl::string_view field,
                        absl::string_view bytes,
                        int64_t value_bytes,
                        int64_t arrived,
                        int64_t want,
                        ValueCount count) {
  const int64_t size = static_cast<int64_t>(bytes.size());
  if (size % value_bytes != 0) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: %d bytes, want whole values of %d bytes each", field, size, value_bytes));
  }
  if (size > want - arrived) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s: %d bytes, want %d: %s values of %d bytes, as in %s",
                        field,
                        arrived + size,
                        want,
                        count.product,
                        value_bytes,
                        count.said_in));
  }
  return absl::OkStatus();
}

absl::Status CheckArrived(absl::string_view field,
                          int64_t arrived,
                          int64_t want,
                          ValueCount count) {
  if (arrived == want) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat("%s: %d bytes, want %d: %s values as in %s",
                                                    field,
                                                    arrived,
                                                    want,
                                                    count.product,
                                                    count.said_in));
}

absl::Status BitBuffer::Append(const BitsFields& fields) {
  absl::Status status = AppendBits(fields.bits);
  for (int plane = 0; plane < fields.planes.size() && status.ok(); ++plane) {
    status = AppendPlane(plane, fields.planes[plane]);
  }
  return status;
}

absl::Status BitBuffer::AppendBits(absl::string_view bytes) {
  if (bytes.empty()) return absl::OkStatus();
  if (header_.is_absent()) return Unannounced(header_, "bits", "SHADOW_FORMAT_BITS");
  if (!header_.has_bits()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("readback.%s_bits: has pixels beside readback.%s_planes, want one of them",
                        header_.name,
                        header_.name));
  }
  absl::Status status = CheckPiece(
      BitsField(header_), bytes, sizeof(uint32_t), num_bits_bytes_, header_.bits_bytes());
  if (!status.ok()) return status;
  num_bits_bytes_ += static_cast<int64_t>(bytes.size());
  const size_t first = words_.size();
  GrowTo(first + bytes.size() / sizeof(uint32_t), header_.num_pixels, &words_);
  std::memcpy(words_.data() + first, bytes.data(), bytes.size());
  return absl::OkStatus();
}

absl::Status BitBuffer::AppendPlane(int plane, absl::string_view bytes) {
  if (header_.is_absent()) {
    return bytes.empty() ? absl::OkStatus()
                         : Unannounced(header_, "planes", "SHADOW_FORMAT_PLANES");
  }
  if (header_.has_bits()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("readback.%s_planes: has pixels, but readback.%s_format says bits; want "
                        "SHADOW_FORMAT_PLANES before planes in chunks",
                        header_.name,
                        header_.name));
  }
  if (plane < 0 || plane >= header_.num_lights) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s plane %d: there are %d lights, want one plane for each, counted "
                        "from 0",
                        header_.name,
                        plane,
                        header_.num_lights));
  }
  if (bytes.empty()) return absl::OkStatus();
  const uint32_t bit = uint32_t{1} << plane;
  if ((header_.lights & bit) == 0) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s: has pixels, but readback.%s_lights = %#x says that it is not known",
                        PlaneField(header_, plane),
                        header_.name,
                        header_.lights));
  }
  int64_t& arrived = num_plane_bytes_[plane];
  absl::Status status =
      CheckPiece(PlaneField(header_, plane), bytes, 1, arrived, header_.plane_bytes());
  if (!status.ok()) return status;
  GrowTo(static_cast<size_t>(arrived) + bytes.size(), header_.num_pixels, &words_);
  uint32_t* const words = words_.data() + arrived;
  for (size_t i = 0; i < bytes.size(); ++i) {
    if (static_cast<uint8_t>(bytes[i]) >= kLeastSet) words[i] |= bit;
  }
  arrived += static_cast<int64_t>(bytes.size());
  return absl::OkStatus();
}

absl::Status BitBuffer::CheckComplete() const {
  if (header_.is_absent()) return absl::OkStatus();
  if (header_.has_bits()) {
    return CheckArrived(BitsField(header_), num_bits_bytes_, header_.bits_bytes());
  }
  for (int plane = 0; plane < header_.num_lights; ++plane) {
    if ((header_.lights >> plane & 1u) == 0) continue;
    absl::Status status =
        CheckArrived(PlaneField(header_, plane), num_plane_bytes_[plane], header_.plane_bytes());
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace lightfit
