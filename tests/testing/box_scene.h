// tests/testing/box_scene.h
//
// Read-backs without a renderer: random boxes on a floor, ray cast analytically.
// In:   a seed, a camera, lights.
// Out:  a SyntheticReadback, which owns depth (camera z) and shadow bits, and views of it.
//
// The world is z up, in metres. The floor is the square |x|, |y| <= floor_half_size at z = 0;
// beyond it there is background. Boxes stand upright on it, turned about the vertical, and may
// overlap. The same seed gives the same scene, lights, camera and pixels on every machine and
// thread count.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/types/span.h"
#include "geometry/camera.h"
#include "geometry/light.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

struct Box {
  Eigen::Vector3d center;
  Eigen::Vector3d half_size;  // along the box's own axes
  double turn_rad = 0.0;      // about the vertical
};

struct BoxSceneOptions {
  int num_boxes = 20;
  double floor_half_size = 20.0;  // metres
  double min_size = 0.5;          // edges of the boxes, metres
  double max_size = 4.0;
};

struct BoxScene {
  double floor_half_size = 0.0;
  double max_height = 0.0;  // of the boxes
  std::vector<Box> boxes;
};

BoxScene MakeBoxScene(uint64_t seed, const BoxSceneOptions& options = {});

// What a camera sees of a scene.
struct SyntheticReadback {
  Camera camera;
  std::vector<float> depth;           // camera z, kSyntheticBackground where nothing is hit
  std::vector<uint32_t> shadow_bits;  // bit Light::shadow_bit: blocked, or facing away
  std::vector<uint32_t> facing_bits;  // likewise: facing the light

  // Refers to this object's buffers.
  Readback View() const;
  Readback ViewWithFacing() const;  // and with the third state
};

inline constexpr float kSyntheticBackground = 1e10f;

// One primary ray through each pixel centre, one occlusion ray per light from each surface, started
// kOcclusionOffset off it. `camera` must be valid; it may be orthographic.
SyntheticReadback Render(const BoxScene& scene,
                         const Camera& camera,
                         absl::Span<const Light> lights);

inline constexpr double kOcclusionOffset = 1e-5;  // metres

enum class RandomLightKind {
  kSun,        // directional, from anywhere on the hemisphere above
  kNearPoint,  // above the floor, a few metres over the highest box: never among its receivers
  kFarPoint    // 5 to 50 floor sizes away
};

Light RandomLight(const BoxScene& scene, uint64_t seed, RandomLightKind kind, int shadow_bit = 0);

// Suns, near and far points in turn, with shadow bits 0, 1, ... and names like "near4".
std::vector<Light> RandomLights(const BoxScene& scene, uint64_t seed, int num_lights);

// A perspective camera that stands on the floor, outside the boxes, at 1 to 8 metres, and looks
// across the scene.
Camera RandomCamera(const BoxScene& scene, uint64_t seed, int width, int height);

}  // namespace lightfit
