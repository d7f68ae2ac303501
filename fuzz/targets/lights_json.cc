// Files of lights, which scene files are too.
#include <google/protobuf/util/message_differencer.h>

#include "fuzz/input_form.h"
#include "fuzz/promises.h"
#include "io/lights_file.h"
#include "wire/light_proto.h"
#include "wire/proto_json.h"

namespace lightfit::fuzz {

InputForm FormOfInput() { return {&v1::LightList::default_instance(), Encoding::kJson}; }

namespace {

v1::LightList ListOf(const std::vector<Light>& lights) {
  v1::LightList list;
  for (const Light& light : lights) *list.add_lights() = LightToProto(light);
  return list;
}

}  // namespace
}  // namespace lightfit::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightfit;  // NOLINT(google-build-using-namespace)
  const absl::StatusOr<std::vector<Light>> lights =
      ParseLightsJson({reinterpret_cast<const char*>(data), size});
  fuzz::PromiseOkOrError(lights.status());
  if (!lights.ok()) return 0;
  fuzz::Promise(ValidateLights(*lights).ok(), "lights from a file can be used");
  const v1::LightList list = fuzz::ListOf(*lights);
  fuzz::PromiseMessage(list);
  const absl::StatusOr<std::string> json = ProtoToJson(list);
  fuzz::Promise(json.ok(), "what was read can be written");
  const absl::StatusOr<std::vector<Light>> read = ParseLightsJson(*json);
  fuzz::Promise(read.ok(), "what was written can be read");
  // Equal numbers: in JSON -0 becomes 0.
  fuzz::Promise(google::protobuf::util::MessageDifferencer::Equals(fuzz::ListOf(*read), list),
                "what was read, written and read again is the same");
  return 0;
}
