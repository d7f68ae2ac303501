// Scenes in Stanford's polygon format, the only scenes that no foreign library reads.
#include "fuzz/promises.h"
#include "scenes/ply_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightfit;  // NOLINT(google-build-using-namespace)
  absl::StatusOr<Scene> scene = ParsePly({reinterpret_cast<const char*>(data), size});
  fuzz::PromiseOkOrError(scene.status());
  if (!scene.ok()) return 0;
  DropBadTriangles(&*scene);
  for (const Eigen::Vector3i& triangle : scene->triangles) {
    fuzz::Promise(
        triangle.minCoeff() >= 0 && triangle.maxCoeff() < static_cast<int>(scene->vertices.size()),
        "the corners of good triangles are there");
  }
  fuzz::Promise(scene->triangles.empty() || BoundsOf(*scene).sizes().allFinite(),
                "good triangles have finite corners");
  return 0;
}
