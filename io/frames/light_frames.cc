#include "io/frames/light_frames.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/text_file.h"
#include "io/frames/frame_table.h"
#include "scenes/gltf_view.h"
#include "wire/proto_json.h"

namespace lightfit {
namespace {

using google::protobuf::Struct;
using google::protobuf::Value;

std::string NameOf(const Value& light) {
  const auto found = light.struct_value().fields().find("name");
  return found == light.struct_value().fields().end() ? "" : found->second.string_value();
}

const google::protobuf::ListValue& LightsIn(const Struct& object) {
  const auto found = object.fields().find("lights");
  return found == object.fields().end() ? google::protobuf::ListValue::default_instance()
                                        : found->second.list_value();
}

bool IsPlaced(const Struct& light) {
  return light.fields().contains("position") || light.fields().contains("direction");
}

}  // namespace

bool LightFrames::HasMovingLights(const Struct& file) {
  for (const Value& light : LightsIn(file).values()) {
    if (HasFrames(light.struct_value())) return true;
  }
  if (!HasFrames(file)) return false;
  const Value& frames = file.fields().at("frames");
  for (const Value& frame : frames.list_value().values()) {
    if (frame.struct_value().fields().contains("lights")) return true;
  }
  for (const auto& [name, frame] : frames.struct_value().fields()) {
    if (frame.struct_value().fields().contains("lights")) return true;
  }
  return false;
}

absl::Status LightFrames::AddName(const std::string& name) {
  if (name.empty()) {
    return absl::InvalidArgumentError("lights: one has no name, want one to tell lights apart by");
  }
  if (std::find(names_.begin(), names_.end(), name) == names_.end()) names_.push_back(name);
  return absl::OkStatus();
}

LightFrames::Entry* LightFrames::EntryFor(const std::optional<FrameNumber>& number, size_t place) {
  if (number.has_value()) {
    const auto [found, is_new] = entry_of_.emplace(*number, entries_.size());
    if (is_new) entries_.push_back({number, {}});
    return &entries_[found->second];
  }
  has_places_ = true;
  while (entries_.size() <= place) entries_.emplace_back();
  return &entries_[place];
}

absl::Status LightFrames::AddFramesOfFile(const Struct& file) {
  const absl::StatusOr<FrameTable> table = ReadFrameTable(file);
  if (!table.ok()) return table.status();
  for (size_t i = 0; i < table->size(); ++i) {
    Entry* entry = EntryFor((*table)[i].number, i);
    for (const Value& light : LightsIn((*table)[i].value.struct_value()).values()) {
      const std::string name = NameOf(light);
      if (absl::Status status = AddName(name); !status.ok()) return status;
      entry->lights[name] = light;
    }
  }
  return absl::OkStatus();
}

absl::Status LightFrames::AddFramesOfLight(const std::string& name, const Struct& light) {
  const absl::StatusOr<FrameTable> table = ReadFrameTable(light);
  if (!table.ok()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": %s", name, table.status().message()));
  }
  Struct still = light;
  still.mutable_fields()->erase("frames");
  for (size_t i = 0; i < table->size(); ++i) {
    Struct moved = still;
    for (const auto& [field, value] : (*table)[i].value.struct_value().fields()) {
      if (field != "name") (*moved.mutable_fields())[field] = value;
    }
    Value value;
    *value.mutable_struct_value() = std::move(moved);
    EntryFor((*table)[i].number, i)->lights[name] = std::move(value);
  }
  return absl::OkStatus();
}

absl::StatusOr<std::optional<LightFrames>> LightFrames::Parse(absl::string_view json) {
  Struct file;
  // What is wrong with such a file io/lights_file.h says.
  if (!JsonToProto(json, file).ok()) return std::optional<LightFrames>();
  return Of(file);
}

absl::StatusOr<std::optional<LightFrames>> LightFrames::Of(const Struct& file) {
  if (!HasMovingLights(file)) return std::optional<LightFrames>();
  LightFrames frames;
  for (const Value& light : LightsIn(file).values()) {
    const std::string name = NameOf(light);
    absl::Status status = frames.AddName(name);
    if (status.ok() && HasFrames(light.struct_value())) {
      status = frames.AddFramesOfLight(name, light.struct_value());
    }
    if (!status.ok()) return status;
    if (!HasFrames(light.struct_value()) || IsPlaced(light.struct_value())) {
      frames.base_[name] = light;
    }
  }
  if (HasFrames(file)) {
    if (absl::Status status = frames.AddFramesOfFile(file); !status.ok()) return status;
  }
  if (frames.has_places_ && !frames.entry_of_.empty()) {
    return absl::InvalidArgumentError(
        "frames: some say which they are (\"frame\": 1001) and some do not, want all or none");
  }
  return std::optional<LightFrames>(std::move(frames));
}

absl::StatusOr<std::optional<LightFrames>> LightFrames::Read(const std::string& path) {
  if (IsGltf(path)) return std::optional<LightFrames>();
  const absl::StatusOr<std::string> json = ReadTextFile(path);
  if (!json.ok()) return json.status();
  absl::StatusOr<std::optional<LightFrames>> frames = Parse(*json);
  if (!frames.ok()) return InFile(path, frames.status());
  return frames;
}

std::vector<std::optional<FrameNumber>> LightFrames::numbers() const {
  std::vector<std::optional<FrameNumber>> numbers;
  numbers.reserve(entries_.size());
  for (const Entry& entry : entries_) numbers.push_back(entry.number);
  return numbers;
}

absl::StatusOr<LightFrames::Frame> LightFrames::FrameOf(size_t entry) const {
  Frame frame;
  Struct file;
  auto* lights = (*file.mutable_fields())["lights"].mutable_list_value();
  for (const std::string& name : names_) {
    const LightsByName& own = entries_[entry].lights;
    auto found = own.find(name);
    if (found == own.end()) {
      found = base_.find(name);
      if (found == base_.end()) {
        frame.absent.push_back(name);
        // Anything will do; it is somewhere.
        for (const Entry& other : entries_) {
          found = other.lights.find(name);
          if (found != other.lights.end()) {
            *lights->add_values() = found->second;
            break;
          }
        }
        continue;
      }
    }
    *lights->add_values() = found->second;
  }
  absl::StatusOr<std::string> json = ProtoToJson(file);
  if (!json.ok()) return json.status();
  frame.json = *std::move(json);
  return frame;
}

}  // namespace lightfit
