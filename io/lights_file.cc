#include "io/lights_file.h"

#include <google/protobuf/struct.pb.h>

#include <cmath>
#include <set>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "base/text_file.h"
#include "io/frames/light_frames.h"
#include "scenes/gltf_view.h"
#include "wire/light_proto.h"
#include "wire/proto_json.h"
#include "wire/utf8.h"

namespace lightfit {

namespace {

using google::protobuf::ListValue;
using google::protobuf::Struct;
using google::protobuf::Value;

enum class KindOfLight { kUnsaid, kPoint, kSun, kOther };

const Value* FindField(const Struct& object, const char* name) {
  const auto found = object.fields().find(name);
  return found == object.fields().end() ? nullptr : &found->second;
}

// Lower case, and without what programs put around it: "PxrDistantLight" is "distant".
std::string BareWord(absl::string_view word) {
  std::string bare;
  for (const char c : word) {
    if (absl::ascii_isalpha(c)) bare.push_back(absl::ascii_tolower(c));
  }
  absl::string_view view(bare);
  if (view.size() > 3) absl::ConsumePrefix(&view, "pxr");
  if (view.size() > 5 && !absl::ConsumeSuffix(&view, "light")) absl::ConsumePrefix(&view, "light");
  return std::string(view);
}

KindOfLight KindOfWord(absl::string_view word) {
  const std::string bare = BareWord(word);
  for (const char* point : {"point", "spot", "omni", "sphere", "photometric"}) {
    if (bare == point) return KindOfLight::kPoint;
  }
  for (const char* sun : {"sun", "directional", "direction", "distant", "infinite"}) {
    if (bare == sun) return KindOfLight::kSun;
  }
  return KindOfLight::kOther;
}

// What a light says that it is; `said` is that in the file's words, "type = \"DOME\"".
KindOfLight KindOf(const Struct& object, std::string* said) {
  for (const char* field : {"type", "kind", "light_type", "lightType"}) {
    const Value* value = FindField(object, field);
    if (value == nullptr || value->has_null_value()) continue;
    if (!value->has_string_value()) {
      *said = absl::StrCat(field, " is not a word");
      return KindOfLight::kOther;
    }
    if (value->string_value().empty()) continue;
    *said = absl::StrFormat("%s = \"%s\"", field, Utf8Text(value->string_value().substr(0, 64)));
    return KindOfWord(value->string_value());
  }
  return KindOfLight::kUnsaid;
}

bool HasList(const Struct& object, const char* name) {
  const Value* value = FindField(object, name);
  return value != nullptr && value->list_value().values_size() > 0;
}

absl::StatusOr<Light> LightOfObject(Struct object) {
  const Value* name_value = FindField(object, "name");
  const std::string name =
      name_value != nullptr ? Utf8Text(name_value->string_value().substr(0, 64)) : "";
  std::string said;
  const KindOfLight kind = KindOf(object, &said);
  if (kind == KindOfLight::kOther) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": %s, want a point, a spot or a sun: light from an area or from all around "
        "has "
        "no single shadow map. To fit it as a point give it a position and the type \"POINT\"",
        name,
        said));
  }
  // Of a spot the direction does not matter, of a sun the place of its icon.
  if (HasList(object, "position") && HasList(object, "direction")) {
    object.mutable_fields()->erase(kind == KindOfLight::kSun ? "position" : "direction");
  }
  const char* wanted = kind == KindOfLight::kSun     ? "direction"
                       : kind == KindOfLight::kPoint ? "position"
                                                     : nullptr;
  if (wanted != nullptr && !HasList(object, wanted)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": %s, but it has no %s, want [x, y, z]", name, said, wanted));
  }
  const absl::StatusOr<std::string> json = ProtoToJson(object);
  if (!json.ok()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": is not JSON: %s", name, json.status().message()));
  }
  v1::Light proto;
  if (absl::Status status = JsonToProto(*json, proto); !status.ok()) return status;
  return LightFromProto(proto);
}

// Names and places are what a light is read from; the rest of an entry may be large.
Struct OnlyWhatCounts(const Struct& object) {
  Struct counts;
  for (const char* field :
       {"name", "position", "direction", "type", "kind", "light_type", "lightType"}) {
    const Value* value = FindField(object, field);
    if (value != nullptr) (*counts.mutable_fields())[field] = *value;
  }
  return counts;
}

absl::StatusOr<std::string> JsonOf(const std::string& path) {
  return IsGltf(path) ? GltfLightsJson(path) : ReadTextFile(path);
}

absl::Status AtIndex(int index, const absl::Status& status) {
  return absl::Status(status.code(), absl::StrCat("lights[", index, "]: ", status.message()));
}

ListedLight LightOfEntry(const Value& entry, int index) {
  ListedLight listed;
  listed.light.shadow_bit = index;
  listed.light.direction.setZero();  // it has none that anybody stated
  // Who has a name is told by it.
  const auto fail = [&listed, index](const absl::Status& status) {
    listed.status = listed.light.name.empty() ? AtIndex(index, status) : status;
  };
  if (!entry.has_struct_value()) {
    fail(absl::InvalidArgumentError(
        "want {\"name\": ..., \"position\" or \"direction\": [x, y, z]}"));
    return listed;
  }
  absl::StatusOr<Light> light = LightOfObject(OnlyWhatCounts(entry.struct_value()));
  if (light.ok()) {
    listed.light = *std::move(light);
    listed.light.shadow_bit = index;
  } else {
    const Value* name = FindField(entry.struct_value(), "name");
    if (name != nullptr) listed.light.name = Utf8Text(name->string_value());
    fail(light.status());
  }
  return listed;
}

}  // namespace

absl::StatusOr<std::vector<ListedLight>> ParseLightList(absl::string_view json) {
  Struct file;
  if (absl::Status status = JsonToProto(json, file); !status.ok()) {
    // In the words of what the file should be.
    v1::LightList list;
    const absl::Status of_list = JsonToProto(json, list);
    return of_list.ok() ? status : of_list;
  }
  if (LightFrames::HasMovingLights(file)) {
    return absl::InvalidArgumentError(
        "frames: its lights move, and the lights of one frame are wanted here: give each with "
        "--light, or a file without frames");
  }
  const Value* entries = FindField(file, "lights");
  if (entries == nullptr || entries->list_value().values().empty()) {
    return absl::InvalidArgumentError(
        "lights: none, want {\"lights\": [{\"name\": ..., \"position\" or \"direction\": [x, y, "
        "z]}]}");
  }
  std::vector<ListedLight> lights;
  std::set<std::string> names;
  for (const Value& entry : entries->list_value().values()) {
    lights.push_back(LightOfEntry(entry, static_cast<int>(lights.size())));
    ListedLight& listed = lights.back();
    if (listed.status.ok() && !names.insert(listed.light.name).second) {
      listed.status = NameTakenError(listed.light);
    }
  }
  return lights;
}

absl::StatusOr<std::vector<Light>> ParseLightsJson(absl::string_view json) {
  absl::StatusOr<std::vector<ListedLight>> list = ParseLightList(json);
  if (!list.ok()) return list.status();
  if (list->size() > kMaxLights) return TooManyLightsError(static_cast<int64_t>(list->size()));
  std::vector<Light> lights;
  for (ListedLight& listed : *list) {
    if (!listed.status.ok()) {
      if (listed.light.name.empty()) return listed.status;
      return AtIndex(listed.light.shadow_bit, listed.status);
    }
    lights.push_back(std::move(listed.light));
  }
  return lights;
}

absl::StatusOr<std::vector<ListedLight>> ReadLightList(const std::string& path) {
  const absl::StatusOr<std::string> json = JsonOf(path);
  if (!json.ok()) return json.status();
  absl::StatusOr<std::vector<ListedLight>> lights = ParseLightList(*json);
  if (!lights.ok()) return InFile(path, lights.status());
  return lights;
}

absl::StatusOr<std::vector<Light>> ReadLightsFile(const std::string& path) {
  const absl::StatusOr<std::string> json = JsonOf(path);
  if (!json.ok()) return json.status();
  absl::StatusOr<std::vector<Light>> lights = ParseLightsJson(*json);
  if (!lights.ok()) return InFile(path, lights.status());
  return lights;
}

absl::StatusOr<Light> ParseLight(absl::string_view text) {
  const auto refuse = [text](absl::string_view what) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": %s, want NAME=point:x,y,z or NAME=sun:x,y,z (the direction of travel)",
        text,
        what));
  };
  // Names may hold '=', values cannot.
  const size_t equals = text.rfind('=');
  if (equals == absl::string_view::npos) return refuse("has no '='");
  const absl::string_view name = text.substr(0, equals);
  const std::pair<absl::string_view, absl::string_view> value =
      absl::StrSplit(text.substr(equals + 1), absl::MaxSplits(':', 1));
  const bool is_point = value.first == "point";
  if (!is_point && value.first != "sun") {
    return refuse(absl::StrFormat("kind = \"%s\"", value.first));
  }
  const std::vector<absl::string_view> numbers = absl::StrSplit(value.second, ',');
  if (numbers.size() != 3) return refuse(absl::StrFormat("has %d numbers", numbers.size()));
  Eigen::Vector3d vector;
  for (int i = 0; i < 3; ++i) {
    if (!absl::SimpleAtod(numbers[i], &vector[i])) {
      return refuse(absl::StrFormat("\"%s\" is not a number", numbers[i]));
    }
  }
  Light light = is_point ? Light::Point(std::string(name), vector)
                         : Light::Directional(std::string(name), vector);
  if (absl::Status status = ValidateNamedLight(light); !status.ok()) return status;
  return light;
}

}  // namespace lightfit
