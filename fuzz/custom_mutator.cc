// How libFuzzer changes inputs that hold a message: mostly field by field, as damaged bytes seldom
// get beyond the first length or checksum. Linked into fuzzers alone.
#include <algorithm>
#include <cstdint>
#include <random>
#include <string>

#include "fuzz/input_form.h"
#include "fuzz/mutate_message.h"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);

namespace lightfit::fuzz {
namespace {

void MutateWithLibFuzzer(std::string* bytes) {
  const size_t size = bytes->size();
  constexpr size_t kMoreBytes = 16;
  bytes->resize(size + kMoreBytes);
  bytes->resize(LLVMFuzzerMutate(reinterpret_cast<uint8_t*>(bytes->data()), size, bytes->size()));
}

}  // namespace
}  // namespace lightfit::fuzz

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data,
                                          size_t size,
                                          size_t max_size,
                                          unsigned int seed) {
  using namespace lightfit::fuzz;  // NOLINT(google-build-using-namespace)
  std::mt19937 random(seed);
  constexpr uint32_t kBytesAlone = 8;  // one of so many
  if (random() % kBytesAlone == 0) return LLVMFuzzerMutate(data, size, max_size);
  const InputForm form = FormOfInput();
  const auto message = MessageOfInput(form, {reinterpret_cast<const char*>(data), size});
  if (message == nullptr) return LLVMFuzzerMutate(data, size, max_size);
  for (uint32_t changes = 1 + random() % 3; changes > 0; --changes) {
    MutateMessage(message.get(), MutateWithLibFuzzer, &random);
  }
  const std::string bytes = InputOfMessage(form, *message);
  if (bytes.empty() || bytes.size() > max_size) return LLVMFuzzerMutate(data, size, max_size);
  std::copy(bytes.begin(), bytes.end(), data);
  return bytes.size();
}
