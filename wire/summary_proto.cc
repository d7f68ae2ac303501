#include "wire/summary_proto.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "geometry/ray_hull.h"
#include "wire/frame_identity_proto.h"
#include "wire/light_proto.h"
#include "wire/matrix_proto.h"
#include "wire/options_proto.h"
#include "wire/result_json.h"

namespace lightfit {

namespace {

using google::protobuf::RepeatedField;
using google::protobuf::RepeatedPtrField;

constexpr int kTensorEntries = 36;
constexpr int kMaxHullRays = 4096;
constexpr int kMaxParts = 40;                    // no sum of doubles has more
constexpr double kMaxPart = 1e100;               // far from overflow, in sums and in their products
constexpr int64_t kMaxCount = int64_t{1} << 53;  // of frames and pixels; a thousand such still add
constexpr double kUnitTolerance = 1e-12;         // of a ray's length: a few roundings

absl::Status Refuse(const std::string& field, absl::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat(field, " ", what));
}

absl::Status CheckCount(const std::string& field, int64_t count, int64_t min) {
  if (count >= min && count <= kMaxCount) return absl::OkStatus();
  return Refuse(field, absl::StrFormat("= %d, want %d ... %d", count, min, kMaxCount));
}

v1::ExactSum ExactSumToProto(const ExactSum& sum) {
  v1::ExactSum proto;
  for (const double part : sum.Parts()) proto.add_parts(part);
  return proto;
}

absl::Status ReadExactSum(const v1::ExactSum& proto, const std::string& field, ExactSum* sum) {
  if (proto.parts_size() > kMaxParts) {
    return Refuse(field,
                  absl::StrFormat("has %d parts, want at most %d", proto.parts_size(), kMaxParts));
  }
  for (const double part : proto.parts()) {
    // Written so that NaN fails.
    if (!(std::abs(part) <= kMaxPart)) {
      return Refuse(field, absl::StrFormat("has a part of %g, want at most %g", part, kMaxPart));
    }
    sum->Add(part);
  }
  const std::vector<double> parts = sum->Parts();
  if (!std::equal(parts.begin(), parts.end(), proto.parts().begin(), proto.parts().end())) {
    return Refuse(field, "is not written as exact sums are, each part the nearest to what is left");
  }
  return absl::OkStatus();
}

// As many sums as `sums` has room for.
template <size_t kCount>
absl::Status ReadExactSums(const RepeatedPtrField<v1::ExactSum>& protos,
                           const std::string& field,
                           std::array<ExactSum, kCount>* sums) {
  if (protos.size() != static_cast<int>(kCount)) {
    return Refuse(field, absl::StrFormat("has %d sums, want %d", protos.size(), kCount));
  }
  for (size_t i = 0; i < kCount; ++i) {
    absl::Status status =
        ReadExactSum(protos[static_cast<int>(i)], absl::StrFormat("%s[%d]", field, i), &(*sums)[i]);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status ReadCounts(const v1::SampleCounts& proto, SampleCounts* counts) {
  *counts = {proto.receivers(),
             proto.invalid_depth(),
             proto.candidates(),
             proto.background(),
             proto.discontinuity(),
             proto.facing_away(),
             proto.edge_on(),
             proto.used(),
             proto.beyond_map()};
  for (const int64_t count : {counts->receivers,
                              counts->invalid_depth,
                              counts->candidates,
                              counts->background,
                              counts->discontinuity,
                              counts->facing_away,
                              counts->edge_on,
                              counts->used,
                              counts->beyond_map}) {
    if (absl::Status status = CheckCount("counts", count, 0); !status.ok()) return status;
  }
  if (counts->used > counts->candidates) {
    return Refuse("counts.used",
                  absl::StrFormat("= %d of %d candidates", counts->used, counts->candidates));
  }
  return absl::OkStatus();
}

v1::CoveredRays CoverToProto(const SummaryTotal& total) {
  v1::CoveredRays proto;
  for (const Eigen::Vector3d& ray : total.hull) {
    for (const double value : ray) proto.add_hull(value);
  }
  for (const ExactSum& sum : total.mean_ray) *proto.add_mean_ray() = ExactSumToProto(sum);
  proto.set_near(total.depth.near);
  proto.set_far(total.depth.far);
  return proto;
}

absl::Status ReadHull(const RepeatedField<double>& values,
                      const Light& light,
                      std::vector<Eigen::Vector3d>* hull) {
  if (values.size() % 3 != 0 || values.size() > 3 * kMaxHullRays) {
    return Refuse(
        "cover.hull",
        absl::StrFormat(
            "has %d numbers, want 3 for each of at most %d rays", values.size(), kMaxHullRays));
  }
  const bool is_point = light.kind == Light::Kind::kPoint;
  for (int i = 0; i < values.size(); i += 3) {
    const Eigen::Vector3d ray(values[i], values[i + 1], values[i + 2]);
    const double length = is_point ? ray.norm() : ray.z();
    if (!(ray.cwiseAbs().maxCoeff() <= kMaxPart) || !(std::abs(length - 1.0) <= kUnitTolerance)) {
      return Refuse(absl::StrFormat("cover.hull[%d]", i / 3),
                    absl::StrFormat("= (%g, %g, %g), want %s",
                                    ray.x(),
                                    ray.y(),
                                    ray.z(),
                                    is_point ? "a unit vector" : "z = 1"));
    }
    hull->push_back(ray);
  }
  const std::optional<std::vector<Eigen::Vector3d>> extreme = ExtremeRays(*hull);
  if (!extreme.has_value() || *extreme != *hull) {
    return Refuse("cover.hull", "is no convex hull, counter-clockwise from the smallest ray");
  }
  return absl::OkStatus();
}

absl::Status ReadCover(const v1::CoveredRays& proto, SummaryTotal* total) {
  absl::Status status = ReadHull(proto.hull(), total->light, &total->hull);
  if (status.ok()) status = ReadExactSums(proto.mean_ray(), "cover.mean_ray", &total->mean_ray);
  if (!status.ok()) return status;
  total->surrounded = total->hull.empty();
  total->depth = {proto.near(), proto.far()};
  const bool is_point = total->light.kind == Light::Kind::kPoint;
  const auto [near, far] = total->depth;
  if (!(std::abs(near) <= kMaxPart && std::abs(far) <= kMaxPart && near <= far) ||
      (is_point && !(near > 0.0))) {
    return Refuse(
        "cover.near and far",
        absl::StrFormat(
            "= %g and %g, want %snear <= far, world units", near, far, is_point ? "0 < " : ""));
  }
  return absl::OkStatus();
}

v1::SummaryTotal TotalToProto(const SummaryTotal& total) {
  v1::SummaryTotal proto;
  proto.set_num_frames(total.num_frames);
  if (total.counts.used > 0) {
    for (const ExactSum& sum : total.tensor) *proto.add_tensor() = ExactSumToProto(sum);
  }
  *proto.mutable_total_weight() = ExactSumToProto(total.total_weight);
  *proto.mutable_footprint_sum() = ExactSumToProto(total.footprint_sum);
  *proto.mutable_counts() = SampleCountsToProto(total.counts);
  proto.set_facing(FacingSourceToProto(total.facing));
  if (total.surrounded || !total.hull.empty()) *proto.mutable_cover() = CoverToProto(total);
  return proto;
}

// `total` comes with its light and metric.
absl::Status ReadTotal(const v1::SummaryTotal& proto, bool is_l1, SummaryTotal* total) {
  absl::Status status = CheckCount("num_frames", proto.num_frames(), 1);
  if (status.ok()) status = ReadCounts(proto.counts(), &total->counts);
  const bool has_samples = total->counts.used > 0;
  if (status.ok() && (has_samples || proto.tensor_size() > 0)) {
    status = ReadExactSums(proto.tensor(), "tensor", &total->tensor);
  }
  if (status.ok())
    status = ReadExactSum(proto.total_weight(), "total_weight", &total->total_weight);
  if (status.ok()) {
    status = ReadExactSum(proto.footprint_sum(), "footprint_sum", &total->footprint_sum);
  }
  if (status.ok() && proto.has_cover()) status = ReadCover(proto.cover(), total);
  if (!status.ok()) return status;
  if (total->total_weight.Sign() != (has_samples ? 1 : 0)) {
    return Refuse("total_weight",
                  absl::StrFormat("= %g of %d samples, want more than 0, and 0 without samples",
                                  total->total_weight.Value(),
                                  total->counts.used));
  }
  total->is_l1 = is_l1 && has_samples;
  if (total->footprint_sum.Sign() != (total->is_l1 ? 1 : 0)) {
    return Refuse("footprint_sum",
                  absl::StrFormat("= %g, want more than 0 for an L1 metric, else 0",
                                  total->footprint_sum.Value()));
  }
  if (has_samples != (proto.tensor_size() > 0)) {
    return Refuse("tensor", "is there without samples");
  }
  total->num_frames = proto.num_frames();
  total->facing =
      proto.facing() == v1::FACING_SOURCE_GIVEN ? FacingSource::kGiven : FacingSource::kGuessed;
  return absl::OkStatus();
}

absl::Status ReadFailure(const v1::LightSummary& proto, LightSummary* light) {
  absl::Status status = CheckCount("num_frames_without", proto.num_frames_without(), 0);
  if (!status.ok()) return status;
  light->num_frames_without = proto.num_frames_without();
  if (proto.has_failure() != (light->num_frames_without > 0)) {
    return Refuse("failure", "does not go with num_frames_without");
  }
  if (!proto.has_failure()) return absl::OkStatus();
  const v1::Failure& failure = proto.failure();
  constexpr int kLastCode = static_cast<int>(absl::StatusCode::kUnauthenticated);
  if (failure.code() < 1 || failure.code() > kLastCode) {
    return Refuse("failure.code",
                  absl::StrFormat("= %d, want 1 ... %d", failure.code(), kLastCode));
  }
  if (failure.message().empty() || failure.message().size() > kMaxFailureBytes) {
    return Refuse(
        "failure.message",
        absl::StrFormat("has %d bytes, want 1 ... %d", failure.message().size(), kMaxFailureBytes));
  }
  light->failure = absl::Status(static_cast<absl::StatusCode>(failure.code()), failure.message());
  return absl::OkStatus();
}

absl::Status ReadWeighing(const v1::LightSummary& proto, bool is_l1, LightSummary* light) {
  if (!proto.has_weighed_in()) return absl::OkStatus();
  if (!is_l1) return Refuse("weighed_in", "is there, and the metric is none of L1");
  const absl::StatusOr<Eigen::Matrix4d> matrix = MatrixFromProto(proto.weighed_in(), "weighed_in");
  if (!matrix.ok()) return matrix.status();
  light->weighed_in = *matrix;
  return absl::OkStatus();
}

absl::StatusOr<LightSummary> LightSummaryFromProto(const v1::LightSummary& proto,
                                                   const FitOptions& options) {
  absl::StatusOr<Light> light = LightFromProto(proto.light());
  if (!light.ok()) return light.status();
  LightSummary summary;
  summary.total.light = *std::move(light);
  summary.total.metric = WeightsOf(options.metric, options.along_edge_share);
  summary.total.border = options.border == BorderChoice::kDark ? Border::kDark : Border::kLit;
  const bool is_l1 = IsL1(options.metric);
  absl::Status status =
      proto.has_total() ? ReadTotal(proto.total(), is_l1, &summary.total) : absl::OkStatus();
  if (status.ok()) status = ReadFailure(proto, &summary);
  if (status.ok()) status = ReadWeighing(proto, is_l1, &summary);
  if (!status.ok()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": %s", summary.name(), status.message()));
  }
  return summary;
}

// The first field of `message`, or below it, that this program's schema does not have; else empty.
std::string UnknownField(const google::protobuf::Message& message) {
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  const google::protobuf::UnknownFieldSet& unknown = reflection.GetUnknownFields(message);
  if (!unknown.empty()) {
    return absl::StrCat(message.GetDescriptor()->name(), ", field ", unknown.field(0).number());
  }
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  reflection.ListFields(message, &fields);
  for (const google::protobuf::FieldDescriptor* field : fields) {
    if (field->cpp_type() != google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE) continue;
    const int count = field->is_repeated() ? reflection.FieldSize(message, field) : 1;
    for (int i = 0; i < count; ++i) {
      std::string found =
          UnknownField(field->is_repeated() ? reflection.GetRepeatedMessage(message, field, i)
                                            : reflection.GetMessage(message, field));
      if (!found.empty()) return found;
    }
  }
  return "";
}

}  // namespace

v1::LightSummary LightSummaryToProto(const LightSummary& light) {
  v1::LightSummary proto;
  *proto.mutable_light() = LightToProto(light.total.light);
  if (light.total.num_frames > 0) *proto.mutable_total() = TotalToProto(light.total);
  proto.set_num_frames_without(light.num_frames_without);
  if (!light.failure.ok()) {
    proto.mutable_failure()->set_code(static_cast<int>(light.failure.code()));
    proto.mutable_failure()->set_message(std::string(light.failure.message()));
  }
  if (light.weighed_in.has_value()) *proto.mutable_weighed_in() = MatrixToProto(*light.weighed_in);
  return proto;
}

v1::SummaryFile SummarySetToProto(const SummarySet& set) {
  v1::SummaryFile proto;
  *proto.mutable_options() = FitOptionsToProto(set.options);
  for (const LightSummary& light : set.lights) *proto.add_lights() = LightSummaryToProto(light);
  FramesToProto(set.frames, &proto);
  return proto;
}

absl::StatusOr<SummarySet> SummarySetFromProto(const v1::SummaryFile& proto) {
  if (const std::string unknown = UnknownField(proto); !unknown.empty()) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "has something that this lightfit does not know (%s); it was written by \"%s\": update "
        "lightfit",
        unknown,
        proto.writer()));
  }
  absl::StatusOr<FitOptions> options = FitOptionsFromProto(proto.options());
  if (!options.ok()) return options.status();
  v1::FitOptions given = proto.options();
  if (given.border() == v1::BORDER_CHOICE_UNSPECIFIED) {
    given.set_border(v1::BORDER_CHOICE_LIT);  // files from before there was a choice
  }
  if (FitOptionsToProto(*options).SerializeAsString() != given.SerializeAsString()) {
    return absl::InvalidArgumentError("options: some are not set, want all");
  }
  if (proto.lights().empty()) return absl::InvalidArgumentError("lights: none, want at least one");
  SummarySet set;
  set.options = *std::move(options);
  std::vector<Light> lights;
  for (const v1::LightSummary& light_proto : proto.lights()) {
    absl::StatusOr<LightSummary> light = LightSummaryFromProto(light_proto, set.options);
    if (!light.ok()) return light.status();
    light->total.light.shadow_bit = static_cast<int>(lights.size() % kMaxLights);
    lights.push_back(light->total.light);
    set.lights.push_back(*std::move(light));
    const LightSummary& first = set.lights.front();
    const LightSummary& last = set.lights.back();
    if (last.num_frames() != first.num_frames() || last.num_frames() < 1) {
      return absl::InvalidArgumentError(
          absl::StrFormat("light \"%s\" is of %d frames and light \"%s\" of %d, want the same "
                          "frames for all, at least 1",
                          first.name(),
                          first.num_frames(),
                          last.name(),
                          last.num_frames()));
    }
  }
  if (absl::Status status = ValidateLights(lights); !status.ok()) return status;
  if (!std::is_sorted(lights.begin(), lights.end(), [](const Light& a, const Light& b) {
        return a.name < b.name;
      })) {
    return absl::InvalidArgumentError("lights: not in the order of their names");
  }
  if (absl::Status status = FramesFromProto(proto, set.num_frames(), &set.frames); !status.ok())
    return status;
  return set;
}

}  // namespace lightfit
