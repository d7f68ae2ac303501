#include "io/exr_input.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/text_file.h"
#include "io/exr_header.h"
#include "wire/utf8.h"

namespace lightfit::internal {

namespace {

// A file with more parts than this is no read-back.
constexpr int kMaxParts = 1024;

constexpr size_t kMaxListedNames = 40;

absl::Status CheckPart(const std::string& path,
                       int part,
                       const OIIO::ImageSpec& spec,
                       int64_t max_pixels) {
  if (spec.deep) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: part %d is deep, want a flat image: render or flatten the depth", path, part));
  }
  const struct {
    const char* name;
    int64_t width, height;
  } windows[] = {{"display window", spec.full_width, spec.full_height},
                 {"data window", spec.width, spec.height}};
  for (const auto& window : windows) {
    if (window.width < 1 || window.height < 1) {
      return absl::InvalidArgumentError(absl::StrFormat("%s: %s = %dx%d, want at least 1x1 pixels",
                                                        path,
                                                        window.name,
                                                        window.width,
                                                        window.height));
    }
    if (window.width * window.height > max_pixels) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%s: %s = %dx%d, more than the limit of %d pixels (max_pixels): render "
                          "the read-back smaller or raise the limit",
                          path,
                          window.name,
                          window.width,
                          window.height,
                          max_pixels));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<ExrInput> ExrInput::Open(const std::string& path, int64_t max_pixels) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  }
  if (std::filesystem::is_directory(path, error)) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": is a folder, want an EXR file"));
  }
  // OpenImageIO reports through geterror(), but OpenEXR underneath throws.
  try {
    // Only the OpenEXR reader is tried, so a file of another kind meets no other parser.
    ExrInput exr(path, OIIO::ImageInput::create("openexr"));
    if (exr.input_ == nullptr) {
      return absl::InternalError(
          absl::StrCat("OpenImageIO without OpenEXR: ", OIIO::geterror(), ": install its plug-in"));
    }
    OIIO::ImageSpec spec;
    if (!exr.input_->valid_file(path)) {
      return absl::InvalidArgumentError(absl::StrCat(path, ": is not an OpenEXR file"));
    }
    if (absl::Status status = InFile(path, CheckExrHeader(path)); !status.ok()) return status;
    if (!exr.input_->open(path, spec)) {
      return absl::InvalidArgumentError(
          absl::StrCat(path, ": cannot be read as OpenEXR: ", Utf8Text(exr.input_->geterror())));
    }
    for (int part = 0; part < kMaxParts && exr.input_->seek_subimage(part, 0); ++part) {
      exr.parts_.push_back(exr.input_->spec());
      if (absl::Status status = CheckPart(path, part, exr.parts_.back(), max_pixels);
          !status.ok()) {
        return status;
      }
    }
    exr.input_->geterror();  // the end of the parts is not an error
    if (exr.parts_.empty()) {
      return absl::InvalidArgumentError(absl::StrCat(path, ": has no image"));
    }
    return exr;
  } catch (const std::exception& e) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": cannot be read as OpenEXR: ", Utf8Text(e.what())));
  }
}

std::string ExrInput::quoted_name(ChannelId id) const {
  return absl::StrCat("\"", Utf8Text(name(id)), "\"");
}

bool ExrInput::is_uint(ChannelId id) const {
  return parts_[id.part].channelformat(id.channel) == OIIO::TypeDesc::UINT32;
}

std::optional<ChannelId> ExrInput::Find(absl::string_view name, int preferred_part) const {
  const auto find_in = [&](int part) -> std::optional<ChannelId> {
    const std::vector<std::string>& names = parts_[part].channelnames;
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) return std::nullopt;
    return ChannelId{part, static_cast<int>(found - names.begin())};
  };
  if (std::optional<ChannelId> id = find_in(preferred_part)) return id;
  for (int part = 0; part < num_parts(); ++part) {
    if (std::optional<ChannelId> id = find_in(part)) return id;
  }
  return std::nullopt;
}

std::optional<Eigen::Matrix4d> ExrInput::MatrixAttribute(int part, const std::string& name) const {
  // Case-sensitive: OpenImageIO calls V-Ray's cameraTransform, a camera-to-world matrix,
  // "worldtocamera".
  const OIIO::ParamValue* attribute =
      parts_[part].find_attribute(name, OIIO::TypeDesc::UNKNOWN, /*casesensitive=*/true);
  if (attribute == nullptr) return std::nullopt;
  const float* single = static_cast<const float*>(attribute->data());
  const double* wide = static_cast<const double*>(attribute->data());
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) {
    if (attribute->type() == OIIO::TypeDesc::TypeMatrix44) {
      matrix(i / 4, i % 4) = single[i];
    } else if (attribute->type() ==
               OIIO::TypeDesc(OIIO::TypeDesc::DOUBLE, OIIO::TypeDesc::MATRIX44)) {
      matrix(i / 4, i % 4) = wide[i];
    } else {
      return std::nullopt;
    }
  }
  return matrix;
}

template <typename T>
absl::StatusOr<std::vector<T>> ExrInput::Read(ChannelId id, OIIO::TypeDesc type, T outside) {
  const OIIO::ImageSpec& spec = parts_[id.part];
  try {
    std::vector<T> data(static_cast<size_t>(spec.width) * spec.height);
    if (!input_->read_image(id.part, 0, id.channel, id.channel + 1, type, data.data())) {
      return absl::DataLossError(absl::StrFormat("%s: channel %s cannot be read: %s",
                                                 path_,
                                                 quoted_name(id),
                                                 Utf8Text(input_->geterror())));
    }
    if (spec.x == spec.full_x && spec.y == spec.full_y && spec.width == spec.full_width &&
        spec.height == spec.full_height) {
      return data;
    }
    // Copy the rectangle that both windows share.
    std::vector<T> display(static_cast<size_t>(spec.full_width) * spec.full_height, outside);
    const int64_t x_begin = std::max<int64_t>(spec.x, spec.full_x);
    const int64_t y_begin = std::max<int64_t>(spec.y, spec.full_y);
    const int64_t x_end =
        std::min(int64_t{spec.x} + spec.width, int64_t{spec.full_x} + spec.full_width);
    const int64_t y_end =
        std::min(int64_t{spec.y} + spec.height, int64_t{spec.full_y} + spec.full_height);
    for (int64_t y = y_begin; y < y_end && x_begin < x_end; ++y) {
      const auto row = data.begin() + (y - spec.y) * spec.width;
      std::copy(row + (x_begin - spec.x),
                row + (x_end - spec.x),
                display.begin() + (y - spec.full_y) * spec.full_width + (x_begin - spec.full_x));
    }
    return display;
  } catch (const std::exception& e) {
    return absl::DataLossError(absl::StrFormat(
        "%s: channel %s cannot be read: %s", path_, quoted_name(id), Utf8Text(e.what())));
  }
}

absl::StatusOr<std::vector<float>> ExrInput::ReadFloat(ChannelId id, float outside) {
  if (is_uint(id)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s: channel %s is UINT, want half or float", path_, quoted_name(id)));
  }
  return Read<float>(id, OIIO::TypeDesc::FLOAT, outside);
}

absl::StatusOr<std::vector<uint32_t>> ExrInput::ReadUint(ChannelId id) {
  if (!is_uint(id)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: channel %s is half or float, want UINT: a float holds no more than 24 bits",
        path_,
        quoted_name(id)));
  }
  return Read<uint32_t>(id, OIIO::TypeDesc::UINT32, 0);
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
