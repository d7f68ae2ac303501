#include "render/ray_caster.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"

namespace lightfit {

namespace {

// Of the distance of coordinates from the origin: some roundings of a float.
constexpr double kRelativeResolution = 4e-6;

// Of the scene's diagonal: where rays from outside start, off the box around it.
constexpr double kBoxMargin = 1e-3;

// Sine between a ray and a plane below which their intersection has no digits.
constexpr double kLeastSlope = 1e-4;

// `start` is relative to the scene's origin.
RTCRay MakeRay(const Eigen::Vector3d& start, const Ray& ray, double near, double far) {
  RTCRay out;
  out.org_x = static_cast<float>(start.x());
  out.org_y = static_cast<float>(start.y());
  out.org_z = static_cast<float>(start.z());
  out.dir_x = static_cast<float>(ray.direction.x());
  out.dir_y = static_cast<float>(ray.direction.y());
  out.dir_z = static_cast<float>(ray.direction.z());
  out.tnear = static_cast<float>(near);
  out.tfar = static_cast<float>(far);
  out.time = 0.0f;
  out.mask = ~0u;
  out.id = 0;
  out.flags = 0;
  return out;
}

// How far the ray may go before it comes near the box; infinite when it never does. A light a
// thousand scenes away would otherwise lose in single precision what tells its hits apart.
double DistanceToBox(const Ray& ray, const Eigen::AlignedBox3d& box, double margin) {
  double enter = 0.0, leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box.min()[axis] - margin - ray.origin[axis];
    const double high = box.max()[axis] + margin - ray.origin[axis];
    const double direction = ray.direction[axis];
    if (direction == 0.0) {
      if (low > 0.0 || high < 0.0) return std::numeric_limits<double>::infinity();
      continue;
    }
    enter = std::max(enter, std::min(low / direction, high / direction));
    leave = std::min(leave, std::max(low / direction, high / direction));
  }
  return enter <= leave ? enter : std::numeric_limits<double>::infinity();
}

}  // namespace

struct RayCaster::State {
  Scene scene;
  Eigen::AlignedBox3d bounds;
  int num_threads = 1;
  int64_t num_dropped_triangles = 0;
  RTCDevice device = nullptr;
  RTCScene rtc_scene = nullptr;

  // What may be left out of a ray's start.
  double Skip(const Ray& ray) const {
    return DistanceToBox(ray, bounds, kBoxMargin * bounds.diagonal().norm());
  }

  ~State() {
    if (rtc_scene != nullptr) rtcReleaseScene(rtc_scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

RayCaster::RayCaster(std::unique_ptr<State> state) : state_(std::move(state)) {}
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;
RayCaster::~RayCaster() = default;

absl::StatusOr<RayCaster> RayCaster::Build(Scene scene, int num_threads) {
  auto state = std::make_unique<State>();
  state->scene = std::move(scene);
  state->num_threads = num_threads;
  state->num_dropped_triangles = DropBadTriangles(&state->scene);
  if (state->scene.triangles.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("scene: no triangle with an area (",
                     state->num_dropped_triangles,
                     " without one, or with coordinates that are not finite)"));
  }
  state->bounds = BoundsOf(state->scene);
  // One thread builds the tree, so that it, and which of two coincident triangles is hit, is the
  // same every time.
  state->device = rtcNewDevice("threads=1");
  if (state->device == nullptr) return absl::InternalError("scene: Embree does not start");
  state->rtc_scene = rtcNewScene(state->device);
  rtcSetSceneFlags(state->rtc_scene, RTC_SCENE_FLAG_ROBUST);
  const RTCGeometry geometry = rtcNewGeometry(state->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  // Embree reads 16 bytes at the last vertex, so it gets its own, padded copy.
  const std::vector<Eigen::Vector3f>& vertices = state->scene.vertices;
  auto* vertex_buffer = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices.size()));
  auto* index_buffer =
      static_cast<uint32_t*>(rtcSetNewGeometryBuffer(geometry,
                                                     RTC_BUFFER_TYPE_INDEX,
                                                     0,
                                                     RTC_FORMAT_UINT3,
                                                     3 * sizeof(uint32_t),
                                                     state->scene.triangles.size()));
  if (vertex_buffer == nullptr || index_buffer == nullptr) {
    rtcReleaseGeometry(geometry);
    return absl::ResourceExhaustedError(
        absl::StrCat("scene: no memory for ", state->scene.triangles.size(), " triangles"));
  }
  for (size_t i = 0; i < vertices.size(); ++i) {
    // Vertices that no triangle uses may be anything; Embree wants them finite.
    const Eigen::Vector3f vertex =
        vertices[i].allFinite() ? vertices[i] : Eigen::Vector3f(Eigen::Vector3f::Zero());
    std::memcpy(vertex_buffer + 3 * i, vertex.data(), 3 * sizeof(float));
  }
  for (size_t i = 0; i < state->scene.triangles.size(); ++i) {
    std::memcpy(index_buffer + 3 * i, state->scene.triangles[i].data(), 3 * sizeof(uint32_t));
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(state->rtc_scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(state->rtc_scene);
  if (const RTCError error = rtcGetDeviceError(state->device); error != RTC_ERROR_NONE) {
    return absl::InternalError(absl::StrCat("scene: Embree error ", static_cast<int>(error)));
  }
  return RayCaster(std::move(state));
}

Hit RayCaster::FirstHit(const Ray& ray, double near, double far) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  const double skipped = state_->Skip(ray);
  if (std::isinf(skipped) || !(far > std::max(near, skipped))) return {};
  const Eigen::Vector3d origin = ray.origin - state_->scene.origin;
  const Eigen::Vector3d start = origin + skipped * ray.direction;
  RTCRayHit query;
  query.ray = MakeRay(start, ray, std::max(near - skipped, 0.0), far - skipped);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.primID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(state_->rtc_scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  Hit hit;
  hit.triangle = static_cast<int>(query.hit.primID);
  hit.distance = skipped + query.ray.tfar;
  // A ray along the plane has no better distance than Embree's.
  const Eigen::Vector3d normal = Normal(hit.triangle);
  const double slope = normal.dot(ray.direction);
  if (std::abs(slope) > kLeastSlope) {
    const Eigen::Vector3d vertex =
        state_->scene.vertices[state_->scene.triangles[hit.triangle][0]].cast<double>();
    const double distance = normal.dot(vertex - origin) / slope;
    if (distance > 0.0) hit.distance = distance;
  }
  return hit;
}

bool RayCaster::IsBlocked(const Ray& ray, double near, double far) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  const double skipped = state_->Skip(ray);
  if (std::isinf(skipped) || !(far > std::max(near, skipped))) return false;
  const Eigen::Vector3d origin = ray.origin - state_->scene.origin;
  const Eigen::Vector3d start = origin + skipped * ray.direction;
  RTCRay query = MakeRay(start, ray, std::max(near - skipped, 0.0), far - skipped);
  rtcOccluded1(state_->rtc_scene, &context, &query);
  return query.tfar < 0.0f;  // Embree's word for a hit; it was not negative before
}

Eigen::Vector3d RayCaster::Normal(int triangle) const {
  const Eigen::Vector3i& corners = state_->scene.triangles[triangle];
  const Eigen::Vector3d a = state_->scene.vertices[corners[0]].cast<double>();
  const Eigen::Vector3d b = state_->scene.vertices[corners[1]].cast<double>();
  const Eigen::Vector3d c = state_->scene.vertices[corners[2]].cast<double>();
  return (b - a).cross(c - a).normalized();
}

const Scene& RayCaster::scene() const { return state_->scene; }
const Eigen::AlignedBox3d& RayCaster::bounds() const { return state_->bounds; }
int RayCaster::num_threads() const { return state_->num_threads; }
int64_t RayCaster::num_dropped_triangles() const { return state_->num_dropped_triangles; }

double RayCaster::Resolution(const Eigen::Vector3d& point) const {
  const double extent = state_->bounds.diagonal().norm();
  return kRelativeResolution *
         ((point - state_->scene.origin).cwiseAbs().maxCoeff() + 0.1 * extent);
}

}  // namespace lightfit
