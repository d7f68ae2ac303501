// Scenes in Wavefront's format.
#include "fuzz/promise_scene.h"
#include "scenes/obj_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightfit;  // NOLINT(google-build-using-namespace)
  fuzz::PromiseScene(ParseObj({reinterpret_cast<const char*>(data), size}));
  return 0;
}
