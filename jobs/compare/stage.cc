#include "jobs/compare/stage.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <utility>

#include "geometry/affine_depth.h"
#include "geometry/sized_camera.h"
#include "methods/dominant_plane.h"
#include "optimizer/figures/footprint_image.h"
#include "optimizer/readback/surfaces.h"
#include "render/readback_image.h"
#include "render/true_lighting.h"

namespace lightfit {
namespace {

// The clip planes lie a little off the nearest and furthest surface, so that a view of one plane
// face to face has some depth.
constexpr double kClipPlaneGap = 1e-3;

void SetClipPlanes(double nearest_z, double furthest_z, Camera* camera) {
  camera->near = nearest_z * (1.0 - kClipPlaneGap);
  camera->far = furthest_z * (1.0 + kClipPlaneGap);
}

// Visible surfaces, as the dominant plane is found from them.
struct VisibleSurfaces {
  std::vector<Eigen::Vector3d> positions, normals;

  void Add(const Eigen::Vector3d& position, const Eigen::Vector3d& normal) {
    positions.push_back(position);
    normals.push_back(normal);
  }
};

void SetPlane(const VisibleSurfaces& surfaces, MethodInput* view) {
  view->plane = DominantPlane(surfaces.positions, surfaces.normals);
}

VisibleSurfaces SurfacesOf(const SurfaceImage& image) {
  VisibleSurfaces surfaces;
  for (const SurfacePoint& pixel : image.pixels) {
    if (pixel.is_surface()) surfaces.Add(pixel.position, pixel.normal);
  }
  return surfaces;
}

// Positions and normals where the surface continues to all four neighbours.
VisibleSurfaces SurfacesOf(const Readback& readback) {
  const SampleOptions options;
  const AffineDepth affine_depth = AffineDepthOf(readback);
  const Eigen::Matrix4d world_from_screen = readback.camera.WorldFromScreen();
  const Eigen::Matrix4d screen_from_world = readback.camera.ScreenFromWorld();
  VisibleSurfaces surfaces;
  for (int y = 1; y + 1 < readback.height(); ++y) {
    for (int x = 1; x + 1 < readback.width(); ++x) {
      DepthGradient gradient;
      if (!DepthGradientAt(readback, affine_depth, options, x, y, &gradient)) continue;
      const Eigen::Vector4d screen(x + 0.5, y + 0.5, gradient.d, 1.0);
      surfaces.Add((world_from_screen * screen).hnormalized(),
                   SurfaceNormal(screen_from_world, readback.camera.orthographic, x, y, gradient));
    }
  }
  return surfaces;
}

}  // namespace

absl::StatusOr<CompareStage> MakeStage(const RayCaster& caster,
                                       const Camera& screen,
                                       int readback_width,
                                       int readback_height) {
  CompareStage stage;
  stage.caster = &caster;
  absl::StatusOr<SurfaceImage> image = RenderSurfaces(caster, screen);
  if (!image.ok()) return image.status();
  stage.screen = *std::move(image);

  const Camera readback_camera = ResizedCamera(screen, readback_width, readback_height);
  image = RenderSurfaces(caster, readback_camera);
  if (!image.ok()) return image.status();
  stage.readback_surfaces = *std::move(image);
  if (stage.screen.num_surface == 0 || stage.readback_surfaces.num_surface == 0) {
    return absl::InvalidArgumentError("camera: sees no surface; turn it towards the scene");
  }
  for (const SurfacePoint& pixel : stage.readback_surfaces.pixels) {
    stage.readback_depth.push_back(pixel.is_surface() ? static_cast<float>(pixel.camera_z)
                                                      : kReadbackBackground);
  }
  stage.readback.camera = readback_camera;
  stage.readback.depth = stage.readback_depth;
  stage.readback.background = std::numeric_limits<float>::infinity();  // kReadbackBackground is

  double nearest = std::numeric_limits<double>::infinity(), furthest = 0.0;
  for (const SurfaceImage* seen : {&stage.screen, &stage.readback_surfaces}) {
    for (const SurfacePoint& pixel : seen->pixels) {
      if (!pixel.is_surface()) continue;
      nearest = std::min(nearest, pixel.camera_z);
      furthest = std::max(furthest, pixel.camera_z);
    }
  }
  stage.view.camera = screen;
  SetClipPlanes(nearest, furthest, &stage.view.camera);
  stage.view.receivers = caster.bounds();
  SetPlane(SurfacesOf(stage.readback_surfaces), &stage.view);
  return stage;
}

absl::StatusOr<CompareStage> MakeStage(const Readback& readback) {
  if (absl::Status status = ValidateReadback(readback); !status.ok()) return status;
  const absl::StatusOr<std::vector<Eigen::Vector3d>> receivers = ReceiverPositions(readback);
  if (!receivers.ok()) return receivers.status();
  CompareStage stage;
  stage.readback = readback;
  stage.view.camera = readback.camera;
  double nearest = std::numeric_limits<double>::infinity(), furthest = 0.0;
  for (const Eigen::Vector3d& position : *receivers) {
    const double z = (readback.camera.camera_from_world * position.homogeneous()).z();
    nearest = std::min(nearest, z);
    furthest = std::max(furthest, z);
    stage.view.receivers.extend(position);
  }
  SetClipPlanes(nearest, furthest, &stage.view.camera);
  SetPlane(SurfacesOf(readback), &stage.view);
  stage.surfaces =
      std::make_shared<const absl::StatusOr<Surfaces>>(FindSurfaces(readback, ~0u, {}));
  return stage;
}

LitStage Lit(const CompareStage& stage, const Light& light) {
  LitStage lit;
  lit.stage = &stage;
  lit.light = light;
  lit.readback = stage.readback;
  lit.surfaces = stage.surfaces;
  if (!stage.has_truth()) return lit;
  lit.light.shadow_bit = 0;
  for (const Lighting lighting : TrueLighting(*stage.caster, stage.readback_surfaces, light)) {
    const bool is_shadowed = lighting == Lighting::kShadowed;
    lit.shadow_bits.push_back(is_shadowed ? 1 : 0);
    lit.facing_bits.push_back(is_shadowed || lighting == Lighting::kLit ? 1 : 0);
  }
  lit.readback.depth = stage.readback_depth;
  lit.readback.shadow_bits = lit.shadow_bits;
  lit.readback.facing_bits = lit.facing_bits;
  lit.readback.facing_lights = 1u;
  lit.surfaces =
      std::make_shared<const absl::StatusOr<Surfaces>>(FindSurfaces(lit.readback, 1u, {}));
  return lit;
}

}  // namespace lightfit
