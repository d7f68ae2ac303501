// Summary files: read, written again, added up, fitted.
#include "io/summary_file.h"

#include "fuzz/calls.h"
#include "fuzz/input_form.h"
#include "fuzz/promises.h"
#include "jobs/fit_summary.h"
#include "lightfit/v1/summary.pb.h"
#include "wire/result_json.h"

namespace lightfit::fuzz {

InputForm FormOfInput() { return {&v1::SummaryFile::default_instance(), Encoding::kSummaryFile}; }

namespace {

constexpr char kWriter[] = "fuzzer";

void PromiseSameWhenReadAgain(const SummarySet& set) {
  const absl::StatusOr<std::string> bytes = SerializeSummarySet(set, kWriter);
  Promise(bytes.ok(), "what was read can be written");
  const absl::StatusOr<SummarySet> read = ParseSummarySet(*bytes);
  Promise(read.ok(), "what was written can be read");
  const absl::StatusOr<std::string> again = SerializeSummarySet(*read, kWriter);
  Promise(again.ok() && *again == *bytes, "what is read and written again is the same");
}

// Sums may grow beyond what a file holds; then there is an error, and no file.
void PromiseSum(const SummarySet& set) {
  SummarySet sum = set;
  const absl::Status status = AddToSet(set, &sum);
  PromiseOkOrError(status);
  if (status.ok()) PromiseOkOrError(SerializeSummarySet(sum, kWriter).status());
}

void PromiseFits(const SummarySet& set) {
  const absl::StatusOr<FitOptions> options = OptionsForSummaries(FitOptions(), set.options);
  PromiseOkOrError(options.status());
  if (!options.ok()) return;
  FitReport report;
  report.options = *options;
  report.map = {256, 128};
  for (const LightSummary& light : set.lights) {
    LightFit& fit = report.lights.emplace_back();
    fit.light = light.total.light;
    fit.matrix = FitSummary(light, report.map, *options);
    PromiseOkOrError(fit.matrix.status());
  }
  PromiseMessage(FitResultToProto(report));
}

}  // namespace
}  // namespace lightfit::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightfit;  // NOLINT(google-build-using-namespace)
  const google::protobuf::LogSilencer silencer;
  const absl::StatusOr<SummarySet> set =
      ParseSummarySet({reinterpret_cast<const char*>(data), size});
  fuzz::PromiseOkOrError(set.status());
  if (!set.ok()) return 0;
  fuzz::PromiseSameWhenReadAgain(*set);
  fuzz::PromiseSum(*set);
  fuzz::PromiseFits(*set);
  return 0;
}
