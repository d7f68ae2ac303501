#include "picture/text.h"

#include <OpenImageIO/imagebufalgo.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

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

std::string AsciiOnly(absl::string_view utf8) {
  std::string ascii;
  for (const char c : utf8) {
    const bool continues = (c & 0xc0) == 0x80;
    if (!continues) ascii.push_back((c & 0x80) != 0 ? '?' : c);
  }
  return ascii;
}

}  // namespace

Typeface Typeface::Find() {
  Typeface typeface;
  // Read once, from main's thread, before any other is started.
  const char* chosen = std::getenv("LIGHTFIT_FONT");  // NOLINT(concurrency-mt-unsafe)
  if (chosen != nullptr && IsFile(chosen)) {
    typeface.regular_ = typeface.bold_ = chosen;
    return typeface;
  }
  for (const auto& [regular, bold] : kFontFiles) {
    for (const char* folder : kFontFolders) {
      const std::string regular_path = absl::StrCat(folder, regular);
      if (!IsFile(regular_path)) continue;
      const std::string bold_path = absl::StrCat(folder, bold);
      typeface.regular_ = regular_path;
      typeface.bold_ = IsFile(bold_path) ? bold_path : regular_path;
      return typeface;
    }
  }
  return typeface;
}

int Typeface::Width(absl::string_view text, const TextStyle& style) const {
  if (!found() || text.empty()) return 0;
  const OIIO::ROI box = OIIO::ImageBufAlgo::text_size(AsciiOnly(text), style.size_px, File(style));
  return box.defined() ? box.xend : 0;
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
  static_assert(sizeof(Rgb) == 3 * sizeof(float), "the canvas is handed over as packed floats");
  OIIO::ImageBuf image(OIIO::ImageSpec(canvas->width(), canvas->height(), 3, OIIO::TypeDesc::FLOAT),
                       canvas->pixels().data());
  const float color[] = {style.color.r, style.color.g, style.color.b};
  OIIO::ImageBufAlgo::render_text(
      image, x, baseline, AsciiOnly(text), style.size_px, File(style), color);
}

}  // namespace lightfit
