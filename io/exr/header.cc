#include "io/exr/header.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"
#include "io/exr/claims.h"
#include "wire/utf8.h"

namespace lightfit::internal {

namespace {

constexpr uint32_t kTiled = 0x200, kMultiPart = 0x1000;  // of the flags
constexpr size_t kMaxNameBytes = 255;

// A file with more is no read-back.
constexpr size_t kMaxParts = 1024;
constexpr int kMaxNames = 1 << 16;  // of attributes and channels, in all parts

constexpr std::pair<absl::string_view, int64_t> kBytesOfTypes[] = {{"box2f", 16},
                                                                   {"box2i", 16},
                                                                   {"chromaticities", 32},
                                                                   {"compression", 1},
                                                                   {"deepImageState", 1},
                                                                   {"double", 8},
                                                                   {"envmap", 1},
                                                                   {"float", 4},
                                                                   {"int", 4},
                                                                   {"keycode", 28},
                                                                   {"lineOrder", 1},
                                                                   {"m33d", 72},
                                                                   {"m33f", 36},
                                                                   {"m44d", 128},
                                                                   {"m44f", 64},
                                                                   {"rational", 8},
                                                                   {"tiledesc", 9},
                                                                   {"timecode", 8},
                                                                   {"v2d", 16},
                                                                   {"v2f", 8},
                                                                   {"v2i", 8},
                                                                   {"v3d", 24},
                                                                   {"v3f", 12},
                                                                   {"v3i", 12}};

uint32_t ReadUint32(std::istream& file) {
  unsigned char bytes[4] = {};
  file.read(reinterpret_cast<char*>(bytes), sizeof(bytes));
  return bytes[0] | uint32_t{bytes[1]} << 8 | uint32_t{bytes[2]} << 16 | uint32_t{bytes[3]} << 24;
}

int64_t ReadInt32(std::istream& file) { return static_cast<int32_t>(ReadUint32(file)); }

// Up to the 0 that ends it; longer than kMaxNameBytes when there is none.
std::string ReadName(std::istream& file) {
  std::string name;
  for (char c = 0; name.size() <= kMaxNameBytes && file.get(c) && c != '\0';) name.push_back(c);
  return name;
}

// Of the thumbnail that begins here.
int64_t BytesOfPreview(std::istream& file) {
  const int64_t width = ReadUint32(file), height = ReadUint32(file);
  constexpr int64_t kMaxSide = 1 << 16;
  return width <= kMaxSide && height <= kMaxSide ? 8 + 4 * width * height : -1;
}

class HeaderCheck {
 public:
  explicit HeaderCheck(std::istream& file) : file_(file) {
    file_.seekg(0, std::ios::end);
    num_bytes_ = file_.tellg();
    file_.seekg(4);
  }

  absl::Status Run() {
    const uint32_t flags = ReadUint32(file_);
    const bool is_multi_part = (flags & kMultiPart) != 0;
    for (bool ends_part = true;;) {
      const std::string name = ReadName(file_);
      if (name.empty()) {
        if (!is_multi_part || ends_part) return CheckClaims();
        ends_part = true;
        continue;
      }
      if (ends_part) {
        parts_.emplace_back().is_tiled = !is_multi_part && (flags & kTiled) != 0;
        if (parts_.size() > kMaxParts) {
          return absl::InvalidArgumentError(
              absl::StrFormat("has more than %d parts, want a read-back", kMaxParts));
        }
      }
      ends_part = false;
      if (absl::Status status = CheckAttribute(name); !status.ok()) return status;
      if (++num_names_ > kMaxNames) {
        return absl::InvalidArgumentError(absl::StrFormat(
            "has more than %d attributes and channels, want a read-back", kMaxNames));
      }
    }
  }

 private:
  // Of all parts, once it is known how many bytes are left for their pixels.
  absl::Status CheckClaims() {
    if (!file_) return absl::OkStatus();  // cut within the last 0, which OpenEXR sees
    const int64_t bytes_left = num_bytes_ - file_.tellg();
    for (size_t i = 0; i < parts_.size(); ++i) {
      absl::Status status = CheckExrClaims(parts_[i], bytes_left);
      if (!status.ok()) {
        return absl::Status(status.code(), absl::StrCat("part ", i, " ", status.message()));
      }
    }
    return absl::OkStatus();
  }

  // What the value that begins here, which is as its type should be, says about the part's pixels.
  void NoteClaim(absl::string_view name, absl::string_view type, int64_t size) {
    ExrClaims& part = parts_.back();
    if (name == "dataWindow" && type == "box2i") {
      const int64_t x_min = ReadInt32(file_), y_min = ReadInt32(file_);
      part.width = ReadInt32(file_) - x_min + 1;
      part.height = ReadInt32(file_) - y_min + 1;
    } else if (name == "tiles" && type == "tiledesc") {
      part.tile_width = ReadUint32(file_);
      part.tile_height = ReadUint32(file_);
    } else if (name == "compression" && type == "compression") {
      part.compression = file_.get();
    } else if (name == "chunkCount" && type == "int") {
      part.chunk_count = ReadInt32(file_);
    } else if (name == "type" && type == "string") {
      std::string value(static_cast<size_t>(std::min<int64_t>(size, kMaxNameBytes)), '\0');
      file_.read(value.data(), static_cast<std::streamsize>(value.size()));
      part.is_tiled = part.is_tiled || absl::StrContains(value, "tile");
    }
  }

  // Of the list of channels that begins here.
  int64_t BytesOfChannels() {
    constexpr int64_t kBytesAfterType = 12;
    const int64_t begin = file_.tellg();
    while (file_ && !ReadName(file_).empty()) {
      constexpr uint32_t kHalf = 1;
      parts_.back().bytes_per_pixel += ReadUint32(file_) == kHalf ? 2 : 4;
      file_.seekg(kBytesAfterType, std::ios::cur);
      ++num_names_;
    }
    return file_ ? int64_t{file_.tellg()} - begin : -1;
  }

  // What OpenEXR reads of an attribute that begins here and says that it has `size` bytes.
  int64_t BytesOfValue(absl::string_view type, int64_t size) {
    if (type == "chlist") return BytesOfChannels();
    if (type == "preview") return BytesOfPreview(file_);
    if (type == "floatvector") return size / 4 * 4;
    for (const auto& [name, bytes] : kBytesOfTypes) {
      if (name == type) return bytes;
    }
    return size;
  }

  absl::Status CheckAttribute(const std::string& name) {
    const std::string type = ReadName(file_);
    const int64_t size = static_cast<int32_t>(ReadUint32(file_));
    const int64_t begin = file_.tellg();
    if (!file_) return absl::InvalidArgumentError("its header is cut short");
    if (name.size() > kMaxNameBytes || type.size() > kMaxNameBytes || size < 0 ||
        size > num_bytes_ - begin || BytesOfValue(type, size) != size) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "attribute \"%s\" of type \"%s\" says that it has %d bytes, where %d are left of the "
          "file, or it is not as its type should be: the file is damaged or cut short",
          Utf8Text(name.substr(0, kMaxNameBytes)),
          Utf8Text(type.substr(0, kMaxNameBytes)),
          size,
          num_bytes_ - begin));
    }
    file_.seekg(begin);
    NoteClaim(name, type, size);
    file_.seekg(begin + size);
    return absl::OkStatus();
  }

  std::istream& file_;
  std::vector<ExrClaims> parts_;
  int64_t num_bytes_ = 0;
  int num_names_ = 0;
};

}  // namespace

absl::Status CheckExrHeader(std::istream& file) {
  absl::Status status = HeaderCheck(file).Run();
  file.clear();
  file.seekg(0);
  return status;
}

}  // namespace lightfit::internal
