// tests/testing/frame_loop.h
//
// A short walk through a box scene, and what a frame loop does with it, for tests and benchmarks.
#pragma once

#include <chrono>
#include <cstdint>
#include <thread>
#include <utility>
#include <vector>

#include "absl/types/span.h"
#include "optimizer/tracking/async_optimizer.h"
#include "tests/testing/box_scene.h"

namespace lightfit::testing {

// Read-backs of a camera that moves a little sideways from one to the next.
struct BoxWalk {
  std::vector<Light> lights;
  std::vector<SyntheticReadback> views;

  BoxWalk(uint64_t seed, int num_lights, int num_views, int width, int height) {
    constexpr double kStep = 0.05;  // metres
    const BoxScene scene = MakeBoxScene(seed);
    lights = RandomLights(scene, seed, num_lights);
    Camera camera = RandomCamera(scene, seed, width, height);
    for (int i = 0; i < num_views; ++i) {
      views.push_back(Render(scene, camera, lights));
      camera.camera_from_world(0, 3) += kStep;
    }
  }
};

// What a render thread does: everything is written over what an earlier frame left.
inline void Fill(const SyntheticReadback& view,
                 absl::Span<const Light> lights,
                 int64_t frame,
                 FrameReadback* readback) {
  readback->frame = frame;
  readback->camera = view.camera;
  readback->depth_kind = DepthKind::kCameraZ;
  readback->depth.assign(view.depth.begin(), view.depth.end());
  readback->shadow_bits.assign(view.shadow_bits.begin(), view.shadow_bits.end());
  readback->facing_bits.clear();
  readback->lights.assign(lights.begin(), lights.end());
  readback->map = {1024, 1024};
}

// The same view with more pixels.
inline void FillFineCover(const SyntheticReadback& fine, FrameReadback* readback) {
  FrameFineCover& cover = readback->fine_cover;
  cover.columns = fine.camera.width;
  cover.rows = fine.camera.height;
  cover.nearest.assign(fine.depth.begin(), fine.depth.end());
  cover.furthest.assign(fine.depth.begin(), fine.depth.end());
  cover.shadow_bits.assign(fine.shadow_bits.begin(), fine.shadow_bits.end());
}

// Ends the program when it cannot start.
inline AsyncOptimizer StartOptimizer(const TrackerOptions& options = {}) {
  return std::move(AsyncOptimizer::Start(options).value());
}

// Until every frame is done or skipped. Here and below: of an AsyncOptimizer or AsyncPlanner.
template <typename Optimizer>
void WaitUntilIdle(const Optimizer& optimizer) {
  while (true) {
    const AsyncOptimizer::Counts counts = optimizer.counts();
    if (counts.done + counts.skipped == counts.submitted) return;
    std::this_thread::sleep_for(std::chrono::microseconds(20));
  }
}

// After WaitUntilIdle(): the matrices of the last frame. They are counted an instant before they
// can be polled.
template <typename Optimizer>
const auto& PollLast(Optimizer& optimizer, int64_t frame) {
  while (true) {
    const auto* matrices = optimizer.Poll();
    if (matrices != nullptr && matrices->frame == frame) return *matrices;
    std::this_thread::yield();
  }
}

}  // namespace lightfit::testing
