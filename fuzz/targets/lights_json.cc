// Files of lights, which scene files are too, in any encoding.
#include <google/protobuf/util/message_differencer.h>

#include "base/text_encoding.h"
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
  const absl::StatusOr<std::string> text =
      DecodeText(std::string(reinterpret_cast<const char*>(data), size));
  fuzz::PromiseOkOrError(text.status());
  if (!text.ok()) return 0;
  const absl::StatusOr<std::vector<ListedLight>> listed = ParseLightList(*text);
  fuzz::PromiseOkOrError(listed.status());
  const absl::StatusOr<std::vector<Light>> lights = ParseLightsJson(*text);
  fuzz::PromiseOkOrError(lights.status());
  if (listed.ok()) {
    for (const ListedLight& light : *listed) {
      fuzz::PromiseOkOrError(light.status);
      fuzz::Promise(!light.status.ok() || ValidateNamedLight(light.light).ok(),
                    "a listed light can be used, or says why not");
    }
  }
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
