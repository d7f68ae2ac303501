// Matrices that somebody else made.
#include "fuzz/input_form.h"
#include "fuzz/promises.h"
#include "io/given_matrices.h"
#include "lightfit/v1/result.pb.h"

namespace lightfit::fuzz {

InputForm FormOfInput() { return {&v1::FitResult::default_instance(), Encoding::kJson}; }

}  // namespace lightfit::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightfit;  // NOLINT(google-build-using-namespace)
  const absl::string_view json(reinterpret_cast<const char*>(data), size);
  const absl::StatusOr<GivenMatrices> given = ParseGivenMatrices("given", json, {256, 128});
  fuzz::PromiseOkOrError(given.status());
  if (!given.ok()) return 0;
  fuzz::Promise(given->for_every_light.has_value() || !given->by_light.empty(),
                "a file of matrices has one");
  if (given->for_every_light.has_value()) {
    fuzz::Promise(given->for_every_light->map_from_world.allFinite(), "a matrix is finite");
  }
  for (const auto& [light, matrix] : given->by_light) {
    fuzz::Promise(matrix.map_from_world.allFinite(), "a matrix is finite");
  }
  fuzz::PromiseOkOrError(given->Of("sun").status());
  return 0;
}
