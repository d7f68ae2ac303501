#include "scenes/gltf/document.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/text_encoding.h"
#include "scenes/gltf/meshopt.h"

namespace lightfit::gltf {

namespace {

// What a file may ask for: a mesh that is shown many times is a small file and a large scene, hence
// the shares. The limit of a scene is ten times what fits into the memory of a workstation.
constexpr int64_t kNumbersPerByte = 64, kMinNumbers = int64_t{1} << 22;
constexpr int64_t kShownPerByte = 256, kMinShown = int64_t{1} << 20;
constexpr int64_t kMaxShown = int64_t{1} << 29;

// Required extensions that are read here, and those that move no geometry.
constexpr absl::string_view kKnown[] = {"EXT_mesh_gpu_instancing",
                                        "EXT_meshopt_compression",
                                        "KHR_draco_mesh_compression",
                                        "KHR_lights_punctual",
                                        "KHR_mesh_quantization",
                                        "KHR_node_visibility",
                                        "EXT_feature_metadata",
                                        "EXT_instance_features",
                                        "EXT_mesh_features",
                                        "EXT_structural_metadata",
                                        "KHR_animation_pointer",
                                        "KHR_techniques_webgl",
                                        "KHR_xmp",
                                        "KHR_xmp_json_ld",
                                        "AGI_stk_metadata",
                                        "ADOBE_materials_clearcoat_specular",
                                        "ADOBE_materials_clearcoat_tint",
                                        "ADOBE_materials_thin_transparency",
                                        "GODOT_single_root"};
constexpr absl::string_view kKnownBeginnings[] = {"KHR_materials_",
                                                  "KHR_texture_",
                                                  "EXT_materials_",
                                                  "EXT_texture_",
                                                  "MSFT_texture_",
                                                  "EXT_lights_",
                                                  "KHR_audio",
                                                  "EXT_color_"};

std::string PercentDecoded(absl::string_view text) {
  std::string decoded;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() &&
        std::isxdigit(static_cast<unsigned char>(text[i + 1])) != 0 &&
        std::isxdigit(static_cast<unsigned char>(text[i + 2])) != 0) {
      decoded += absl::HexStringToBytes(text.substr(i + 1, 2));
      i += 2;
    } else {
      decoded += text[i];
    }
  }
  return decoded;
}

absl::StatusOr<std::string> ReadWhole(const std::filesystem::path& path, int64_t max_bytes) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return absl::InvalidArgumentError("there is no such file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) return absl::InvalidArgumentError("it cannot be opened for reading");
  const auto size = static_cast<int64_t>(std::filesystem::file_size(path, error));
  std::string bytes(static_cast<size_t>(std::min(error ? 0 : size, max_bytes)), '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<size_t>(file.gcount()));
  return bytes;
}

// The bytes that a URI names.
absl::StatusOr<std::string> ReadUri(const std::string& folder,
                                    const std::string& uri,
                                    int64_t max_bytes) {
  const size_t colon = uri.find(':');
  if (absl::StartsWith(uri, "data:")) {
    const size_t comma = uri.find(',');
    if (comma == std::string::npos) return absl::InvalidArgumentError("its data URI has no data");
    const absl::string_view data = absl::string_view(uri).substr(comma + 1);
    if (!absl::EndsWith(absl::string_view(uri).substr(0, comma), ";base64")) {
      return PercentDecoded(data);
    }
    std::string bytes;
    if (!absl::Base64Unescape(data, &bytes)) {
      return absl::InvalidArgumentError("its data URI is no base64");
    }
    return bytes;
  }
  // A drive letter of Windows is one letter before the colon.
  if (colon != std::string::npos && colon > 1 && absl::StartsWith(uri.substr(colon), "://")) {
    return absl::InvalidArgumentError(absl::StrCat(
        "is at ", uri.substr(0, 80), ", want a file beside this one: fetch it and write its name"));
  }
  const std::filesystem::path decoded = std::filesystem::path(folder) / PercentDecoded(uri);
  std::error_code error;
  // Some exporters write names as they are.
  const std::filesystem::path plain = std::filesystem::path(folder) / uri;
  const std::filesystem::path& path =
      std::filesystem::exists(decoded, error) || !std::filesystem::exists(plain, error) ? decoded
                                                                                        : plain;
  absl::StatusOr<std::string> bytes = ReadWhole(path, max_bytes);
  if (!bytes.ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat("is in ", path.string(), ": ", bytes.status().message()));
  }
  return bytes;
}

uint32_t WordAt(absl::string_view bytes, int64_t at) {
  uint32_t word = 0;
  for (int i = 3; i >= 0; --i) {
    word = word << 8 | static_cast<unsigned char>(bytes[static_cast<size_t>(at + i)]);
  }
  return word;
}

}  // namespace

absl::StatusOr<Document> Document::Read(const std::string& path) {
  absl::StatusOr<std::string> bytes = ReadWhole(path, int64_t{1} << 40);
  if (!bytes.ok()) return bytes.status();
  Document document;
  document.num_bytes_ = static_cast<int64_t>(bytes->size());
  document.folder_ = std::filesystem::path(path).parent_path().string();
  absl::Status status;
  if (absl::StartsWith(*bytes, "glTF")) {
    document.file_ = *std::move(bytes);
    status = document.ReadGlb();
  } else {
    const absl::StatusOr<std::string> text = DecodeText(*std::move(bytes));
    if (!text.ok()) return text.status();
    status = document.ParseJson(*text);
  }
  if (!status.ok()) return status;
  const Json* asset = Member(document.json_, "asset");
  const std::string version = asset == nullptr ? "" : TextIn(*asset, "version");
  if (!absl::StartsWith(version, "2")) {
    return absl::InvalidArgumentError(version.empty()
                                          ? "is no glTF file: its JSON has no asset.version"
                                          : absl::StrCat("is glTF ",
                                                         absl::CHexEscape(version.substr(0, 20)),
                                                         ", want 2.0: convert it"));
  }
  status = document.CheckExtensions();
  if (!status.ok()) return status;
  document.buffers_.resize(LengthOf(document.json_, "buffers"));
  document.unpacked_.resize(LengthOf(document.json_, "bufferViews"));
  return document;
}

absl::Status Document::ReadGlb() {
  constexpr int64_t kHeaderBytes = 12, kChunkHeaderBytes = 8;
  constexpr uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
  const absl::string_view bytes = file_;
  const auto cut_short = [this](int64_t wanted) {
    return absl::InvalidArgumentError(
        absl::StrFormat("has %d bytes, but its header says %d or more; it is damaged or cut short",
                        num_bytes_,
                        wanted));
  };
  if (num_bytes_ < kHeaderBytes + kChunkHeaderBytes) {
    return cut_short(kHeaderBytes + kChunkHeaderBytes);
  }
  if (const uint32_t version = WordAt(bytes, 4); version != 2) {
    return absl::InvalidArgumentError(
        absl::StrCat("is GLB version ", version, ", want 2: convert it"));
  }
  const int64_t length = WordAt(bytes, 8);
  if (length > num_bytes_) return cut_short(length);
  absl::string_view text;
  for (int64_t at = kHeaderBytes; at + kChunkHeaderBytes <= length;) {
    const int64_t begin = at + kChunkHeaderBytes, size = WordAt(bytes, at);
    const uint32_t type = WordAt(bytes, at + 4);
    if (begin + size > num_bytes_) return cut_short(begin + size);
    const absl::string_view chunk =
        bytes.substr(static_cast<size_t>(begin), static_cast<size_t>(size));
    if (type == kJson && text.empty()) text = chunk;
    if (type == kBinary && !has_chunk_) {
      chunk_ = chunk;
      has_chunk_ = true;
    }
    at = begin + size;
  }
  return ParseJson(text);
}

absl::Status Document::ParseJson(absl::string_view text) {
  try {
    json_ = Json::parse(text.begin(), text.end());
  } catch (const Json::exception& error) {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: ..."
    const absl::string_view why = error.what();
    const size_t end = why.find("] ");
    return absl::InvalidArgumentError(absl::StrCat(
        "its JSON is damaged: ",
        absl::CHexEscape(why.substr(end == absl::string_view::npos ? 0 : end + 2, 200))));
  }
  return absl::OkStatus();
}

absl::Status Document::CheckExtensions() const {
  const Json* required = Member(json_, "extensionsRequired");
  if (required == nullptr || !required->is_array()) return absl::OkStatus();
  std::vector<std::string> unknown;
  for (const Json& item : *required) {
    const std::string name = item.is_string() ? item.get<std::string>() : "";
    const bool known =
        std::find(std::begin(kKnown), std::end(kKnown), name) != std::end(kKnown) ||
        std::any_of(std::begin(kKnownBeginnings),
                    std::end(kKnownBeginnings),
                    [&name](absl::string_view start) { return absl::StartsWith(name, start); });
    if (!known) unknown.push_back(absl::CHexEscape(name.substr(0, 60)));
  }
  if (unknown.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("requires the extension ",
                   absl::StrJoin(unknown, ", "),
                   ", which is not known here and may move its geometry: write it without"));
}

absl::StatusOr<const Json*> Document::Element(const char* list, int64_t index) const {
  if (index >= 0 && index < LengthOf(json_, list)) {
    return &(*Member(json_, list))[static_cast<size_t>(index)];
  }
  return absl::InvalidArgumentError(
      absl::StrFormat("refers to %s[%d], but has %d", list, index, LengthOf(json_, list)));
}

absl::StatusOr<absl::string_view> Document::BufferBytes(int64_t index) {
  const absl::StatusOr<const Json*> element = Element("buffers", index);
  if (!element.ok()) return element.status();
  Buffer& buffer = buffers_[static_cast<size_t>(index)];
  if (buffer.is_read) return buffer.bytes;
  const std::string where = absl::StrFormat("buffers[%d]", index);
  const absl::StatusOr<int64_t> length = IntegerIn(**element, "byteLength", where);
  if (!length.ok()) return length.status();
  const std::string uri = TextIn(**element, "uri");
  if (!uri.empty()) {
    absl::StatusOr<std::string> bytes = ReadUri(folder_, uri, *length);
    if (!bytes.ok()) {
      return absl::InvalidArgumentError(absl::StrCat(where, " ", bytes.status().message()));
    }
    buffer.owned = *std::move(bytes);
    buffer.bytes = buffer.owned;
    num_bytes_ += static_cast<int64_t>(buffer.owned.size());
  } else if (index == 0 && has_chunk_) {
    buffer.bytes = chunk_;
  } else {
    return absl::InvalidArgumentError(absl::StrCat(where, " has no uri, so there are no bytes"));
  }
  if (static_cast<int64_t>(buffer.bytes.size()) < *length) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s has %d bytes, want the %d of its byteLength; it is damaged or cut short",
        where,
        buffer.bytes.size(),
        *length));
  }
  buffer.bytes = buffer.bytes.substr(0, static_cast<size_t>(*length));
  buffer.is_read = true;
  return buffer.bytes;
}

// The part of a buffer that `from` names with buffer, byteOffset and byteLength.
absl::StatusOr<absl::string_view> Document::Part(const Json& from, absl::string_view where) {
  const absl::StatusOr<int64_t> buffer = IntegerIn(from, "buffer", where);
  if (!buffer.ok()) return buffer.status();
  const absl::StatusOr<int64_t> offset = IntegerIn(from, "byteOffset", where, 0);
  if (!offset.ok()) return offset.status();
  const absl::StatusOr<int64_t> length = IntegerIn(from, "byteLength", where);
  if (!length.ok()) return length.status();
  const absl::StatusOr<absl::string_view> bytes = BufferBytes(*buffer);
  if (!bytes.ok()) return bytes.status();
  const auto size = static_cast<int64_t>(bytes->size());
  if (*offset > size || *length > size - *offset) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s: bytes %d to %d are beyond the %d of buffers[%d]",
                        where,
                        *offset,
                        *offset + *length,
                        size,
                        *buffer));
  }
  return bytes->substr(static_cast<size_t>(*offset), static_cast<size_t>(*length));
}

absl::StatusOr<View> Document::BufferView(int64_t index) {
  const absl::StatusOr<const Json*> element = Element("bufferViews", index);
  if (!element.ok()) return element.status();
  if (const Json* compression = Extension(**element, "EXT_meshopt_compression")) {
    return Unpack(index, *compression);
  }
  const std::string where = absl::StrFormat("bufferViews[%d]", index);
  const absl::StatusOr<absl::string_view> bytes = Part(**element, where);
  if (!bytes.ok()) return bytes.status();
  const absl::StatusOr<int64_t> stride = IntegerIn(**element, "byteStride", where, 0);
  if (!stride.ok()) return stride.status();
  return View{*bytes, *stride};
}

absl::StatusOr<View> Document::Unpack(int64_t index, const Json& compression) {
  const std::string where = absl::StrFormat("bufferViews[%d].EXT_meshopt_compression", index);
  const absl::StatusOr<int64_t> stride = IntegerIn(compression, "byteStride", where);
  if (!stride.ok()) return stride.status();
  Unpacked& unpacked = unpacked_[static_cast<size_t>(index)];
  if (!unpacked.is_read) {
    const absl::StatusOr<int64_t> count = IntegerIn(compression, "count", where);
    if (!count.ok()) return count.status();
    const absl::StatusOr<absl::string_view> packed = Part(compression, where);
    if (!packed.ok()) return packed.status();
    absl::StatusOr<std::string> bytes = DecodeMeshopt(
        {TextIn(compression, "mode"), TextIn(compression, "filter"), *count, *stride}, *packed);
    if (!bytes.ok()) {
      return absl::InvalidArgumentError(absl::StrCat(where, ": ", bytes.status().message()));
    }
    unpacked.bytes = *std::move(bytes);
    unpacked.is_read = true;
  }
  return View{unpacked.bytes, *stride};
}

absl::Status Document::Take(int64_t numbers, int64_t shown) {
  const int64_t max_numbers = kMinNumbers + kNumbersPerByte * num_bytes_;
  const int64_t max_shown = std::min(kMaxShown, kMinShown + kShownPerByte * num_bytes_);
  if (numbers > max_numbers - numbers_) {
    return absl::InvalidArgumentError(
        absl::StrFormat("asks for more than %d numbers, which is out of proportion to its %d bytes",
                        max_numbers,
                        num_bytes_));
  }
  if (shown > max_shown - shown_) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "shows more than %d triangles and vertices, want fewer: take a part of it", max_shown));
  }
  numbers_ += numbers;
  shown_ += shown;
  return absl::OkStatus();
}

}  // namespace lightfit::gltf
