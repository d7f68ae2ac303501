// The call Allocate: a serialised AllocateRequest.
#include "calls/allocate_call.h"
#include "fuzz/calls.h"
#include "fuzz/input_form.h"
#include "fuzz/promises.h"

namespace lightfit::fuzz {

InputForm FormOfInput() { return {&v1::AllocateRequest::default_instance(), Encoding::kMessage}; }

}  // namespace lightfit::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightfit;  // NOLINT(google-build-using-namespace)
  v1::AllocateRequest request;
  if (!fuzz::ParseRequest(data, size, &request)) return 0;
  fuzz::ShortenSearch(request.mutable_options());
  fuzz::PromiseAnswer(AnswerAllocate(request, fuzz::SmallContext()));
  return 0;
}
