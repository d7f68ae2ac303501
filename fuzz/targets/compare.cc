// The call Compare: a serialised CompareRequest.
#include "calls/compare/compare_call.h"
#include "fuzz/calls.h"
#include "fuzz/input_form.h"
#include "fuzz/promises.h"

namespace lightfit::fuzz {

InputForm FormOfInput() { return {&v1::CompareRequest::default_instance(), Encoding::kMessage}; }

}  // namespace lightfit::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightfit;  // NOLINT(google-build-using-namespace)
  v1::CompareRequest request;
  if (!fuzz::ParseRequest(data, size, &request)) return 0;
  fuzz::ShortenSearch(request.mutable_options());
  fuzz::PromiseAnswer(AnswerCompare(request, fuzz::SmallContext()));
  return 0;
}
