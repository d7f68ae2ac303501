// Scenes in Stanford's polygon format.
#include "fuzz/promise_scene.h"
#include "scenes/ply_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightfit;  // NOLINT(google-build-using-namespace)
  fuzz::PromiseScene(ParsePly({reinterpret_cast<const char*>(data), size}));
  return 0;
}
