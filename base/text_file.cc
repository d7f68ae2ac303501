#include "base/text_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/text_encoding.h"

namespace lightfit {

namespace {

constexpr int kMaxNameAttempts = 100;

std::string ErrnoText(int error_number) {
  return std::error_code(error_number, std::generic_category()).message();
}

bool WriteAll(int file, absl::string_view text) {
  while (!text.empty()) {
    const ssize_t written = write(file, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    text.remove_prefix(static_cast<size_t>(written));
  }
  return true;
}

}  // namespace

absl::StatusOr<std::string> ReadFileBytes(const std::string& path, int64_t max_bytes) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  }
  if (std::filesystem::is_directory(path, error)) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": is a folder, want a file"));
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) return absl::PermissionDeniedError(absl::StrCat(path, ": cannot be opened"));
  // Read in pieces instead of asking for the size, so that pipes work too.
  std::string text;
  char piece[1 << 16];
  while (file.read(piece, sizeof(piece)) || file.gcount() > 0) {
    text.append(piece, static_cast<size_t>(file.gcount()));
    if (static_cast<int64_t>(text.size()) > max_bytes) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%s: is longer than the limit of %d bytes", path, max_bytes));
    }
  }
  if (file.bad()) return absl::DataLossError(absl::StrCat(path, ": cannot be read to its end"));
  return text;
}

absl::StatusOr<std::string> ReadTextFile(const std::string& path, int64_t max_bytes) {
  absl::StatusOr<std::string> bytes = ReadFileBytes(path, max_bytes);
  if (!bytes.ok()) return bytes;
  absl::StatusOr<std::string> text = DecodeText(*std::move(bytes));
  if (!text.ok()) return InFile(path, text.status());
  return text;
}

absl::Status WriteTextFileAtomically(const std::string& path, absl::string_view text) {
  // The name differs between processes and threads; O_EXCL settles what is left (farms share
  // disks).
  static std::atomic<unsigned> counter{0};
  std::string temporary;
  int file = -1;
  for (int attempt = 0; attempt < kMaxNameAttempts && file < 0; ++attempt) {
    temporary = absl::StrCat(path, ".", getpid(), "-", counter++, ".tmp");
    file = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file < 0 && errno != EEXIST) break;
  }
  if (file < 0) {
    return absl::PermissionDeniedError(
        absl::StrCat(path, ": cannot be written: ", ErrnoText(errno)));
  }
  int error = WriteAll(file, text) && fsync(file) == 0 ? 0 : errno;
  if (close(file) != 0 && error == 0) error = errno;
  if (error == 0 && rename(temporary.c_str(), path.c_str()) != 0) error = errno;
  if (error == 0) return absl::OkStatus();
  unlink(temporary.c_str());
  return absl::InternalError(absl::StrCat(path, ": cannot be written: ", ErrnoText(error)));
}

absl::Status InFile(const std::string& path, const absl::Status& status) {
  if (status.ok()) return status;
  return absl::Status(status.code(), absl::StrCat(path, ": ", status.message()));
}

}  // namespace lightfit
