#include "scenes/ply_file.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "absl/types/span.h"
#include "scenes/triangulate.h"

namespace lightfit {

namespace {

enum class Format { kText, kLittleEndian, kBigEndian };
enum class Number { kSigned, kUnsigned, kReal };

struct Type {
  Number number = Number::kReal;
  int num_bytes = 0;
};

struct Property {
  std::string name;
  Type type;
  bool is_list = false;
  Type count_type;  // of a list
};

struct Element {
  std::string name;
  int64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Format format = Format::kText;
  std::vector<Element> elements;
};

// For messages: the beginning of it, what is not ASCII as "\\xff".
std::string Quoted(absl::string_view text) {
  constexpr size_t kMaxBytes = 80;
  return absl::StrCat("\"", absl::CHexEscape(text.substr(0, kMaxBytes)), "\"");
}

absl::StatusOr<Type> TypeOf(absl::string_view name) {
  constexpr std::pair<absl::string_view, Type> kTypes[] = {{"char", {Number::kSigned, 1}},
                                                           {"int8", {Number::kSigned, 1}},
                                                           {"uchar", {Number::kUnsigned, 1}},
                                                           {"uint8", {Number::kUnsigned, 1}},
                                                           {"short", {Number::kSigned, 2}},
                                                           {"int16", {Number::kSigned, 2}},
                                                           {"ushort", {Number::kUnsigned, 2}},
                                                           {"uint16", {Number::kUnsigned, 2}},
                                                           {"int", {Number::kSigned, 4}},
                                                           {"int32", {Number::kSigned, 4}},
                                                           {"uint", {Number::kUnsigned, 4}},
                                                           {"uint32", {Number::kUnsigned, 4}},
                                                           {"float", {Number::kReal, 4}},
                                                           {"float32", {Number::kReal, 4}},
                                                           {"double", {Number::kReal, 8}},
                                                           {"float64", {Number::kReal, 8}}};
  for (const auto& [word, type] : kTypes) {
    if (word == name) return type;
  }
  return absl::InvalidArgumentError(
      absl::StrCat("its header has a property of type ", Quoted(name), ", which PLY has not"));
}

absl::Status Damaged(absl::string_view line) {
  return absl::InvalidArgumentError(
      absl::StrCat("its header has the line ", Quoted(line), "; it is damaged"));
}

absl::StatusOr<Property> ParseProperty(const std::vector<absl::string_view>& words,
                                       absl::string_view line) {
  Property property;
  property.is_list = words.size() == 5 && words[1] == "list";
  if (!property.is_list && words.size() != 3) return Damaged(line);
  if (property.is_list) {
    const absl::StatusOr<Type> count_type = TypeOf(words[2]);
    if (!count_type.ok()) return count_type.status();
    property.count_type = *count_type;
  }
  const absl::StatusOr<Type> type = TypeOf(words[words.size() - 2]);
  if (!type.ok()) return type.status();
  property.type = *type;
  property.name = std::string(words.back());
  return property;
}

// Takes the header off `bytes`.
absl::StatusOr<Header> TakeHeader(absl::string_view* bytes) {
  Header header;
  const auto num_bytes = static_cast<int64_t>(bytes->size());
  while (true) {
    const size_t end = bytes->find('\n');
    if (end == absl::string_view::npos) {
      return absl::InvalidArgumentError(
          "its PLY header has no end_header; it is damaged or cut short");
    }
    const absl::string_view line = absl::StripTrailingAsciiWhitespace(bytes->substr(0, end));
    bytes->remove_prefix(end + 1);
    const std::vector<absl::string_view> words = absl::StrSplit(line, ' ', absl::SkipEmpty());
    if (words.empty() || words[0] == "ply" || words[0] == "comment" || words[0] == "obj_info") {
      continue;
    }
    if (words[0] == "end_header") return header;
    if (words[0] == "format" && words.size() >= 2) {
      if (words[1] == "ascii") {
        header.format = Format::kText;
      } else if (words[1] == "binary_little_endian") {
        header.format = Format::kLittleEndian;
      } else if (words[1] == "binary_big_endian") {
        header.format = Format::kBigEndian;
      } else {
        return Damaged(line);
      }
    } else if (words[0] == "element" && words.size() == 3) {
      Element element;
      element.name = std::string(words[1]);
      if (!absl::SimpleAtoi(words[2], &element.count) || element.count < 0 ||
          element.count > num_bytes) {
        return absl::InvalidArgumentError(
            absl::StrFormat("its header says %s, which a file of %d bytes cannot hold; it is "
                            "damaged or cut short",
                            Quoted(line),
                            num_bytes));
      }
      header.elements.push_back(std::move(element));
    } else if (words[0] == "property" && !header.elements.empty()) {
      absl::StatusOr<Property> property = ParseProperty(words, line);
      if (!property.ok()) return property.status();
      header.elements.back().properties.push_back(*std::move(property));
    } else {
      return Damaged(line);
    }
  }
}

// Numbers one after the other.
class Body {
 public:
  Body(absl::string_view bytes, Format format) : bytes_(bytes), format_(format) {}

  int64_t num_bytes_left() const { return static_cast<int64_t>(bytes_.size()); }

  // False at the end of the file, and for text that is no number.
  bool Next(Type type, double* value) {
    if (format_ == Format::kText) return NextWord(value);
    if (bytes_.size() < static_cast<size_t>(type.num_bytes)) return false;
    char raw[8];
    std::memcpy(raw, bytes_.data(), type.num_bytes);
    bytes_.remove_prefix(type.num_bytes);
    if (format_ == Format::kBigEndian) std::reverse(raw, raw + type.num_bytes);
    uint64_t bits = 0;
    for (int i = 0; i < type.num_bytes; ++i) {
      bits |= uint64_t{static_cast<unsigned char>(raw[i])} << 8 * i;
    }
    const int spare_bits = 64 - 8 * type.num_bytes;
    if (type.number == Number::kUnsigned) {
      *value = static_cast<double>(bits);
    } else if (type.number == Number::kSigned) {
      *value = static_cast<double>(static_cast<int64_t>(bits << spare_bits) >> spare_bits);
    } else if (type.num_bytes == 4) {
      const auto low_bits = static_cast<uint32_t>(bits);
      float single;
      std::memcpy(&single, &low_bits, sizeof(single));
      *value = single;
    } else {
      std::memcpy(value, &bits, sizeof(*value));
    }
    return true;
  }

  // In text an entry is a line: what else stands on it is left out.
  void EndEntry() {
    if (format_ != Format::kText) return;
    const size_t end = bytes_.find('\n');
    bytes_.remove_prefix(end == absl::string_view::npos ? bytes_.size() : end);
  }

 private:
  bool NextWord(double* value) {
    size_t begin = 0;
    while (begin < bytes_.size() && absl::ascii_isspace(bytes_[begin])) ++begin;
    size_t end = begin;
    while (end < bytes_.size() && !absl::ascii_isspace(bytes_[end])) ++end;
    const absl::string_view word = bytes_.substr(begin, end - begin);
    bytes_.remove_prefix(end);
    return absl::SimpleAtod(word, value);
  }

  absl::string_view bytes_;
  Format format_;
};

// What the body of a file holds.
struct Content {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
  // Polygons, one after the other: where each ends among `corners`. Vertices may stand behind them.
  std::vector<int> corners;
  std::vector<int64_t> ends;
};

// What is no index stays none as an integer.
int IndexOf(double value) {
  return value >= 0.0 && value < 2147483647.0 ? static_cast<int>(value) : -1;
}

// Strips of triangles, each of three neighbours in the list; -1 ends a strip.
void AppendStrips(const std::vector<double>& list, std::vector<Eigen::Vector3i>* triangles) {
  constexpr double kUnsignedEnd = 4294967295.0;  // -1 in a list of uint
  size_t begin = 0;
  for (size_t i = 0; i < list.size(); ++i) {
    if (list[i] < 0.0 || list[i] == kUnsignedEnd) {
      begin = i + 1;
    } else if (i >= begin + 2) {
      const int a = IndexOf(list[i - 2]), b = IndexOf(list[i - 1]), c = IndexOf(list[i]);
      // A repeated corner turns the strip around a fold; it is no bad triangle of the file.
      if (a == b || b == c || c == a) continue;
      if ((i - begin) % 2 == 0) {
        triangles->emplace_back(a, b, c);
      } else {
        triangles->emplace_back(b, a, c);
      }
    }
  }
}

void AppendPolygon(const std::vector<double>& list, Content* content) {
  for (const double value : list) content->corners.push_back(IndexOf(value));
  content->ends.push_back(static_cast<int64_t>(content->corners.size()));
}

// The list of a face's corners: by its name, or as the only list that there is.
const Property* CornersOf(const Element& element) {
  const Property* only = nullptr;
  int num_lists = 0;
  for (const Property& property : element.properties) {
    if (!property.is_list) continue;
    if (property.name == "vertex_indices" || property.name == "vertex_index") return &property;
    only = &property;
    ++num_lists;
  }
  return num_lists == 1 ? only : nullptr;
}

// Reads one entry of an element; false when the file ends within.
bool ReadEntry(const Element& element,
               const Property* corners,
               Body* body,
               std::vector<double>* list,
               Content* content) {
  const bool is_vertex = element.name == "vertex";
  Eigen::Vector3d vertex = Eigen::Vector3d::Zero();
  for (const Property& property : element.properties) {
    double value = 0.0;
    if (property.is_list) {
      if (!body->Next(property.count_type, &value)) return false;
      if (!(value >= 0.0 && value <= static_cast<double>(body->num_bytes_left()))) return false;
      list->resize(static_cast<size_t>(value));
      for (double& item : *list) {
        if (!body->Next(property.type, &item)) return false;
      }
      if (&property != corners) continue;
      if (element.name == "face") {
        AppendPolygon(*list, content);
      } else {
        AppendStrips(*list, &content->triangles);
      }
      continue;
    }
    if (!body->Next(property.type, &value)) return false;
    if (!is_vertex || property.name.size() != 1) continue;
    const int axis = property.name[0] - 'x';
    if (axis >= 0 && axis < 3) vertex[axis] = value;
  }
  if (is_vertex) content->vertices.push_back(vertex);
  body->EndEntry();
  return true;
}

// The content as a scene, polygons cut into triangles.
absl::StatusOr<Scene> SceneOf(Content content) {
  Triangulator triangulator(content.vertices);
  int64_t begin = 0;
  for (const int64_t end : content.ends) {
    if (!triangulator.Append(absl::MakeConstSpan(content.corners).subspan(begin, end - begin),
                             &content.triangles)) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "has a polygon of %d corners that is too tangled to be cut into triangles "
          "in reasonable time: write it with triangles",
          end - begin));
    }
    begin = end;
  }
  return MakeScene(content.vertices, std::move(content.triangles));
}

}  // namespace

absl::StatusOr<Scene> ParsePly(absl::string_view bytes) {
  const absl::StatusOr<Header> header = TakeHeader(&bytes);
  if (!header.ok()) return header.status();
  Content content;
  Body body(bytes, header->format);
  std::vector<double> list;
  for (const Element& element : header->elements) {
    if (element.properties.empty()) continue;
    const bool has_corners = element.name == "face" || element.name == "tristrips";
    const Property* corners = has_corners ? CornersOf(element) : nullptr;
    if (has_corners && corners == nullptr) {
      return absl::InvalidArgumentError(
          absl::StrFormat("its element %s has no list vertex_indices", element.name));
    }
    for (int64_t i = 0; i < element.count; ++i) {
      if (!ReadEntry(element, corners, &body, &list, &content)) {
        return absl::InvalidArgumentError(
            absl::StrFormat("%s %d of %d cannot be read; the file is damaged or cut short",
                            absl::CHexEscape(element.name.substr(0, 40)),
                            i + 1,
                            element.count));
      }
    }
  }
  return SceneOf(std::move(content));
}

}  // namespace lightfit
