// jobs/compare/stage.h
//
// What a comparison of methods knows before any light is looked at.
// In:   a RayCaster and the camera of the image to judge; or a read-back alone.
// Out:  CompareStage: surfaces, depth, and what the published set-ups go by; LitStage.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "methods/method.h"
#include "optimizer/readback/readback.h"
#include "optimizer/readback/surfaces.h"
#include "render/ray_caster.h"
#include "render/surface_image.h"

namespace lightfit {

// What does not depend on the light: computed once.
struct CompareStage {
  // What is judged. Null and empty when only a read-back is known: then there is no truth.
  const RayCaster* caster = nullptr;
  SurfaceImage screen;

  // What is fitted from. With a caster its shadow bits are rendered for each light, and its depth
  // is that of `readback_surfaces`.
  Readback readback;
  SurfaceImage readback_surfaces;
  std::vector<float> readback_depth;

  // For the published set-ups; light and map are left open. The camera's clip planes enclose what
  // it sees.
  MethodInput view;

  // Without a caster: of the read-back, for all its lights. Never null then.
  std::shared_ptr<const absl::StatusOr<Surfaces>> surfaces;

  bool has_truth() const { return caster != nullptr; }
};

// `screen` is the camera of the image to judge; the read-back shows the same at another size. The
// caster must outlive the stage. InvalidArgument when the camera sees nothing.
absl::StatusOr<CompareStage> MakeStage(const RayCaster& caster,
                                       const Camera& screen,
                                       int readback_width,
                                       int readback_height);

// The buffers of `readback` must outlive the stage.
absl::StatusOr<CompareStage> MakeStage(const Readback& readback);

// A stage under one light. Refers to the stage.
struct LitStage {
  const CompareStage* stage = nullptr;
  Light light;                        // with a caster its shadow bit is 0, whatever it was
  std::vector<uint32_t> shadow_bits;  // with a caster: of the read-back
  std::vector<uint32_t> facing_bits;  // likewise
  Readback readback;
  std::shared_ptr<const absl::StatusOr<Surfaces>> surfaces;  // of `readback`; never null
};

// With a caster the read-back's shadow is cast, and its surfaces found.
LitStage Lit(const CompareStage& stage, const Light& light);

}  // namespace lightfit
