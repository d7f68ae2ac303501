// glTF scenes: their triangles, lights and cameras.
//
// The input is the JSON, a zero byte and the binary chunk, so that the lengths of a GLB file's
// chunks are right however the JSON changes; or a GLB file as it is.
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "fuzz/promise_scene.h"
#include "scenes/gltf/document.h"
#include "scenes/gltf/lights.h"
#include "scenes/gltf/meshes.h"
#include "scenes/gltf/nodes.h"

namespace lightfit::fuzz {
namespace {

std::string GlbOf(absl::string_view input) {
  if (absl::StartsWith(input, "glTF")) return std::string(input);
  const size_t zero = input.find('\0');
  const absl::string_view json = input.substr(0, zero);
  const absl::string_view chunk =
      zero == absl::string_view::npos ? absl::string_view() : input.substr(zero + 1);
  std::string glb = "glTF";
  const auto append = [&glb](size_t word) {
    for (int i = 0; i < 4; ++i) glb.push_back(static_cast<char>(word >> 8 * i & 0xFF));
  };
  append(2);
  append(28 + json.size() + chunk.size());
  append(json.size());
  absl::StrAppend(&glb, "JSON", json);
  append(chunk.size());
  absl::StrAppend(&glb, absl::string_view("BIN\0", 4), chunk);
  return glb;
}

void Run(absl::string_view input) {
  absl::StatusOr<gltf::Document> document = gltf::Document::Parse(GlbOf(input), "/nowhere");
  PromiseOkOrError(document.status());
  if (!document.ok()) return;
  const absl::StatusOr<gltf::Nodes> nodes = gltf::ReadNodes(*document);
  PromiseOkOrError(nodes.status());
  if (!nodes.ok()) return;
  const absl::StatusOr<std::vector<Light>> lights = gltf::ReadLights(*document, *nodes);
  PromiseOkOrError(lights.status());
  if (lights.ok()) {
    for (const Light& light : *lights) {
      Promise(ValidateLight(light).ok() && !light.name.empty(), "lights that are read can be used");
    }
  }
  PromiseOkOrError(gltf::ReadCameras(*document, *nodes).status());
  absl::StatusOr<gltf::Shown> shown = gltf::ReadMeshes(&*document, *nodes);
  if (!shown.ok()) return PromiseOkOrError(shown.status());
  PromiseScene(MakeScene(shown->vertices, std::move(shown->triangles)));
}

}  // namespace
}  // namespace lightfit::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  lightfit::fuzz::Run({reinterpret_cast<const char*>(data), size});
  return 0;
}
