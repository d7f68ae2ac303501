// fuzz/memory_file.h
//
// Bytes under a path, without a disk: for readers that want a file.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <string>

#include "absl/strings/str_cat.h"
#include "fuzz/promises.h"

namespace lightfit::fuzz {

class MemoryFile {
 public:
  MemoryFile(const uint8_t* data, size_t size) : file_(memfd_create("fuzz", MFD_CLOEXEC)) {
    Promise(file_ >= 0 && write(file_, data, size) == static_cast<ssize_t>(size),
            "there is room for a small file in memory");
  }
  ~MemoryFile() { close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const { return absl::StrCat("/proc/self/fd/", file_); }

 private:
  int file_;
};

}  // namespace lightfit::fuzz
