#include "base/output_file.h"

#include <unistd.h>

#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"

namespace lightfit {
namespace {

std::filesystem::path FolderOf(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  return folder.empty() ? "." : folder;
}

}  // namespace

absl::Status CheckWritable(absl::string_view flag, const std::string& path) {
  std::error_code error;
  const std::filesystem::path folder = FolderOf(path);
  if (path.empty()) return absl::InvalidArgumentError(absl::StrCat(flag, " is empty, want a file"));
  if (std::filesystem::is_directory(path, error)) {
    return absl::InvalidArgumentError(
        absl::StrCat(flag, " ", path, ": is a folder, want the name of a file"));
  }
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error)) {
    return absl::InvalidArgumentError(
        absl::StrCat(flag, " ", path, ": is a device or a pipe, want the name of a file"));
  }
  if (!std::filesystem::is_directory(folder, error)) {
    return absl::InvalidArgumentError(absl::StrCat(
        flag, " ", path, ": there is no folder ", folder.string(), "; create it first"));
  }
  // The file is replaced by a rename, so the folder's permission counts, not the old file's.
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    return absl::InvalidArgumentError(absl::StrCat(
        flag, " ", path, ": the folder ", folder.string(), " is not writable; choose another"));
  }
  return absl::OkStatus();
}

absl::Status MakeOutputFolder(absl::string_view flag, const std::string& path) {
  if (path.empty()) {
    return absl::InvalidArgumentError(absl::StrCat(flag, " is empty, want a folder"));
  }
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error || !std::filesystem::is_directory(path)) {
    return absl::InvalidArgumentError(
        absl::StrCat(flag,
                     " ",
                     path,
                     ": the folder cannot be made: ",
                     error ? error.message() : "there is a file of that name",
                     "; choose another"));
  }
  if (access(path.c_str(), W_OK | X_OK) != 0) {
    return absl::InvalidArgumentError(
        absl::StrCat(flag, " ", path, ": the folder is not writable; choose another"));
  }
  return absl::OkStatus();
}

}  // namespace lightfit
