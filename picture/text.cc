#include "picture/text.h"

#include <cairo-ft.h>
#include <fontconfig/fontconfig.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "base/table.h"
#include "wire/utf8.h"

namespace lightfit {
namespace {

constexpr const char* kFontFolders[] = {"/usr/share/fonts/truetype/dejavu/",    // Debian, Ubuntu
                                        "/usr/share/fonts/dejavu-sans-fonts/",  // Fedora, Rocky 9
                                        "/usr/share/fonts/dejavu/",             // Rocky 8
                                        "/usr/share/fonts/TTF/",                // Arch
                                        "/usr/local/share/fonts/",
                                        "/usr/share/fonts/truetype/liberation/",
                                        "/usr/share/fonts/liberation-sans/"};
constexpr std::pair<const char*, const char*> kFontFiles[] = {
    {"DejaVuSans.ttf", "DejaVuSans-Bold.ttf"},
    {"LiberationSans-Regular.ttf", "LiberationSans-Bold.ttf"}};

bool IsFile(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

constexpr uint32_t kNoCharacters = 0xfdd0;  // the first of 32
constexpr uint32_t kDelete = 0x7f;

// Whether Cairo would give up drawing at the character, or has nothing to draw.
bool IsUndrawable(uint32_t character) {
  return character < 0x20 || character == kDelete || (character & 0xfffe) == 0xfffe ||
         (character >= kNoCharacters && character < kNoCharacters + 32);
}

// What Cairo draws without an error.
std::string DrawableText(absl::string_view text) {
  const std::string utf8 = Utf8Text(text);
  std::string drawable;
  for (size_t begin = 0, end = 0; begin < utf8.size(); begin = end) {
    const auto first = static_cast<unsigned char>(utf8[begin]);
    // The first byte ends with 7, 5, 4 or 3 bits of the character, every further one with 6.
    uint32_t character = first < 0x80 ? first : first & (first < 0xe0 ? 0x1f : 0x0f);
    if (first >= 0xf0) character &= 0x07;
    for (end = begin + 1; end < utf8.size() && (utf8[end] & 0xc0) == 0x80; ++end) {
      character = character << 6 | (utf8[end] & 0x3f);
    }
    if (IsUndrawable(character)) {
      drawable.push_back('?');
    } else {
      drawable.append(utf8, begin, end - begin);
    }
  }
  return drawable;
}

}  // namespace

Typeface::Face Typeface::FaceFrom(const std::string& path) {
  if (!IsFile(path)) return nullptr;
  const std::unique_ptr<FcPattern, decltype(&FcPatternDestroy)> pattern(FcPatternCreate(),
                                                                        &FcPatternDestroy);
  FcPatternAddString(pattern.get(), FC_FILE, reinterpret_cast<const FcChar8*>(path.c_str()));
  Typeface typeface;
  typeface.regular_.reset(cairo_ft_font_face_create_for_pattern(pattern.get()),
                          &cairo_font_face_destroy);
  // Only a font at some size tells whether the file is one.
  const bool is_font = cairo_scaled_font_status(typeface.Scaled({}).get()) == CAIRO_STATUS_SUCCESS;
  return is_font ? typeface.regular_ : nullptr;
}

Typeface Typeface::Find() {
  Typeface typeface;
  // Read once, from main's thread, before any other is started.
  const char* chosen = std::getenv("LIGHTFIT_FONT");  // NOLINT(concurrency-mt-unsafe)
  if (chosen != nullptr) typeface.regular_ = typeface.bold_ = FaceFrom(chosen);
  for (const auto& [regular, bold] : kFontFiles) {
    for (const char* folder : kFontFolders) {
      if (typeface.found()) return typeface;
      typeface.regular_ = FaceFrom(absl::StrCat(folder, regular));
      typeface.bold_ = FaceFrom(absl::StrCat(folder, bold));
      if (typeface.bold_ == nullptr) typeface.bold_ = typeface.regular_;
    }
  }
  return typeface;
}

std::shared_ptr<cairo_scaled_font_t> Typeface::Scaled(const TextStyle& style) const {
  cairo_matrix_t size, identity;
  cairo_matrix_init_scale(&size, style.size_px, style.size_px);
  cairo_matrix_init_identity(&identity);
  const std::unique_ptr<cairo_font_options_t, decltype(&cairo_font_options_destroy)> options(
      cairo_font_options_create(), &cairo_font_options_destroy);
  // All that a user's settings could change otherwise. Cairo puts glyphs on whole pixels, so whole
  // widths keep the gaps between them even.
  cairo_font_options_set_antialias(options.get(), CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_SLIGHT);
  cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_ON);
  cairo_font_face_t* const face = style.bold ? bold_.get() : regular_.get();
  return {cairo_scaled_font_create(face, &size, &identity, options.get()),
          &cairo_scaled_font_destroy};
}

int Typeface::Width(absl::string_view text, const TextStyle& style) const {
  if (!found()) return 0;
  cairo_text_extents_t extents = {};
  cairo_scaled_font_text_extents(Scaled(style).get(), DrawableText(text).c_str(), &extents);
  return static_cast<int>(std::ceil(extents.x_advance));
}

std::string Typeface::Fitted(absl::string_view text, int max_width, const TextStyle& style) const {
  if (Width(text, style) <= max_width) return std::string(text);
  size_t fits = 0, most = text.size();
  while (fits < most) {
    const size_t middle = most - (most - fits) / 2;
    if (Width(Shortened(text, middle), style) <= max_width) {
      fits = middle;
    } else {
      most = middle - 1;
    }
  }
  return Shortened(text, fits);
}

std::vector<std::string> Typeface::Wrapped(absl::string_view text,
                                           int max_width,
                                           const TextStyle& style) const {
  std::vector<std::string> lines(1);
  for (const absl::string_view word : absl::StrSplit(text, ' ')) {
    const std::string longer =
        lines.back().empty() ? std::string(word) : absl::StrCat(lines.back(), " ", word);
    if (!lines.back().empty() && Width(longer, style) > max_width) {
      lines.emplace_back(word);
    } else {
      lines.back() = longer;
    }
  }
  return lines;
}

void Typeface::Draw(
    int x, int baseline, absl::string_view text, const TextStyle& style, Canvas* canvas) const {
  if (!found() || text.empty()) return;
  if (style.anchor == Anchor::kMiddle) x -= Width(text, style) / 2;
  if (style.anchor == Anchor::kRight) x -= Width(text, style);
  cairo_t* const context = canvas->context();
  cairo_set_scaled_font(context, Scaled(style).get());
  cairo_set_source_rgb(context, style.color.r, style.color.g, style.color.b);
  cairo_move_to(context, x, baseline);
  cairo_show_text(context, DrawableText(text).c_str());
  cairo_new_path(context);
}

}  // namespace lightfit
