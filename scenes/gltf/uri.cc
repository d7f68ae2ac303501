#include "scenes/gltf/uri.h"

#include <algorithm>
#include <fstream>
#include <system_error>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"

namespace lightfit::gltf {

namespace {

std::string PercentDecoded(absl::string_view text) {
  std::string decoded;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && absl::ascii_isxdigit(text[i + 1]) &&
        absl::ascii_isxdigit(text[i + 2])) {
      decoded += absl::HexStringToBytes(text.substr(i + 1, 2));
      i += 2;
    } else {
      decoded += text[i];
    }
  }
  return decoded;
}

}  // namespace

absl::StatusOr<std::string> ReadWhole(const std::filesystem::path& path, int64_t max_bytes) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return absl::InvalidArgumentError("there is no such file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) return absl::InvalidArgumentError("it cannot be opened for reading");
  const auto size = static_cast<int64_t>(std::filesystem::file_size(path, error));
  std::string bytes(static_cast<size_t>(std::min(error ? 0 : size, max_bytes)), '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<size_t>(file.gcount()));
  return bytes;
}

absl::StatusOr<std::string> ReadUri(const std::string& folder,
                                    const std::string& uri,
                                    int64_t max_bytes) {
  const size_t colon = uri.find(':');
  if (absl::StartsWith(uri, "data:")) {
    const size_t comma = uri.find(',');
    if (comma == std::string::npos) return absl::InvalidArgumentError("its data URI has no data");
    const absl::string_view data = absl::string_view(uri).substr(comma + 1);
    if (!absl::EndsWith(absl::string_view(uri).substr(0, comma), ";base64")) {
      return PercentDecoded(data);
    }
    std::string bytes;
    if (!absl::Base64Unescape(data, &bytes)) {
      return absl::InvalidArgumentError("its data URI is no base64");
    }
    return bytes;
  }
  // A drive letter of Windows is one letter before the colon.
  if (colon != std::string::npos && colon > 1 && absl::StartsWith(uri.substr(colon), "://")) {
    return absl::InvalidArgumentError(
        absl::StrCat("is at ",
                     absl::CHexEscape(uri.substr(0, 80)),
                     ", want a file beside this one: fetch it and write its name"));
  }
  const std::filesystem::path decoded = std::filesystem::path(folder) / PercentDecoded(uri);
  std::error_code error;
  // Some exporters write names as they are.
  const std::filesystem::path plain = std::filesystem::path(folder) / uri;
  const std::filesystem::path& path =
      std::filesystem::exists(decoded, error) || !std::filesystem::exists(plain, error) ? decoded
                                                                                        : plain;
  absl::StatusOr<std::string> bytes = ReadWhole(path, max_bytes);
  if (!bytes.ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat("is in ", absl::CHexEscape(path.string()), ": ", bytes.status().message()));
  }
  return bytes;
}

}  // namespace lightfit::gltf
