#include "wire/summary_set.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/text_format.h>

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/strip.h"
#include "wire/options_proto.h"
#include "wire/utf8.h"

namespace lightfit {

namespace {

std::string NamesOf(const SummarySet& set) {
  return absl::StrJoin(set.lights, ", ", [](std::string* out, const LightSummary& light) {
    absl::StrAppend(out, "\"", light.name(), "\"");
  });
}

// InvalidArgument with the first field that differs; ok when there is none.
absl::Status CheckSameFields(const google::protobuf::Message& here,
                             const google::protobuf::Message& before,
                             const std::string& where) {
  using google::protobuf::FieldDescriptor;
  const google::protobuf::Descriptor& descriptor = *here.GetDescriptor();
  for (int i = 0; i < descriptor.field_count(); ++i) {
    const FieldDescriptor* field = descriptor.field(i);
    const std::string path = absl::StrCat(where, ".", field->name());
    if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      absl::Status status = CheckSameFields(here.GetReflection()->GetMessage(here, field),
                                            before.GetReflection()->GetMessage(before, field),
                                            path);
      if (!status.ok()) return status;
      continue;
    }
    std::string value_here, value_before;
    google::protobuf::TextFormat::PrintFieldValueToString(here, field, -1, &value_here);
    google::protobuf::TextFormat::PrintFieldValueToString(before, field, -1, &value_before);
    if (value_here != value_before) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%s is %s here and %s in what it is to be added to: summarise all frames "
                          "with the same options",
                          path,
                          value_here,
                          value_before));
    }
  }
  return absl::OkStatus();
}

absl::Status CheckSameWeighing(const LightSummary& here, const LightSummary& before) {
  if (here.weighed_in == before.weighed_in) return absl::OkStatus();
  const auto words = [](const LightSummary& light) {
    return light.weighed_in.has_value() ? "in a given map" : "in each frame's own best map";
  };
  const bool both_given = here.weighed_in.has_value() && before.weighed_in.has_value();
  return absl::InvalidArgumentError(absl::StrFormat(
      "light \"%s\": samples are weighed %s here and %s in what it is to be added to: summarise "
      "all frames with the same --weigh-by, or all without",
      here.name(),
      words(here),
      both_given ? "in another" : words(before)));
}

}  // namespace

LightSummary SummaryOfFrame(const Light& light,
                            const absl::StatusOr<Summary>& summary,
                            absl::string_view frame,
                            const FitOptions& options) {
  LightSummary result;
  if (summary.ok()) {
    result.total = TotalOf(*summary, light);
  } else {
    result.total.light = light;
    result.total.metric = WeightsOf(options.metric, options.along_edge_share);
    result.num_frames_without = 1;
    const std::string message =
        absl::StrCat(frame,
                     ": ",
                     absl::StripPrefix(summary.status().message(),
                                       absl::StrCat("light \"", light.name, "\": ")));
    result.failure =
        absl::Status(summary.status().code(), Utf8Text(message.substr(0, kMaxFailureBytes)));
  }
  // -0 becomes 0, or equal lights would not be equal bytes.
  result.total.light.position.array() += 0.0;
  result.total.light.direction.array() += 0.0;
  return result;
}

SummarySet MakeSummarySet(const FitOptions& options,
                          std::vector<LightSummary> lights,
                          const std::optional<FrameIdentity>& frame) {
  std::sort(lights.begin(), lights.end(), [](const LightSummary& a, const LightSummary& b) {
    return a.name() < b.name();
  });
  SummarySet set = {options, std::move(lights), {}};
  if (frame.has_value()) set.frames.push_back(*frame);
  return set;
}

absl::Status AddToSet(const SummarySet& other, SummarySet* sum) {
  absl::Status status =
      CheckSameFields(FitOptionsToProto(other.options), FitOptionsToProto(sum->options), "options");
  if (!status.ok()) return status;
  const bool same_names =
      std::equal(other.lights.begin(),
                 other.lights.end(),
                 sum->lights.begin(),
                 sum->lights.end(),
                 [](const LightSummary& a, const LightSummary& b) { return a.name() == b.name(); });
  if (!same_names) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "has the lights %s, and what it is to be added to has %s: summarise all frames with the "
        "same lights, or choose those that all have with --only",
        NamesOf(other),
        NamesOf(*sum)));
  }
  std::vector<LightSummary> lights = sum->lights;
  for (size_t i = 0; i < lights.size(); ++i) {
    const LightSummary& from = other.lights[i];
    LightSummary& to = lights[i];
    status = CheckSameWeighing(from, to);
    if (status.ok()) status = AddToTotal(from.total, &to.total);
    if (!status.ok()) return status;
    to.num_frames_without += from.num_frames_without;
    if (to.failure.ok() ||
        (!from.failure.ok() && std::pair(from.failure.message(), from.failure.code()) <
                                   std::pair(to.failure.message(), to.failure.code()))) {
      to.failure = from.failure;
    }
  }
  if (const std::optional<FrameIdentity> repeated = FirstInBoth(other.frames, sum->frames)) {
    return absl::AlreadyExistsError(
        absl::StrFormat("%s is in what it is to be added to already, and would count twice: leave "
                        "one of the two out",
                        IdentityText(*repeated)));
  }
  sum->lights = std::move(lights);
  InsertInOrder(other.frames, &sum->frames);
  return absl::OkStatus();
}

}  // namespace lightfit
