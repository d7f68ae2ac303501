#include "render/generator/scene_generator.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "render/generator/dice.h"
#include "render/generator/room.h"
#include "render/generator/shapes.h"

namespace lightfit {

namespace {

constexpr int kMaxObjects = 100'000;
constexpr int64_t kMaxTriangles = 200'000'000;
constexpr int64_t kMinTrianglesPerObject = 100;
constexpr int64_t kMinTrianglesOfRoom = 20'000;

// Sizes are meant for a floor of this half size and scale with it.
constexpr double kStandardFloor = 20.0;

// Nothing stands where the viewer does.
const Eigen::Vector2d kViewer(0.0, 18.0);  // x, z
constexpr double kViewerRoom = 2.95;       // covers |x| < 1.5 for z > 15.5

// A shape in its own space, scaled, tilted and put in place.
struct Object {
  bool is_tube = false;
  Solid solid;
  Tube tube;
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  double tilt_turns = 0.0, yaw_turns = 0.0;
  double hover = 0.0;   // height of its lowest point above the floor; < 0: sunk into it
  double radius = 0.0;  // of a circle around it, seen from above
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  // x, z
  double share = 0.0;                               // of the triangles
};

Solid RandomSolid(int kind, Dice& dice) {
  using Outline = Solid::Outline;
  using Profile = Solid::Profile;
  Solid solid;
  solid.height = dice.Uniform(1.0, 3.0);
  switch (kind) {
    case 0:
      solid.height = 2.0;
      break;  // ball
    case 1:
      solid.outline = Outline::kSquare;
      solid.profile = Profile::kCylinder;
      break;
    case 2:
      solid.profile = Profile::kCylinder;
      break;
    case 3:
      solid.profile = Profile::kCone;
      break;
    case 4:
      solid.profile = Profile::kCapsule;
      solid.height += 1.5;
      break;
    case 5:
      solid.profile = Profile::kVase;
      solid.height += 0.5;
      break;
    case 6:  // pebble
      solid.bump = dice.Uniform(0.15, 0.35);
      for (double& phase : solid.bump_phase_turns) phase = dice.Uniform(0.0, 1.0);
      break;
    case 7:
      solid.outline = Outline::kSquare;
      solid.profile = Profile::kCone;
      break;
    case 8:  // tall column
      solid.outline = dice.Chance(0.5) ? Outline::kHexagon : Outline::kCircle;
      solid.profile = Profile::kCylinder;
      solid.height = dice.Uniform(6.0, 10.0);
      break;
    default:  // twisted star
      solid.outline = Outline::kStar;
      solid.profile = Profile::kCylinder;
      solid.height += 1.0;
      solid.twist_turns = dice.Uniform(-0.3, 0.3);
      break;
  }
  return solid;
}

constexpr int kNumSolids = 10;
constexpr int kNumKinds = kNumSolids + 3;

Object RandomObject(int kind, Dice& dice) {
  Object object;
  const double size = dice.Uniform(0.45, 1.5);
  object.scale.setConstant(size);
  object.yaw_turns = dice.Uniform(0.0, 1.0);
  object.is_tube = kind >= kNumSolids;
  if (object.is_tube) {
    constexpr int kKnots[][2] = {{2, 3}, {3, 2}, {2, 5}};
    if (kind > kNumSolids) {
      const auto& knot = kKnots[dice.Below(3)];
      object.tube = {knot[0], knot[1], dice.Uniform(0.35, 0.45), dice.Uniform(0.09, 0.15)};
    } else {
      object.tube.tube_radius = dice.Uniform(0.15, 0.4);
    }
    object.tilt_turns = dice.Chance(0.5) ? 0.25 : dice.Uniform(0.0, 0.25);  // standing or leaning
    object.radius = size * 1.6;
  } else {
    object.solid = RandomSolid(kind, dice);
    if (object.solid.height > 5.0) object.scale.setConstant(0.4 * size);
    // Boxes become slabs and walls.
    if (kind == 1) {
      object.scale.x() *= dice.Uniform(0.3, 1.5);
      object.scale.z() *= dice.Uniform(0.3, 1.5);
    }
    if (dice.Chance(0.15)) object.tilt_turns = dice.Uniform(0.02, 0.2);
    const double flat = std::max(object.scale.x(), object.scale.z());
    object.radius = object.tilt_turns > 0.0
                        ? std::max(flat, 0.6 * object.scale.y() * object.solid.height)
                        : flat;
  }
  const bool hovers = dice.Chance(0.2);
  object.hover = hovers ? dice.Uniform(0.1, 1.5) : -0.01 * size;
  object.share = dice.Uniform(0.5, 1.5);
  return object;
}

double HeightOf(const Object& object) {
  if (object.is_tube) return 3.0 * object.scale.y() + std::max(object.hover, 0.0);
  return object.solid.height * object.scale.y() + std::max(object.hover, 0.0);
}

// A place where it stands clear of the others, the viewer and the viewer's sight; the best of many
// on a crowded floor. It shrinks near the viewer rather than hide everything.
void Place(const std::vector<Object>& others, Dice& dice, Object* object) {
  constexpr int kTries = 60;
  constexpr double kReach = 0.92 * kStandardFloor;
  double best_room = 0.0;
  Object best;
  for (int i = 0; i < kTries; ++i) {
    Object trial = *object;
    trial.place.x() = dice.Uniform(-kReach, kReach);
    trial.place.y() = dice.Uniform(-kReach, kReach);
    const double distance = (trial.place - kViewer).norm();
    const double shrink = std::min(1.0, (0.5 + 0.25 * distance) / HeightOf(trial));
    trial.scale *= shrink;
    trial.radius *= shrink;
    trial.hover *= shrink;
    double room = distance - kViewerRoom - trial.radius;
    if (room < 0.0) room -= 1000.0;  // worse than any crowd
    for (const Object& other : others) {
      room = std::min(room, (trial.place - other.place).norm() - trial.radius - other.radius);
    }
    if (i == 0 || room > best_room) {
      best_room = room;
      best = trial;
    }
    if (room > 0.0) break;
  }
  *object = best;
}

// Tessellates the object and moves it to its place.
void AppendObject(const Object& object, int64_t num_triangles, double world_scale, Scene* scene) {
  const size_t first = scene->vertices.size();
  if (object.is_tube) {
    AppendTube(object.tube, num_triangles, scene);
  } else {
    AppendSolid(object.solid, num_triangles, scene);
  }
  const double ct = CosTurns(object.tilt_turns), st = SinTurns(object.tilt_turns);
  const double cy = CosTurns(object.yaw_turns), sy = SinTurns(object.yaw_turns);
  Eigen::Matrix3d tilt, yaw;
  tilt << 1, 0, 0, 0, ct, -st, 0, st, ct;
  yaw << cy, 0, sy, 0, 1, 0, -sy, 0, cy;
  const Eigen::Matrix3d turn = yaw * tilt * object.scale.asDiagonal();
  Eigen::AlignedBox3d bounds;
  std::vector<Eigen::Vector3d> turned;
  turned.reserve(scene->vertices.size() - first);
  for (size_t i = first; i < scene->vertices.size(); ++i) {
    turned.emplace_back(turn * scene->vertices[i].cast<double>());
    bounds.extend(turned.back());
  }
  const Eigen::Vector3d move(object.place.x() - bounds.center().x(),
                             object.hover - bounds.min().y(),
                             object.place.y() - bounds.center().z());
  for (size_t i = 0; i < turned.size(); ++i) {
    const Eigen::Vector3d point = world_scale * (turned[i] + move);
    scene->vertices[first + i] = point.cast<float>();
  }
}

void AppendFloor(double half_size, Scene* scene) {
  const auto h = static_cast<float>(half_size);
  const auto first = static_cast<int>(scene->vertices.size());
  for (const auto& [x, z] : {std::pair{-h, -h}, {-h, h}, {h, h}, {h, -h}}) {
    scene->vertices.emplace_back(x, 0.0F, z);
  }
  scene->triangles.emplace_back(first, first + 1, first + 2);
  scene->triangles.emplace_back(first, first + 2, first + 3);
}

absl::Status ValidateRoom(const SceneGeneratorOptions& options) {
  if (options.num_triangles >= kMinTrianglesOfRoom && options.num_triangles <= kMaxTriangles) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrFormat("scene: num_triangles = %d, want %d to %d",
                                                    options.num_triangles,
                                                    kMinTrianglesOfRoom,
                                                    kMaxTriangles));
}

absl::Status ValidateFloor(const SceneGeneratorOptions& options) {
  if (options.num_objects < 1 || options.num_objects > kMaxObjects) {
    return absl::InvalidArgumentError(
        absl::StrFormat("scene: num_objects = %d, want 1 to %d", options.num_objects, kMaxObjects));
  }
  const int64_t fewest = kMinTrianglesPerObject * options.num_objects;
  if (options.num_triangles < fewest || options.num_triangles > kMaxTriangles) {
    return absl::InvalidArgumentError(
        absl::StrFormat("scene: num_triangles = %d, want %d to %d: %d for each of %d objects",
                        options.num_triangles,
                        fewest,
                        kMaxTriangles,
                        kMinTrianglesPerObject,
                        options.num_objects));
  }
  if (!(options.floor_half_size >= 1e-3 && options.floor_half_size <= 1e6)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "scene: floor_half_size = %g, want 0.001 to 1000000 world units", options.floor_half_size));
  }
  return absl::OkStatus();
}

Scene ObjectsOnFloor(const SceneGeneratorOptions& options) {
  Dice dice(options.seed);
  std::vector<Object> objects;
  std::vector<int> kinds(kNumKinds);
  double total_share = 0.0;
  for (int i = 0; i < options.num_objects; ++i) {
    // Every kind once, in random order, before any comes again.
    const int turn = i % kNumKinds;
    if (turn == 0) {
      for (int kind = 0; kind < kNumKinds; ++kind) kinds[kind] = kind;
    }
    std::swap(kinds[turn], kinds[turn + dice.Below(kNumKinds - turn)]);
    Object object = RandomObject(kinds[turn], dice);
    Place(objects, dice, &object);
    total_share += object.share;
    objects.push_back(object);
  }
  Scene scene;
  AppendFloor(options.floor_half_size, &scene);
  for (const Object& object : objects) {
    // What earlier objects took too much or too little, the later ones make up for.
    const auto left =
        static_cast<double>(options.num_triangles - static_cast<int64_t>(scene.triangles.size()));
    const auto share = static_cast<int64_t>(std::llround(left * object.share / total_share));
    AppendObject(object, share, options.floor_half_size / kStandardFloor, &scene);
    total_share -= object.share;
  }
  return scene;
}

}  // namespace

absl::StatusOr<Scene> GenerateScene(const SceneGeneratorOptions& options) {
  const bool is_room = options.kind == SceneKind::kRoom;
  absl::Status status = is_room ? ValidateRoom(options) : ValidateFloor(options);
  if (!status.ok()) return status;
  return is_room ? MakeRoom(options.seed, options.num_triangles).scene : ObjectsOnFloor(options);
}

}  // namespace lightfit
