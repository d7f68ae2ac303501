#include "io/exr_input.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTestFile.h>
#include <OpenEXR/ImfTiledInputPart.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "base/text_file.h"
#include "io/exr_claims.h"
#include "io/exr_header.h"
#include "io/exr_threads.h"
#include "wire/utf8.h"

namespace lightfit::internal {

namespace {

using Window = Imath::Box2i;

constexpr size_t kMaxListedNames = 40;

constexpr size_t kMaxViews = 16;

// A display window of so many pixels, 2K, needs no reason; beyond that it may have as many for each
// byte of the file. Little of a frame may be rendered, or nothing.
constexpr int64_t kFreeDisplayPixels = int64_t{4} << 20;
constexpr int64_t kMostPixelsOfByte = 4096;

int64_t WidthOf(const Window& window) { return int64_t{window.max.x} - window.min.x + 1; }
int64_t HeightOf(const Window& window) { return int64_t{window.max.y} - window.min.y + 1; }

absl::Status CheckWindow(const char* name, const Window& window, int64_t max_pixels) {
  const int64_t width = WidthOf(window), height = HeightOf(window);
  if (width < 1 || height < 1) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s = %dx%d, want at least 1x1 pixels", name, width, height));
  }
  if (width * height > max_pixels) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s = %dx%d, more than the limit of %d pixels (max_pixels): render the "
                        "read-back smaller or raise the limit",
                        name,
                        width,
                        height,
                        max_pixels));
  }
  return absl::OkStatus();
}

absl::Status CheckPart(int part,
                       const Imf::Header& header,
                       int64_t max_pixels,
                       int64_t file_bytes) {
  if (Imf::isDeepData(header.type())) {
    return absl::InvalidArgumentError(
        absl::StrFormat("part %d is deep, want a flat image: render or flatten the depth", part));
  }
  const int64_t most = std::max(kFreeDisplayPixels, kMostPixelsOfByte * file_bytes);
  absl::Status status =
      CheckWindow("display window", header.displayWindow(), std::min(max_pixels, most));
  if (status.ok()) status = CheckWindow("data window", header.dataWindow(), max_pixels);
  return status;
}

// What OpenEXR says, in UTF-8, without the path.
std::string WordsOf(const std::exception& error, const std::string& path) {
  absl::string_view words = error.what();
  absl::ConsumePrefix(&words, absl::StrCat("Cannot read image file \"", path, "\". "));
  return Utf8Text(words);
}

// Of all channels.
int64_t PixelBytesOf(const Imf::Header& header) {
  const Window& window = header.dataWindow();
  int64_t bytes = 0;
  const Imf::ChannelList& channels = header.channels();
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    const Imf::Channel& is = channel.channel();
    const int64_t samples = (WidthOf(window) / std::max(1, is.xSampling)) *
                            (HeightOf(window) / std::max(1, is.ySampling));
    bytes += samples * (is.type == Imf::HALF ? 2 : 4);
  }
  return bytes;
}

template <typename T>
constexpr Imf::PixelType kPixelType = Imf::FLOAT;
template <>
constexpr Imf::PixelType kPixelType<uint32_t> = Imf::UINT;

std::vector<std::string> ViewsOf(const Imf::Header& header) {
  std::vector<std::string> views;
  if (header.hasView()) {
    views = {header.view()};
  } else if (Imf::hasMultiView(header)) {
    views = Imf::multiView(header);
  }
  views.erase(std::remove(views.begin(), views.end(), ""), views.end());
  return views;
}

// The channel over the data window.
template <typename T>
std::vector<T> ReadData(Imf::MultiPartInputFile& file, int part, const std::string& channel) {
  const Imf::Header& header = file.header(part);
  const Window& window = header.dataWindow();
  std::vector<T> data(WidthOf(window) * HeightOf(window));
  Imf::FrameBuffer pixels;
  pixels.insert(channel, Imf::Slice::Make(kPixelType<T>, data.data(), window));
  if (Imf::isTiled(header.type())) {
    Imf::TiledInputPart input(file, part);
    input.setFrameBuffer(pixels);
    input.readTiles(0, input.numXTiles() - 1, 0, input.numYTiles() - 1);
  } else {
    Imf::InputPart input(file, part);
    input.setFrameBuffer(pixels);
    input.readPixels(window.min.y, window.max.y);
  }
  return data;
}

// Copies the rectangle that both windows share.
template <typename T>
std::vector<T> OnDisplay(const std::vector<T>& data,
                         const Window& data_window,
                         const Window& display_window,
                         T outside) {
  const int64_t data_width = WidthOf(data_window), width = WidthOf(display_window);
  std::vector<T> display(width * HeightOf(display_window), outside);
  const int64_t x_begin = std::max(data_window.min.x, display_window.min.x);
  const int64_t y_begin = std::max(data_window.min.y, display_window.min.y);
  const int64_t x_end = int64_t{std::min(data_window.max.x, display_window.max.x)} + 1;
  const int64_t y_end = int64_t{std::min(data_window.max.y, display_window.max.y)} + 1;
  for (int64_t y = y_begin; y < y_end && x_begin < x_end; ++y) {
    const auto row = data.begin() + (y - data_window.min.y) * data_width;
    std::copy(
        row + (x_begin - data_window.min.x),
        row + (x_end - data_window.min.x),
        display.begin() + (y - display_window.min.y) * width + (x_begin - display_window.min.x));
  }
  return display;
}

}  // namespace

// Two layers of streams below the file, which refers to them.
struct ExrInput::Source {
  explicit Source(const std::string& path)
      : bytes(path, std::ios::binary), stream(bytes, path.c_str()) {}

  std::ifstream bytes;
  int64_t num_bytes = 0;
  Imf::StdIFStream stream;
  std::optional<Imf::MultiPartInputFile> file;
};

ExrInput::ExrInput(std::string path)
    : path_(std::move(path)), source_(std::make_unique<Source>(path_)) {}
ExrInput::~ExrInput() = default;
ExrInput::ExrInput(ExrInput&& other) noexcept = default;
ExrInput& ExrInput::operator=(ExrInput&& other) noexcept = default;

absl::StatusOr<ExrInput> ExrInput::Open(const std::string& path, int64_t max_pixels) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  }
  if (std::filesystem::is_directory(path, error)) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": is a folder, want an EXR file"));
  }
  try {
    ExrInput exr(path);
    Source& source = *exr.source_;
    if (!source.bytes) return absl::PermissionDeniedError(absl::StrCat(path, ": cannot be opened"));
    source.bytes.seekg(0, std::ios::end);
    source.num_bytes = source.bytes.tellg();
    source.bytes.seekg(0);
    if (!Imf::isOpenExrFile(source.stream)) {
      return absl::InvalidArgumentError(absl::StrCat(path, ": is not an OpenEXR file"));
    }
    if (absl::Status status = InFile(path, CheckExrHeader(source.bytes)); !status.ok()) {
      return status;
    }
    StartExrThreads();
    source.file.emplace(source.stream);
    for (int i = 0; i < source.file->parts(); ++i) {
      const Imf::Header& header = source.file->header(i);
      const absl::Status status = InFile(path, CheckPart(i, header, max_pixels, source.num_bytes));
      if (!status.ok()) return status;
      Part& part = exr.parts_.emplace_back();
      if (header.hasName()) part.name = header.name();
      part.views = ViewsOf(header);
      if (part.views.size() > kMaxViews) {
        return absl::InvalidArgumentError(absl::StrFormat(
            "%s: part %d has %d views, want at most %d", path, i, part.views.size(), kMaxViews));
      }
      const Imf::ChannelList& channels = header.channels();
      for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        part.channels.emplace_back(channel.name());
        part.is_uint.push_back(channel.channel().type == Imf::UINT);
      }
    }
    return exr;
  } catch (const std::exception& e) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": cannot be read as OpenEXR: ", WordsOf(e, path)));
  }
}

int ExrInput::width(int part) const {
  return static_cast<int>(WidthOf(source_->file->header(part).displayWindow()));
}

int ExrInput::height(int part) const {
  return static_cast<int>(HeightOf(source_->file->header(part).displayWindow()));
}

std::string ExrInput::quoted_name(ChannelId id) const {
  const std::string quoted = absl::StrCat("\"", Utf8Text(name(id)), "\"");
  return num_parts() == 1 ? quoted : absl::StrCat(quoted, " of ", quoted_part(id.part));
}

std::string ExrInput::quoted_part(int part) const {
  if (part_name(part).empty()) return absl::StrCat("part ", part);
  return absl::StrCat("part \"", Utf8Text(part_name(part)), "\"");
}

double ExrInput::pixel_aspect(int part) const {
  return source_->file->header(part).pixelAspectRatio();
}

std::optional<std::string> ExrInput::StringAttribute(int part, const std::string& name) const {
  const Imf::Header& header = source_->file->header(part);
  const auto* found = header.findTypedAttribute<Imf::StringAttribute>(name);
  if (found == nullptr) return std::nullopt;
  return found->value();
}

std::optional<Eigen::Matrix4d> ExrInput::MatrixAttribute(int part, const std::string& name) const {
  const Imf::Header& header = source_->file->header(part);
  Imath::M44d stored;
  if (const auto* wide = header.findTypedAttribute<Imf::M44dAttribute>(name)) {
    stored = wide->value();
  } else if (const auto* single = header.findTypedAttribute<Imf::M44fAttribute>(name)) {
    stored = Imath::M44d(single->value());
  } else {
    return std::nullopt;
  }
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = stored[i / 4][i % 4];
  return matrix;
}

std::vector<std::string> ExrInput::MatrixNames(int part) const {
  std::vector<std::string> names;
  const Imf::Header& header = source_->file->header(part);
  for (auto attribute = header.begin(); attribute != header.end(); ++attribute) {
    if (MatrixAttribute(part, attribute.name())) names.emplace_back(attribute.name());
  }
  return names;
}

template <typename T>
absl::StatusOr<std::vector<T>> ExrInput::Read(ChannelId id, T outside) {
  try {
    Imf::MultiPartInputFile& file = *source_->file;
    const Imf::Header& header = file.header(id.part);
    const Imf::Channel& channel = header.channels()[name(id)];
    if (channel.xSampling != 1 || channel.ySampling != 1) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "%s: channel %s has one value for %dx%d pixels, want one for each: render or convert it "
          "without subsampling",
          path_,
          quoted_name(id),
          channel.xSampling,
          channel.ySampling));
    }
    const Window& data_window = header.dataWindow();
    const Window& display_window = header.displayWindow();
    const int64_t most = MostPixelBytes(header.compression(), source_->num_bytes);
    if (const int64_t pixel_bytes = PixelBytesOf(header); pixel_bytes > most) {
      return absl::DataLossError(absl::StrFormat(
          "%s: channel %s cannot be read: its part has %d bytes of pixels, of which a file of %d "
          "bytes holds %d at most: the file is damaged or cut short",
          path_,
          quoted_name(id),
          pixel_bytes,
          source_->num_bytes,
          most));
    }
    std::vector<T> data = ReadData<T>(file, id.part, name(id));
    if (data_window == display_window) return data;
    return OnDisplay(data, data_window, display_window, outside);
  } catch (const std::exception& e) {
    return absl::DataLossError(absl::StrFormat(
        "%s: channel %s cannot be read: %s", path_, quoted_name(id), WordsOf(e, path_)));
  }
}

absl::StatusOr<std::vector<float>> ExrInput::ReadFloat(ChannelId id, float outside) {
  if (is_uint(id)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s: channel %s is UINT, want half or float", path_, quoted_name(id)));
  }
  return Read<float>(id, outside);
}

absl::StatusOr<std::vector<uint32_t>> ExrInput::ReadUint(ChannelId id) {
  if (!is_uint(id)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: channel %s is half or float, want UINT: a float holds no more than 24 bits",
        path_,
        quoted_name(id)));
  }
  return Read<uint32_t>(id, 0);
}

std::string QuotedList(const std::vector<std::string>& names) {
  if (names.empty()) return "none";
  std::string list;
  for (size_t i = 0; i < std::min(names.size(), kMaxListedNames); ++i) {
    absl::StrAppend(&list, i == 0 ? "" : ", ", "\"", Utf8Text(names[i]), "\"");
  }
  if (names.size() > kMaxListedNames) {
    absl::StrAppend(&list, " and ", names.size() - kMaxListedNames, " more");
  }
  return list;
}

}  // namespace lightfit::internal
