// Matrices and plans that somebody else made.
#include "fuzz/input_form.h"
#include "fuzz/promises.h"
#include "io/given_maps.h"
#include "lightfit/v1/result.pb.h"

namespace lightfit::fuzz {

InputForm FormOfInput() { return {&v1::FitResult::default_instance(), Encoding::kJson}; }

}  // namespace lightfit::fuzz

namespace lightfit::fuzz {
namespace {

void PromiseMaps(const GivenMaps& maps) {
  Promise(!maps.plan.maps.empty() && maps.plan.maps.size() <= kMaxPlanMaps, "there are maps");
  Promise(maps.guard_texels >= 0.0, "a guard is a width");
  for (const PlanMap& map : maps.plan.maps) {
    Promise(map.map_from_world.allFinite(), "a matrix is finite");
    Promise(ValidateMapSize(map.size, maps.guard_texels).ok(), "the guard leaves some of a map");
  }
}

}  // namespace
}  // namespace lightfit::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightfit;  // NOLINT(google-build-using-namespace)
  const absl::string_view json(reinterpret_cast<const char*>(data), size);
  const absl::StatusOr<GivenSetUp> given = ParseGivenMaps("given", json, {256, 128});
  fuzz::PromiseOkOrError(given.status());
  if (!given.ok()) return 0;
  fuzz::Promise(given->for_every_light.has_value() || !given->by_light.empty(),
                "a file of matrices has one");
  if (given->for_every_light.has_value()) fuzz::PromiseMaps(*given->for_every_light);
  for (const auto& [light, maps] : given->by_light) fuzz::PromiseMaps(maps);
  // Those of the seeds.
  for (const Light& light : {Light::Directional("sun", {-0.9335726, -0.2373277, -0.2685473}),
                             Light::Point("key", {8.946166, -0.982908, 5.47775})}) {
    const absl::StatusOr<GivenMaps> maps = given->Of(light);
    fuzz::PromiseOkOrError(maps.status());
    if (maps.ok()) {
      fuzz::PromiseOkOrError(PlanLookUp::Create(maps->plan, light, maps->guard_texels).status());
    }
  }
  return 0;
}
