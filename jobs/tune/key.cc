#include <zlib.h>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/version.h"
#include "jobs/tune/tune.h"
#include "optimizer/fit.h"
#include "wire/camera_proto.h"
#include "wire/light_proto.h"
#include "wire/options_proto.h"
#include "wire/proto_json.h"

namespace lightfit {

namespace {

std::string JsonOrError(const google::protobuf::Message& message) {
  const absl::StatusOr<std::string> json = ProtoToJson(message);
  return json.ok() ? *json : json.status().ToString();
}

template <typename Element>
uLong AddBytes(uLong crc, const std::vector<Element>& elements) {
  constexpr size_t kMost = 1 << 20;
  for (size_t first = 0; first < elements.size(); first += kMost) {
    const size_t count = std::min(kMost, elements.size() - first);
    crc = crc32(crc,
                reinterpret_cast<const Bytef*>(elements.data() + first),
                static_cast<uInt>(count * sizeof(Element)));
  }
  return crc;
}

}  // namespace

std::string TuneKey(const CompareStage& stage,
                    absl::Span<const Light> lights,
                    const TuneOptions& options) {
  std::string text = absl::StrFormat("%s %d\n%dx%d %d %.17g %d %d\n%dx%d\n",
                                     kVersion,
                                     kFitRevision,
                                     options.map.width,
                                     options.map.height,
                                     static_cast<int>(options.bias),
                                     options.constant_share,
                                     options.seed,
                                     kTunePhases,
                                     stage.readback.width(),
                                     stage.readback.height());
  absl::StrAppend(&text, JsonOrError(CameraToProto(stage.screen.camera)));
  absl::StrAppend(&text, JsonOrError(FitOptionsToProto(options.fit)));
  for (const Light& light : lights) absl::StrAppend(&text, JsonOrError(LightToProto(light)));
  if (const Eigen::Vector3d& origin = stage.caster->scene().origin; !origin.isZero(0.0)) {
    absl::StrAppendFormat(&text, "%a %a %a", origin.x(), origin.y(), origin.z());
  }
  uLong crc = crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size()));
  crc = AddBytes(crc, stage.caster->scene().vertices);
  crc = AddBytes(crc, stage.caster->scene().triangles);
  return absl::StrFormat("%08x-%d-%d",
                         static_cast<uint32_t>(crc),
                         text.size(),
                         stage.caster->scene().triangles.size());
}

}  // namespace lightfit
