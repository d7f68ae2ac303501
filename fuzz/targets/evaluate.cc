// The call Evaluate: a serialised EvaluateRequest.
#include "calls/evaluate_call.h"
#include "fuzz/calls.h"
#include "fuzz/input_form.h"
#include "fuzz/promises.h"

namespace lightfit::fuzz {

InputForm FormOfInput() { return {&v1::EvaluateRequest::default_instance(), Encoding::kMessage}; }

}  // namespace lightfit::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightfit;  // NOLINT(google-build-using-namespace)
  v1::EvaluateRequest request;
  if (!fuzz::ParseRequest(data, size, &request)) return 0;
  fuzz::ShortenSearch(request.mutable_options());
  fuzz::PromiseAnswer(AnswerEvaluate(request, fuzz::SmallContext()));
  return 0;
}
