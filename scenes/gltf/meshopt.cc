#include "scenes/gltf/meshopt.h"

#include <meshoptimizer.h>

#include "absl/strings/escaping.h"
#include "absl/strings/str_format.h"

namespace lightfit::gltf {

namespace {

// The densest that the codecs go: vertices without any change, a bit pair for 16 bytes.
constexpr int64_t kMaxBytesPerByte = 64, kMaxExtraBytes = 65536;

bool IsLayoutFine(const MeshoptLayout& layout) {
  if (layout.mode == "ATTRIBUTES") {
    if (layout.stride < 4 || layout.stride > 256 || layout.stride % 4 != 0) return false;
    if (layout.filter.empty() || layout.filter == "NONE" || layout.filter == "EXPONENTIAL") {
      return true;
    }
    if (layout.filter == "OCTAHEDRAL") return layout.stride == 4 || layout.stride == 8;
    return layout.filter == "QUATERNION" && layout.stride == 8;
  }
  if (layout.stride != 2 && layout.stride != 4) return false;
  if (!layout.filter.empty() && layout.filter != "NONE") return false;
  return layout.mode == "INDICES" || (layout.mode == "TRIANGLES" && layout.count % 3 == 0);
}

}  // namespace

absl::StatusOr<std::string> DecodeMeshopt(const MeshoptLayout& layout, absl::string_view packed) {
  if (!IsLayoutFine(layout)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("mode %s with filter %s, %d elements of %d bytes is not allowed",
                        absl::CHexEscape(layout.mode.substr(0, 40)),
                        absl::CHexEscape(layout.filter.substr(0, 40)),
                        layout.count,
                        layout.stride));
  }
  const int64_t max_bytes = kMaxExtraBytes + kMaxBytesPerByte * static_cast<int64_t>(packed.size());
  if (layout.count > max_bytes / layout.stride) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%d bytes cannot hold %d elements of %d bytes; it is damaged",
                        packed.size(),
                        layout.count,
                        layout.stride));
  }
  const auto count = static_cast<size_t>(layout.count);
  const auto stride = static_cast<size_t>(layout.stride);
  const auto* bytes = reinterpret_cast<const unsigned char*>(packed.data());
  std::string unpacked(count * stride, '\0');
  int error = 0;
  if (layout.mode == "ATTRIBUTES") {
    error = meshopt_decodeVertexBuffer(unpacked.data(), count, stride, bytes, packed.size());
  } else if (layout.mode == "TRIANGLES") {
    error = meshopt_decodeIndexBuffer(unpacked.data(), count, stride, bytes, packed.size());
  } else {
    error = meshopt_decodeIndexSequence(unpacked.data(), count, stride, bytes, packed.size());
  }
  if (error != 0) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%d bytes cannot be unpacked (error %d); they are damaged or of a later "
                        "version of the codec",
                        packed.size(),
                        error));
  }
  if (layout.filter == "OCTAHEDRAL") {
    meshopt_decodeFilterOct(unpacked.data(), count, stride);
  } else if (layout.filter == "QUATERNION") {
    meshopt_decodeFilterQuat(unpacked.data(), count, stride);
  } else if (layout.filter == "EXPONENTIAL") {
    meshopt_decodeFilterExp(unpacked.data(), count, stride);
  }
  return unpacked;
}

}  // namespace lightfit::gltf
