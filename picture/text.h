// picture/text.h
//
// Text on a Canvas, in the DejaVu or Liberation typeface of the system.
// In:   words of any origin, such as names of lights: UTF-8, or bytes that are made so.
// Out:  drawn text and its width. A character that the typeface lacks becomes a box.
//
// The typeface is opened by its file: neither fontconfig's settings nor its cache play a part, so
// that a picture is the same for every user of a machine, and on a bare one.
#pragma once

#include <cairo.h>

#include <memory>
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
  // distributions put DejaVu Sans and Liberation Sans. A file that is no font is passed over.
  static Typeface Find();

  bool found() const { return regular_ != nullptr; }

  // Draws the text; `baseline` is the y of the line that letters stand on. What is not UTF-8 and
  // what is no character, such as a line break, becomes a question mark.
  void Draw(
      int x, int baseline, absl::string_view text, const TextStyle& style, Canvas* canvas) const;

  // Pixels from the text's left end to its right end.
  int Width(absl::string_view text, const TextStyle& style) const;

  // The text, or its beginning and end with "..." between where it would be wider than `max_width`
  // pixels. Eight characters stay at least.
  std::string Fitted(absl::string_view text, int max_width, const TextStyle& style) const;

  // Lines of it, broken at spaces so that none is wider than `max_width` pixels.
  std::vector<std::string> Wrapped(absl::string_view text,
                                   int max_width,
                                   const TextStyle& style) const;

 private:
  // Shared by copies, as Cairo counts references too.
  using Face = std::shared_ptr<cairo_font_face_t>;

  // Nothing where the file is no font.
  static Face FaceFrom(const std::string& path);

  // The face at the style's size.
  std::shared_ptr<cairo_scaled_font_t> Scaled(const TextStyle& style) const;

  Face regular_, bold_;
};

}  // namespace lightfit
