// The call Summarize: a serialised SummarizeRequest.
#include "calls/summarize_call.h"
#include "fuzz/calls.h"
#include "fuzz/input_form.h"
#include "fuzz/promises.h"

namespace lightfit::fuzz {

InputForm FormOfInput() { return {&v1::SummarizeRequest::default_instance(), Encoding::kMessage}; }

}  // namespace lightfit::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightfit;  // NOLINT(google-build-using-namespace)
  v1::SummarizeRequest request;
  if (!fuzz::ParseRequest(data, size, &request)) return 0;
  fuzz::ShortenSearch(request.mutable_options());
  const absl::StatusOr<v1::SummarizeResult> answer = AnswerSummarize(request, fuzz::SmallContext());
  fuzz::PromiseAnswer(answer);
  if (!answer.ok()) return 0;
  v1::SummarizeRequest again;
  again.add_summary_files(answer->summary_file());
  const absl::StatusOr<v1::SummarizeResult> same = AnswerSummarize(again, fuzz::SmallContext());
  fuzz::Promise(same.ok() && same->summary_file() == answer->summary_file(),
                "a summary can be read again, and is the same");
  return 0;
}
