// optimizer/tracking/async_optimizer.h
//
// The optimizer on a thread of its own, for an engine's frame loop.
// In:   from the render thread, a read-back a frame: Lend(), fill, Submit(). Neither ever waits.
// Out:  Poll(): the newest matrices, stamped with the frame that they were computed from.
//
// Latest wins: while the optimizer is busy a newer frame takes the place of the one that waits, so
// that a slow optimizer skips frames and never runs behind. Buffers change owners; pixels are not
// copied. Lend, Submit and Poll lock nothing, and after the first few frames neither thread
// allocates anything, unless a light has no matrix: the message is allocated, by the optimizer.
// docs/engine.md has the frame loop, examples/frame_loop runs it.
//
// Threads: one thread submits, one (the same or another) polls, each with its own functions below;
// the optimizer is a third.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "geometry/camera.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/readback/readback.h"
#include "optimizer/tracking/tracker.h"

namespace lightfit {

// As FineCover, whose buffers these are.
struct FrameFineCover {
  int columns = 0, rows = 0;  // 0: there is none
  std::vector<float> nearest, furthest;
  std::vector<uint32_t> shadow_bits, lit_bits;
  uint32_t lit_lights = ~uint32_t{0};

  FineCover View() const;
};

// What the submitting thread fills in, all of it in every frame. The vectors keep their memory:
// resize() them to the read-back's size, which allocates only when it grows, then write; assign
// lights over those that are there.
struct FrameReadback {
  int64_t frame = 0;  // the caller's number; comes back with the matrices
  Camera camera;      // its width and height are the read-back's, pixels
  DepthKind depth_kind = DepthKind::kCameraZ;
  std::optional<float> background;    // as Readback::background
  std::vector<float> depth;           // as Readback::depth
  std::vector<uint32_t> shadow_bits;  // as Readback::shadow_bits
  std::vector<uint32_t> facing_bits;  // as Readback::facing_bits; empty: not known
  FrameFineCover fine_cover;          // as Readback::fine_cover
  // At most kMaxLights, known by their names, which must differ. One that is left out is forgotten.
  std::vector<Light> lights;
  MapSize map = {1024, 1024};  // texels, of every light's map

  // Refers to this object's buffers, and to `cover`, which it fills in. Null: without finer cover.
  Readback View(FineCover* cover = nullptr) const;
};

struct FrameLight {
  std::string name;
  absl::Status status;  // as Tracker::Update(); the rest is set when ok

  Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Identity();  // as LightMatrix::map_from_world
  MapSize map;                                                   // texels
  Border border = Border::kLit;  // of the map's sampler; it may change with the matrix
  double energy = 0.0;           // as LightMatrix::energy

  // What this frame did to the matrix. Frames that were never polled may have done more: to know
  // whether a map drawn earlier can stay, compare the matrix with the one that it was drawn with.
  TrackerAction action = TrackerAction::kFirst;
};

struct FrameMatrices {
  int64_t frame = 0;                          // FrameReadback::frame
  int num_lights = 0;                         // those of the frame, in its order
  std::array<FrameLight, kMaxLights> lights;  // the first num_lights are set

  // Null when that frame had no light of this name.
  const FrameLight* Find(absl::string_view name) const;
};

class AsyncOptimizer {
 public:
  // Starts the thread, which sleeps until the first frame. InvalidArgument as
  // ValidateTrackerOptions(); ResourceExhausted when no thread is to be had. Here and in
  // The destructor is what stops the work: StopScopes of the callers' threads do not reach it.
  static absl::StatusOr<AsyncOptimizer> Start(const TrackerOptions& options = {});

  AsyncOptimizer(AsyncOptimizer&&) noexcept;
  AsyncOptimizer& operator=(AsyncOptimizer&&) noexcept;

  // Stops the frame in work, if any, and ends the thread, which takes a fraction of a millisecond
  // or a few rows of pixels. That frame and what waits are dropped. Not while another thread is in
  // one of the functions below.
  ~AsyncOptimizer();

  // Submitting thread. The buffer to fill for the next Submit(), with what some earlier frame left
  // in it; the same one until Submit().
  FrameReadback& Lend();

  // Submitting thread. Hands the lent buffer to the optimizer. A read-back that cannot be used
  // comes back as the status of its lights.
  void Submit();

  // Submitting thread. For the frames from the next Submit() on; neither waits nor allocates when
  // they are valid. When not: InvalidArgument, and the options stay as they were.
  absl::Status SetOptions(const TrackerOptions& options);

  // Polling thread. The matrices of the newest frame that is done, or null when the last call had
  // them. They stay until a call returns others.
  const FrameMatrices* Poll();

  // Any thread. The rest of those submitted, at most two, are in work or waiting.
  struct Counts {
    int64_t submitted = 0;
    int64_t done = 0;     // matrices were made, polled or not
    int64_t skipped = 0;  // a newer one came before the optimizer was free
  };
  Counts counts() const;

 private:
  struct Shared;
  explicit AsyncOptimizer(std::unique_ptr<Shared> shared);

  std::unique_ptr<Shared> shared_;
};

}  // namespace lightfit
