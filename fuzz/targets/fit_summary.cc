// The call FitSummary: a serialised FitSummaryRequest.
#include "calls/summary_call.h"
#include "fuzz/calls.h"
#include "fuzz/input_form.h"
#include "fuzz/promises.h"

namespace lightfit::fuzz {

InputForm FormOfInput() { return {&v1::FitSummaryRequest::default_instance(), Encoding::kMessage}; }

}  // namespace lightfit::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightfit;  // NOLINT(google-build-using-namespace)
  v1::FitSummaryRequest request;
  if (!fuzz::ParseRequest(data, size, &request)) return 0;
  fuzz::ShortenSearch(request.mutable_options());
  fuzz::PromiseAnswer(AnswerFitSummary(request, fuzz::SmallContext()));
  return 0;
}
