// calls/bit_buffer.h
//
// One bit per pixel and light of a read-back, which arrives piece by piece, as bits or as planes.
// In:   what the read-back says of it before its first pixel, then pieces of whole values.
// Out:  a word per pixel, light l in bit l.
#pragma once

#include <google/protobuf/repeated_field.h>

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "lightfit/v1/readback.pb.h"

namespace lightfit {

// Named after the fields readback.NAME_bits, NAME_planes, NAME_format and NAME_lights.
struct BitsHeader {
  std::string name;
  v1::ShadowFormat format = v1::SHADOW_FORMAT_UNSPECIFIED;  // unspecified: there are none
  uint32_t lights = 0;                                      // those of which it is known
  int num_lights = 0;
  int64_t num_pixels = 0;

  bool is_absent() const { return format == v1::SHADOW_FORMAT_UNSPECIFIED; }
  bool has_bits() const { return format == v1::SHADOW_FORMAT_BITS; }
  int64_t bits_bytes() const { return num_pixels * int64_t{sizeof(uint32_t)}; }  // as sent
  int64_t plane_bytes() const { return num_pixels; }                             // each, as sent

  // What a BitBuffer of it takes, bytes.
  int64_t buffer_bytes() const { return is_absent() ? 0 : bits_bytes(); }
};

// What a read-back says of one kind of bits.
struct BitsFields {
  const char* name;
  v1::ShadowFormat format;
  const std::string& bits;
  const google::protobuf::RepeatedPtrField<std::string>& planes;
  uint32_t lights;  // 0: not said
};

BitsFields ShadowFields(const v1::Readback& proto);
BitsFields FacingFields(const v1::Readback& proto);
BitsFields MappedFields(const v1::Readback& proto);

// InvalidArgument for a format that is not known, and for lights that are not there. Every light
// has a shadow; the others may be absent, or known of some lights alone.
absl::StatusOr<BitsHeader> ShadowHeaderFromProto(const v1::Readback& proto,
                                                 int num_lights,
                                                 int64_t num_pixels);
absl::StatusOr<BitsHeader> FacingHeaderFromProto(const v1::Readback& proto,
                                                 int num_lights,
                                                 int64_t num_pixels);
absl::StatusOr<BitsHeader> MappedHeaderFromProto(const v1::Readback& proto,
                                                 int num_lights,
                                                 int64_t num_pixels);

class BitBuffer {
 public:
  // Memory is taken as pixels arrive.
  explicit BitBuffer(const BitsHeader& header)
      : header_(header), num_plane_bytes_(header.num_lights, 0) {}

  // InvalidArgument for what goes beyond the end, is of the other format or was not announced.
  absl::Status Append(const BitsFields& fields);
  absl::Status AppendBits(absl::string_view bytes);
  absl::Status AppendPlane(int plane, absl::string_view bytes);

  // InvalidArgument says how much is missing of what.
  absl::Status CheckComplete() const;

  const BitsHeader& header() const { return header_; }

  // Of a complete buffer: a word per pixel, none where it is absent.
  absl::Span<const uint32_t> words() const { return words_; }

 private:
  BitsHeader header_;
  std::vector<uint32_t> words_;
  int64_t num_bits_bytes_ = 0;            // arrived so far
  std::vector<int64_t> num_plane_bytes_;  // of each light
};

// How many values an array has, for messages.
struct ValueCount {
  const char* product;
  const char* said_in;
};
inline constexpr ValueCount kOnePerPixel = {"width * height", "readback.camera and the formats"};

// `bytes` more of `field`, of which `arrived` are there and `want` are wanted in all.
// InvalidArgument unless they are whole values that have room.
absl::Status CheckPiece(absl::string_view field,
                        absl::string_view bytes,
                        int64_t value_bytes,
                        int64_t arrived,
                        int64_t want,
                        ValueCount count = kOnePerPixel);
absl::Status CheckArrived(absl::string_view field,
                          int64_t arrived,
                          int64_t want,
                          ValueCount count = kOnePerPixel);

}  // namespace lightfit
