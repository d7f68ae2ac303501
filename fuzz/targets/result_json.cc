// Results and allocations, and what a tracker remembers in them.
#include <google/protobuf/util/message_differencer.h>

#include <vector>

#include "fuzz/input_form.h"
#include "fuzz/promises.h"
#include "lightfit/v1/allocation.pb.h"
#include "lightfit/v1/result.pb.h"
#include "wire/light_proto.h"
#include "wire/proto_json.h"
#include "wire/shot_proto.h"

namespace lightfit::fuzz {

InputForm FormOfInput() { return {&v1::Allocation::default_instance(), Encoding::kJson}; }

namespace {

template <typename Message>
Message PromiseSameWhenReadAgain(absl::string_view json) {
  Message message;
  const absl::Status status = JsonToProto(json, message);
  PromiseOkOrError(status);
  if (!status.ok() || !CheckFinite(message, "message").ok()) return Message();
  const absl::StatusOr<std::string> written = ProtoToJson(message);
  Promise(written.ok(), "what was read can be written");
  Message read;
  Promise(JsonToProto(*written, read).ok(), "what was written can be read");
  // Equal numbers: in JSON -0 becomes 0.
  Promise(google::protobuf::util::MessageDifferencer::Equals(read, message),
          "what was read, written and read again is the same");
  return message;
}

void PromiseTrackedStates(const v1::FitResult& result) {
  std::vector<Light> lights;
  for (const v1::LightResult& proto : result.lights()) {
    const absl::StatusOr<Light> light = LightFromProto(proto.light());
    if (light.ok()) lights.push_back(*light);
  }
  const absl::StatusOr<std::vector<TrackedState>> states =
      TrackedStatesFromProto(result.shot(), lights, {256, 128});
  PromiseOkOrError(states.status());
  if (!states.ok()) return;
  for (const TrackedState& state : *states) PromiseMessage(TrackedStateToProto(state));
}

}  // namespace
}  // namespace lightfit::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightfit;  // NOLINT(google-build-using-namespace)
  const absl::string_view json(reinterpret_cast<const char*>(data), size);
  fuzz::PromiseTrackedStates(fuzz::PromiseSameWhenReadAgain<v1::FitResult>(json));
  fuzz::PromiseSameWhenReadAgain<v1::Allocation>(json);
  return 0;
}
