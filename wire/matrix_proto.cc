#include "wire/matrix_proto.h"

#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"

namespace lightfit {

namespace {

struct NamedClip {
  const char* name;
  ClipConvention clip;
};

const NamedClip kNamedClips[] = {{"vulkan", ClipConvention::Vulkan()},
                                 {"direct3d", ClipConvention::Direct3D()},
                                 {"opengl", ClipConvention::OpenGl()},
                                 {"reversed_z", ClipConvention::ReversedZ()},
                                 {"direct3d_reversed", ClipConvention::Direct3DReversed()}};

// What else people call them.
struct ClipAlias {
  const char* alias;
  const char* name;
};

const ClipAlias kClipAliases[] = {{"vk", "vulkan"},
                                  {"d3d", "direct3d"},
                                  {"d3d11", "direct3d"},
                                  {"d3d12", "direct3d"},
                                  {"directx", "direct3d"},
                                  {"dx", "direct3d"},
                                  {"dx11", "direct3d"},
                                  {"dx12", "direct3d"},
                                  {"metal", "direct3d"},
                                  {"webgpu", "direct3d"},
                                  {"gl", "opengl"},
                                  {"gles", "opengl"},
                                  {"webgl", "opengl"},
                                  {"vulkan_reversed", "reversed_z"},
                                  {"d3d_reversed", "direct3d_reversed"},
                                  {"directx_reversed", "direct3d_reversed"},
                                  {"metal_reversed", "direct3d_reversed"},
                                  {"webgpu_reversed", "direct3d_reversed"}};

// In lower case, and with one sign between words.
std::string Canonical(absl::string_view name) {
  std::string canonical =
      absl::StrReplaceAll(absl::AsciiStrToLower(name), {{"-", "_"}, {" ", "_"}});
  for (const ClipAlias& alias : kClipAliases) {
    if (canonical == alias.alias) return alias.name;
  }
  return canonical;
}

}  // namespace

absl::StatusOr<Eigen::Matrix4d> MatrixFromProto(const v1::Matrix4x4& proto,
                                                absl::string_view field) {
  if (proto.m_size() != 16) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s: m has %d numbers, want 16, row-major", field, proto.m_size()));
  }
  const Eigen::Matrix4d matrix =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(proto.m().data());
  if (!matrix.allFinite()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s: m has values that are not finite, want 16 numbers", field));
  }
  return matrix;
}

v1::Matrix4x4 MatrixToProto(const Eigen::Matrix4d& matrix) {
  v1::Matrix4x4 proto;
  proto.mutable_m()->Reserve(16);
  // + 0.0 turns -0 into 0, which JSON would otherwise write as "-0".
  for (int i = 0; i < 16; ++i) proto.add_m(matrix(i / 4, i % 4) + 0.0);
  return proto;
}

absl::StatusOr<ClipConvention> ClipConventionFromProto(const v1::ClipConvention& proto,
                                                       absl::string_view field) {
  ClipConvention clip;
  clip.y_up = proto.y_up();
  switch (proto.depth_range()) {
    case v1::ClipConvention::DEPTH_RANGE_ZERO_TO_ONE:
      clip.depth = ClipConvention::Depth::kZeroToOne;
      return clip;
    case v1::ClipConvention::DEPTH_RANGE_MINUS_ONE_TO_ONE:
      clip.depth = ClipConvention::Depth::kMinusOneToOne;
      return clip;
    case v1::ClipConvention::DEPTH_RANGE_REVERSED_ZERO_TO_ONE:
      clip.depth = ClipConvention::Depth::kReversedZeroToOne;
      return clip;
    default:
      return absl::InvalidArgumentError(
          absl::StrFormat("%s: depth_range = %d, want DEPTH_RANGE_ZERO_TO_ONE, "
                          "DEPTH_RANGE_MINUS_ONE_TO_ONE or DEPTH_RANGE_REVERSED_ZERO_TO_ONE",
                          field,
                          proto.depth_range()));
  }
}

v1::Border BorderToProto(Border border) {
  return border == Border::kDark ? v1::BORDER_DARK : v1::BORDER_LIT;
}

v1::ClipConvention ClipConventionToProto(const ClipConvention& clip) {
  v1::ClipConvention proto;
  switch (clip.depth) {
    case ClipConvention::Depth::kZeroToOne:
      proto.set_depth_range(v1::ClipConvention::DEPTH_RANGE_ZERO_TO_ONE);
      break;
    case ClipConvention::Depth::kMinusOneToOne:
      proto.set_depth_range(v1::ClipConvention::DEPTH_RANGE_MINUS_ONE_TO_ONE);
      break;
    case ClipConvention::Depth::kReversedZeroToOne:
      proto.set_depth_range(v1::ClipConvention::DEPTH_RANGE_REVERSED_ZERO_TO_ONE);
      break;
  }
  proto.set_y_up(clip.y_up);
  proto.set_name(ClipConventionName(clip));
  return proto;
}

const char* ClipConventionName(const ClipConvention& clip) {
  for (const NamedClip& named : kNamedClips) {
    if (named.clip.depth == clip.depth && named.clip.y_up == clip.y_up) return named.name;
  }
  return "";
}

absl::StatusOr<ClipConvention> ParseClipConvention(absl::string_view name) {
  const std::string canonical = Canonical(name);
  for (const NamedClip& named : kNamedClips) {
    if (canonical == named.name) return named.clip;
  }
  return absl::InvalidArgumentError(absl::StrFormat(
      "clip convention: \"%s\" is not known, want vulkan, direct3d (metal, webgpu), "
      "opengl, reversed_z or direct3d_reversed",
      name));
}

absl::StatusOr<Border> BorderFromProto(v1::Border proto, absl::string_view field) {
  switch (proto) {
    case v1::BORDER_UNSPECIFIED:
    case v1::BORDER_LIT:
      return Border::kLit;
    case v1::BORDER_DARK:
      return Border::kDark;
    default:
      return absl::InvalidArgumentError(
          absl::StrFormat("%s = %d, want BORDER_LIT or BORDER_DARK", field, proto));
  }
}

}  // namespace lightfit
