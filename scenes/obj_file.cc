#include "scenes/obj_file.h"

#include <charconv>
#include <cstdint>
#include <string>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "scenes/triangulate.h"

namespace lightfit {

namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

absl::string_view TakeWord(absl::string_view* line) {
  size_t begin = 0;
  while (begin < line->size() && IsBlank((*line)[begin])) ++begin;
  size_t end = begin;
  while (end < line->size() && !IsBlank((*line)[end])) ++end;
  const absl::string_view word = line->substr(begin, end - begin);
  line->remove_prefix(end);
  return word;
}

// The number that the whole word is.
template <typename T>
bool ParseNumber(absl::string_view word, T* value) {
  if (absl::ConsumePrefix(&word, "+") && !word.empty() && word[0] == '-') return false;
  const char* end = word.data() + word.size();
  const auto [last, error] = std::from_chars(word.data(), end, *value);
  if constexpr (std::is_floating_point_v<T>) {
    // Too large is infinite and too small zero.
    if (error == std::errc::result_out_of_range) return absl::SimpleAtod(word, value);
  }
  return last == end && error == std::errc();
}

class ObjParser {
 public:
  absl::Status Read(absl::string_view text) {
    while (!text.empty()) {
      const absl::string_view line = TakeLine(&text);
      if (absl::Status status = ReadLine(line); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  absl::StatusOr<Scene> Finish() {
    if (last_index_ >= static_cast<int64_t>(vertices_.size())) {
      line_number_ = last_index_line_;
      return Refuse(
          absl::StrFormat("a face has vertex %d, but the file has %d; it is damaged or cut short",
                          last_index_ + 1,
                          vertices_.size()));
    }
    std::vector<Eigen::Vector3i> triangles;
    Triangulator triangulator(vertices_);
    int64_t begin = 0;
    for (const int64_t end : ends_) {
      if (!triangulator.Append(absl::MakeConstSpan(corners_).subspan(begin, end - begin),
                               &triangles)) {
        return absl::InvalidArgumentError(
            absl::StrFormat("has a face of %d corners that is too tangled to be cut into triangles "
                            "in reasonable time: write it with triangles",
                            end - begin));
      }
      begin = end;
    }
    return MakeScene(vertices_, std::move(triangles));
  }

 private:
  // A line of the file, or several that a backslash at the end continues.
  absl::string_view TakeLine(absl::string_view* text) {
    joined_.clear();
    while (true) {
      ++line_number_;
      const size_t end = text->find('\n');
      absl::string_view line = text->substr(0, end);
      text->remove_prefix(end == absl::string_view::npos ? text->size() : end + 1);
      absl::ConsumeSuffix(&line, "\r");
      const bool is_continued = absl::ConsumeSuffix(&line, "\\") && !text->empty();
      if (!is_continued && joined_.empty()) return line;
      absl::StrAppend(&joined_, line, " ");
      if (!is_continued) return joined_;
    }
  }

  absl::Status ReadLine(absl::string_view line) {
    absl::string_view rest = line;
    const absl::string_view word = TakeWord(&rest);
    if (word == "v") return ReadVertex(line, rest);
    if (word == "f" || word == "fo") return ReadFace(line, rest);
    return absl::OkStatus();
  }

  absl::Status ReadVertex(absl::string_view line, absl::string_view rest) {
    Eigen::Vector3d vertex;
    for (double& coordinate : vertex) {
      if (!ParseNumber(TakeWord(&rest), &coordinate)) {
        return Refuse(absl::StrCat(Quoted(line), " is no vertex, want v X Y Z"));
      }
    }
    vertices_.push_back(vertex);
    return absl::OkStatus();
  }

  absl::Status ReadFace(absl::string_view line, absl::string_view rest) {
    const size_t first = corners_.size();
    for (absl::string_view word = TakeWord(&rest); !word.empty(); word = TakeWord(&rest)) {
      if (word[0] == '#') break;
      int64_t index = 0;
      if (!ParseNumber(word.substr(0, word.find('/')), &index) || index == 0) {
        return Refuse(absl::StrCat(
            Quoted(line), " is no face, want f I J K ... with vertices counted from 1 or from -1"));
      }
      const auto num_vertices = static_cast<int64_t>(vertices_.size());
      index = index > 0 ? index - 1 : num_vertices + index;
      if (index < 0 || index >= INT32_MAX) {
        return Refuse(absl::StrFormat(
            "%s goes back beyond the first of %d vertices", Quoted(line), num_vertices));
      }
      if (index > last_index_) {
        last_index_ = index;
        last_index_line_ = line_number_;
      }
      corners_.push_back(static_cast<int>(index));
    }
    if (corners_.size() > first + 2) {
      ends_.push_back(static_cast<int64_t>(corners_.size()));
    } else {
      corners_.resize(first);  // a point or a line
    }
    return absl::OkStatus();
  }

  absl::Status Refuse(absl::string_view what) const {
    return absl::InvalidArgumentError(absl::StrCat("line ", line_number_, ": ", what));
  }

  static std::string Quoted(absl::string_view line) {
    constexpr size_t kMaxBytes = 80;
    return absl::StrCat("\"", absl::CHexEscape(line.substr(0, kMaxBytes)), "\"");
  }

  std::vector<Eigen::Vector3d> vertices_;
  // Polygons, one after the other: where each ends among `corners_`.
  std::vector<int> corners_;
  std::vector<int64_t> ends_;
  int64_t last_index_ = -1, last_index_line_ = 0;
  int64_t line_number_ = 0;
  std::string joined_;
};

}  // namespace

absl::StatusOr<Scene> ParseObj(absl::string_view text) {
  ObjParser parser;
  if (absl::Status status = parser.Read(text); !status.ok()) return status;
  return parser.Finish();
}

}  // namespace lightfit
