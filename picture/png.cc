#include "picture/png.h"

#include <new>

#include "absl/strings/str_format.h"
#include "base/text_file.h"

namespace lightfit {
namespace {

// Cairo calls it from C: no exception may pass.
cairo_status_t Append(void* bytes, const unsigned char* data, unsigned int length) {
  try {
    static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  } catch (const std::bad_alloc&) {
    return CAIRO_STATUS_NO_MEMORY;
  }
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

absl::StatusOr<std::string> PngBytes(const Canvas& canvas) {
  std::string bytes;
  // What went wrong while drawing comes first: it explains the rest.
  cairo_status_t status = cairo_status(canvas.context());
  if (status == CAIRO_STATUS_SUCCESS) {
    status = cairo_surface_write_to_png_stream(canvas.surface(), Append, &bytes);
  }
  if (status == CAIRO_STATUS_SUCCESS) return bytes;
  return absl::InvalidArgumentError(
      absl::StrFormat("picture of %d x %d pixels cannot be drawn: %s; want fewer lights or a "
                      "smaller image (at most %d pixels along each side)",
                      canvas.width(),
                      canvas.height(),
                      cairo_status_to_string(status),
                      kMaxCanvasSide));
}

absl::Status WritePng(const Canvas& canvas, const std::string& path) {
  const absl::StatusOr<std::string> bytes = PngBytes(canvas);
  if (!bytes.ok()) return InFile(path, bytes.status());
  return WriteTextFileAtomically(path, *bytes);
}

}  // namespace lightfit
