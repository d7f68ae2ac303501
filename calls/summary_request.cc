#include "calls/summary_request.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/text_format.h>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "base/text_file.h"
#include "calls/request_fields.h"
#include "calls/request_options.h"
#include "io/summary_file.h"
#include "jobs/add_summaries.h"
#include "jobs/fit_summary.h"
#include "wire/options_proto.h"
#include "wire/summary_proto.h"

namespace lightfit {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

// Adds the next summary of the request.
absl::Status AddTo(SummaryAdder* sum,
                   const std::string& field,
                   const absl::StatusOr<SummarySet>& set) {
  if (StopRequested()) return StoppedError();
  if (!set.ok()) return InFile(field, set.status());
  return sum->Add(field, *set);
}

std::string ValueText(const Message& message, const FieldDescriptor* field) {
  std::string text;
  google::protobuf::TextFormat::PrintFieldValueToString(message, field, -1, &text);
  return text;
}

// A field that is set must be as in `held`.
absl::Status CheckField(const Message& asked,
                        const Message& held,
                        const char* prefix,
                        const std::string& name) {
  const FieldDescriptor* field = asked.GetDescriptor()->FindFieldByName(name);
  if (!asked.GetReflection()->HasField(asked, field)) return absl::OkStatus();
  const std::string value = ValueText(asked, field), held_value = ValueText(held, field);
  if (value == held_value) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("%s%s = %s: the summaries were made with %s; leave it out, or summarise the "
                      "frames again with it",
                      prefix,
                      name,
                      value,
                      held_value));
}

absl::Status CheckHeld(const v1::FitOptions& asked, const v1::FitOptions& held) {
  for (const char* name : {"metric", "cover", "border", "along_edge_share"}) {
    if (absl::Status status = CheckField(asked, held, "options.", name); !status.ok()) {
      return status;
    }
  }
  const google::protobuf::Descriptor& samples = *v1::SampleOptions::descriptor();
  for (int i = 0; i < samples.field_count(); ++i) {
    if (samples.field(i)->number() == v1::SampleOptions::kMinSamplesFieldNumber) continue;
    absl::Status status =
        CheckField(asked.samples(), held.samples(), "options.samples.", samples.field(i)->name());
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<SummarySet> SummariesOfRequest(
    const google::protobuf::RepeatedPtrField<v1::SummaryFile>& summaries,
    const google::protobuf::RepeatedPtrField<std::string>& summary_files,
    const CallLimits& limits) {
  const int64_t count = int64_t{summaries.size()} + summary_files.size();
  if (count == 0) {
    return absl::InvalidArgumentError(
        "summaries: none, want at least one in summaries or summary_files");
  }
  if (count > limits.max_summaries) {
    return absl::ResourceExhaustedError(
        absl::StrFormat("summaries and summary_files: %d of them, and this server takes at most "
                        "%d; add some of them up first with lightfit summarize",
                        count,
                        limits.max_summaries));
  }
  SummaryAdder sum;
  for (int i = 0; i < summaries.size(); ++i) {
    absl::Status status =
        AddTo(&sum, absl::StrCat("summaries[", i, "]"), SummarySetFromProto(summaries[i]));
    if (!status.ok()) return status;
  }
  for (int i = 0; i < summary_files.size(); ++i) {
    absl::Status status =
        AddTo(&sum, absl::StrCat("summary_files[", i, "]"), ParseSummarySet(summary_files[i]));
    if (!status.ok()) return status;
  }
  return *sum.sum();
}

absl::StatusOr<FitOptions> OptionsOfSummaryRequest(const v1::FitOptions& asked,
                                                   const FitOptions& held) {
  // First what the fields are alone: one that is unknown or out of range is not one that differs.
  const absl::StatusOr<FitOptions> options = OptionsOfRequest(asked);
  if (!options.ok()) return options.status();
  absl::Status status = CheckHeld(asked, FitOptionsToProto(held));
  if (!status.ok()) return status;
  return OptionsForSummaries(*options, held);
}

}  // namespace lightfit
