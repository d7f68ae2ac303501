#include "io/exr_header.h"

#include <cstdint>
#include <fstream>
#include <utility>

#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"
#include "wire/utf8.h"

namespace lightfit::internal {

namespace {

constexpr uint32_t kMultiPart = 0x1000;  // of the flags
constexpr size_t kMaxNameBytes = 255;

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

// Up to the 0 that ends it; longer than kMaxNameBytes when there is none.
std::string ReadName(std::istream& file) {
  std::string name;
  for (char c = 0; name.size() <= kMaxNameBytes && file.get(c) && c != '\0';) name.push_back(c);
  return name;
}

// Bytes of the list of channels that begins here. OpenImageIO ends the program when a channel is of
// a kind that it does not know.
int64_t BytesOfChannels(std::istream& file) {
  constexpr uint32_t kNumPixelTypes = 3;  // UINT, HALF, FLOAT
  constexpr int64_t kBytesAfterType = 12;
  const int64_t begin = file.tellg();
  while (file && !ReadName(file).empty()) {
    if (ReadUint32(file) >= kNumPixelTypes) return -1;
    file.seekg(kBytesAfterType, std::ios::cur);
  }
  return file ? int64_t{file.tellg()} - begin : -1;
}

// Of the thumbnail that begins here.
int64_t BytesOfPreview(std::istream& file) {
  const int64_t width = ReadUint32(file), height = ReadUint32(file);
  constexpr int64_t kMaxSide = 1 << 16;
  return width <= kMaxSide && height <= kMaxSide ? 8 + 4 * width * height : -1;
}

// What OpenEXR reads of an attribute that begins here and says that it has `size` bytes.
int64_t BytesOfValue(std::istream& file, absl::string_view type, int64_t size) {
  if (type == "chlist") return BytesOfChannels(file);
  if (type == "preview") return BytesOfPreview(file);
  if (type == "floatvector") return size / 4 * 4;
  for (const auto& [name, bytes] : kBytesOfTypes) {
    if (name == type) return bytes;
  }
  return size;
}

absl::Status CheckAttribute(std::istream& file, const std::string& name, int64_t num_bytes) {
  const std::string type = ReadName(file);
  const int64_t size = static_cast<int32_t>(ReadUint32(file));
  const int64_t begin = file.tellg();
  if (!file) return absl::InvalidArgumentError("its header is cut short");
  if (name.size() > kMaxNameBytes || type.size() > kMaxNameBytes || size < 0 ||
      size > num_bytes - begin || BytesOfValue(file, type, size) != size) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "attribute \"%s\" of type \"%s\" says that it has %d bytes, where %d are left of the "
        "file, or it is not as its type should be: the file is damaged or cut short",
        Utf8Text(name.substr(0, kMaxNameBytes)),
        Utf8Text(type.substr(0, kMaxNameBytes)),
        size,
        num_bytes - begin));
  }
  file.seekg(begin + size);
  return absl::OkStatus();
}

}  // namespace

absl::Status CheckExrHeader(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(0, std::ios::end);
  const int64_t num_bytes = file.tellg();
  file.seekg(4);
  const bool is_multi_part = (ReadUint32(file) & kMultiPart) != 0;
  for (bool ends_part = true;;) {
    const std::string name = ReadName(file);
    if (name.empty()) {
      if (!is_multi_part || ends_part) return absl::OkStatus();
      ends_part = true;
      continue;
    }
    ends_part = false;
    if (absl::Status status = CheckAttribute(file, name, num_bytes); !status.ok()) return status;
  }
}

}  // namespace lightfit::internal
