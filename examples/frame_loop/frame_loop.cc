// The frame loop of an engine whose shadow maps lightfit sets up: a camera walks past the shadows
// of a sun and a lamp. The engine is lightfit's own ray caster; docs/engine.md says what differs
// with a GPU. Prints what became of the matrices, every tenth frame.
#include <cstdio>
#include <map>
#include <string>

#include "geometry/clip.h"
#include "optimizer/tracking/async_optimizer.h"
#include "render/generator/scene_generator.h"
#include "render/readback_image.h"

int main() {  // NOLINT(bugprone-exception-escape): scene and cameras are good ones
  const lightfit::RayCaster engine =
      lightfit::RayCaster::Build(*lightfit::GenerateScene({.num_triangles = 50'000})).value();
  const std::vector<lightfit::Light> lights = {
      lightfit::Light::Directional("sun", {-0.6, -1, -0.4}, /*shadow_bit=*/0),
      lightfit::Light::Point("lamp", {3, 12, 0}, /*shadow_bit=*/1)};
  std::map<std::string, Eigen::Matrix4d> clip_from_world;  // by light: draws and reads its map

  // Once. 0: the tightest map in every frame. 1: texels stand still for as long as they can.
  auto optimizer = lightfit::AsyncOptimizer::Start(lightfit::TrackerOptions::ForStability(0.5));
  const lightfit::FrameMatrices* newest = nullptr;
  for (int frame = 0; optimizer.ok() && frame < 60; ++frame) {
    const lightfit::Camera camera =
        *lightfit::LookAtCamera({0.05 * frame, 1.7, 18}, {0, 0.5, 0}, {0, 1, 0}, 1.0, 180, 180);
    const lightfit::ReadbackImage image = lightfit::RenderReadback(engine, camera, lights).value();

    // Hand over the read-back, with the frame and the camera that it was rendered with.
    lightfit::FrameReadback& readback = optimizer->Lend();
    readback.frame = frame;
    readback.camera = camera;  // lightfit::MakeCamera() makes one of view and projection
    readback.depth.assign(image.depth.begin(), image.depth.end());
    readback.shadow_bits.assign(image.shadow_bits.begin(), image.shadow_bits.end());
    readback.lights = lights;  // may change from frame to frame; a light is known by its name
    readback.map = {1024, 1024};
    optimizer->Submit();

    // Take the newest matrices, if there are any that were not here before. They stay until then.
    const lightfit::FrameMatrices* polled = optimizer->Poll();
    if (polled != nullptr) newest = polled;
    for (int i = 0; newest != nullptr && i < newest->num_lights; ++i) {
      const lightfit::FrameLight& light = newest->lights[i];
      if (light.status.ok()) {
        clip_from_world[light.name] =
            ClipFromMap(light.map, lightfit::ClipConvention::Vulkan()) * light.map_from_world;
      }  // else go on with the matrix before, or with one of the engine's; the message says why
      if (frame % 10 != 9) continue;
      std::printf("frame %d draws %s with the matrix of frame %d: %s\n",
                  frame,
                  light.name.c_str(),
                  static_cast<int>(newest->frame),
                  light.status.ok() ? lightfit::TrackerActionName(light.action)
                                    : light.status.ToString().c_str());
    }
    // Here the engine draws the shadow maps with clip_from_world, then the picture.
  }
  std::fprintf(stderr, "%s", optimizer.ok() ? "" : optimizer.status().ToString().c_str());
  return optimizer.ok() ? 0 : 1;
}
