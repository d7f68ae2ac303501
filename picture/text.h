// picture/text.h
//
// Text on a Canvas, in the DejaVu or Liberation typeface of the system.
#pragma once

#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "picture/canvas.h"

namespace lightfit {

enum class Anchor { kLeft, kMiddle, kRight };

struct TextStyle {
  int size_px = 15;
  Rgb color{};
  bool bold = false;
  Anchor anchor = Anchor::kLeft;
};

// A typeface that was found on this machine, or none: then nothing is drawn and widths are 0.
class Typeface {
 public:
  // Looks at the file that the environment variable LIGHTFIT_FONT names, then where the
  // distributions put DejaVu Sans and Liberation Sans.
  static Typeface Find();

  bool found() const { return !regular_.empty(); }

  // Draws the text; `baseline` is the y of the line that letters stand on. OpenImageIO 2.4 garbles
  // what is not ASCII, so each such character becomes a question mark.
  void Draw(
      int x, int baseline, absl::string_view text, const TextStyle& style, Canvas* canvas) const;

  // Pixels from the text's left end to its right end.
  int Width(absl::string_view text, const TextStyle& style) const;

  // Lines of it, broken at spaces so that none is wider than `max_width` pixels.
  std::vector<std::string> Wrapped(absl::string_view text,
                                   int max_width,
                                   const TextStyle& style) const;

 private:
  const std::string& File(const TextStyle& style) const { return style.bold ? bold_ : regular_; }

  std::string regular_, bold_;
};

}  // namespace lightfit
