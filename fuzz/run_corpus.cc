// Runs a target once on every file of a folder: its corpus as a test, with any compiler. An input
// that takes memory out of proportion to its size fails.
//   fuzz_corpus_fit fuzz/corpus/fit        or one file, such as what a fuzzer found
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#include "fuzz/peak_memory.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace {

// What a parser may have at once: working memory that does not depend on the input, OpenEXR's
// buffers for each thread above all, and so much for each byte. The corpus takes 1.3 MB at most.
constexpr int64_t kFreeBytes = int64_t{4} << 20;
constexpr int64_t kMostForByte = 256;

std::vector<std::filesystem::path> FilesOf(const std::filesystem::path& path) {
  if (std::filesystem::is_regular_file(path)) return {path};
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(path, error)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: " << argv[0] << " FOLDER|FILE\n";
    return 2;
  }
  const std::vector<std::filesystem::path> files = FilesOf(argv[1]);
  int64_t most = 0;
  int num_out_of_proportion = 0;
  for (const std::filesystem::path& path : files) {
    std::ifstream file(path, std::ios::binary);
    const std::vector<char> bytes(std::istreambuf_iterator<char>(file), {});
    std::cout << path.filename().string() << ", " << bytes.size() << " bytes" << std::endl;
    lightfit::fuzz::StartPeak();
    LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
    const int64_t peak = lightfit::fuzz::PeakBytes();
    most = std::max(most, peak);
    if (peak > kFreeBytes + kMostForByte * static_cast<int64_t>(bytes.size())) {
      std::cerr << path.filename().string() << ": takes " << peak << " bytes of memory, out of "
                << "proportion to its " << bytes.size() << "\n";
      ++num_out_of_proportion;
    }
  }
  std::cout << files.size() << " inputs of " << argv[1] << ", at most " << most
            << " bytes of memory\n";
  return files.empty() || num_out_of_proportion > 0 ? 1 : 0;
}
