// Today's schema against the one that is recorded in proto/released_v1.txtpb: lightfit.v1 may grow,
// and nothing else.

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "tests/proto/schema_changes.h"

namespace lightfit {
namespace {

using google::protobuf::DescriptorProto;
using google::protobuf::EnumDescriptorProto;
using google::protobuf::FieldDescriptorProto;
using google::protobuf::FileDescriptorProto;
using google::protobuf::FileDescriptorSet;
using google::protobuf::MethodDescriptorProto;
using testing::BreakingChanges;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string Contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file.good()) << path;
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// The .proto files as they are, compiled.
FileDescriptorSet SchemaNow() {
  FileDescriptorSet set;
  EXPECT_TRUE(set.ParseFromString(Contents(LIGHTFIT_SCHEMA)));
  return set;
}

FileDescriptorSet ReleasedSchema() {
  FileDescriptorSet set;
  EXPECT_TRUE(
      google::protobuf::TextFormat::ParseFromString(Contents(LIGHTFIT_RELEASED_SCHEMA), &set));
  return set;
}

TEST(Compatibility, NothingThatWasReleasedIsGoneOrOther) {
  const FileDescriptorSet released = ReleasedSchema();
  ASSERT_GT(released.file_size(), 5);
  EXPECT_THAT(BreakingChanges(released, SchemaNow()), IsEmpty())
      << "lightfit.v1 may grow only; proto/README.md says how.";
}

// The checker itself, on a small schema of its own.
FileDescriptorSet Example() {
  FileDescriptorSet set;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
      R"pb(
        file {
          name: "a.proto"
          package: "v1"
          syntax: "proto3"
          message_type {
            name: "Light"
            field { name: "name" number: 1 label: LABEL_OPTIONAL type: TYPE_STRING }
            field { name: "position" number: 2 label: LABEL_REPEATED type: TYPE_DOUBLE }
            field {
              name: "power"
              number: 3
              label: LABEL_OPTIONAL
              type: TYPE_DOUBLE
              oneof_index: 1
              proto3_optional: true
            }
            field {
              name: "kind"
              number: 4
              label: LABEL_OPTIONAL
              type: TYPE_ENUM
              type_name: ".v1.Light.Kind"
            }
            field { name: "color" number: 5 label: LABEL_OPTIONAL type: TYPE_INT32 oneof_index: 0 }
            field {
              name: "map"
              number: 6
              label: LABEL_OPTIONAL
              type: TYPE_MESSAGE
              type_name: ".v1.Map"
              oneof_index: 0
            }
            oneof_decl { name: "look" }
            oneof_decl { name: "_power" }
            enum_type {
              name: "Kind"
              value { name: "KIND_UNSPECIFIED" number: 0 }
              value { name: "KIND_SUN" number: 1 }
            }
            reserved_range { start: 9 end: 10 }
            reserved_name: "old"
          }
          message_type { name: "Map" }
          enum_type {
            name: "Metric"
            value { name: "METRIC_UNSPECIFIED" number: 0 }
            value { name: "METRIC_L2" number: 1 }
          }
          service {
            name: "Fitter"
            method { name: "Fit" input_type: ".v1.Light" output_type: ".v1.Map" }
            method {
              name: "Track"
              input_type: ".v1.Light"
              output_type: ".v1.Map"
              client_streaming: true
              server_streaming: true
            }
          }
        })pb",
      &set));
  return set;
}

FileDescriptorProto* File(FileDescriptorSet* set) { return set->mutable_file(0); }
DescriptorProto* Light(FileDescriptorSet* set) { return File(set)->mutable_message_type(0); }
FieldDescriptorProto* Field(FileDescriptorSet* set, int number) {
  return Light(set)->mutable_field(number - 1);
}
EnumDescriptorProto* Metric(FileDescriptorSet* set) { return File(set)->mutable_enum_type(0); }
MethodDescriptorProto* Method(FileDescriptorSet* set, int i) {
  return File(set)->mutable_service(0)->mutable_method(i);
}
void Remove(int index, auto* entries) { entries->DeleteSubrange(index, 1); }

using Change = std::function<void(FileDescriptorSet*)>;

TEST(SchemaChanges, BreakingOnesAreNamed) {
  const std::vector<std::pair<Change, std::string>> cases = {
      {[](auto* set) { Field(set, 1)->set_number(7); },
       "v1.Light.name = 1: is gone; reserve its number and its name"},
      {[](auto* set) { Remove(1, Light(set)->mutable_field()); },
       "v1.Light.position = 2: is gone; reserve"},
      {[](auto* set) {
         Remove(1, Light(set)->mutable_field());
         auto* range = Light(set)->add_reserved_range();
         range->set_start(2);
         range->set_end(3);
       },
       "v1.Light.position = 2: is gone; reserve"},
      {[](auto* set) {
         Remove(1, Light(set)->mutable_field());
         Light(set)->add_reserved_name("position");
       },
       "v1.Light.position = 2: is gone; reserve"},
      {[](auto* set) { Field(set, 1)->set_name("title"); },
       "v1.Light.name: name was name and is title"},
      {[](auto* set) { Field(set, 5)->set_type(FieldDescriptorProto::TYPE_INT64); },
       "v1.Light.color: type was TYPE_INT32 and is TYPE_INT64"},
      {[](auto* set) { Field(set, 4)->set_type_name(".v1.Metric"); },
       "v1.Light.kind: type was .v1.Light.Kind and is .v1.Metric"},
      {[](auto* set) { Field(set, 2)->set_label(FieldDescriptorProto::LABEL_OPTIONAL); },
       "v1.Light.position: label was LABEL_REPEATED and is LABEL_OPTIONAL"},
      {[](auto* set) {
         Field(set, 3)->clear_proto3_optional();
         Field(set, 3)->clear_oneof_index();
       },
       "v1.Light.power: presence was explicit and is implicit"},
      {[](auto* set) { Field(set, 1)->set_oneof_index(0); },
       "v1.Light.name: oneof was none and is look"},
      {[](auto* set) { Field(set, 5)->clear_oneof_index(); },
       "v1.Light.color: oneof was look and is none"},
      {[](auto* set) { Light(set)->clear_reserved_name(); },
       "v1.Light: the name old is no longer reserved"},
      {[](auto* set) { Light(set)->mutable_reserved_range(0)->set_start(10); },
       "v1.Light: the number 9 is no longer reserved"},
      {[](auto* set) { Remove(1, File(set)->mutable_message_type()); }, "v1.Map: is gone"},
      {[](auto* set) { Light(set)->clear_enum_type(); }, "v1.Light.Kind: is gone"},
      {[](auto* set) {
         DescriptorProto map = File(set)->message_type(1);
         Remove(1, File(set)->mutable_message_type());
         FileDescriptorProto* other = set->add_file();
         other->set_name("b.proto");
         other->set_package("v1");
         *other->add_message_type() = map;
       },
       "v1.Map: file was a.proto and is b.proto"},
      {[](auto* set) { Remove(1, Metric(set)->mutable_value()); },
       "v1.Metric.METRIC_L2 = 1: is gone; reserve"},
      {[](auto* set) { Metric(set)->mutable_value(1)->set_name("METRIC_SQUARES"); },
       "v1.Metric.METRIC_L2: name was METRIC_L2 and is METRIC_SQUARES"},
      {[](auto* set) { Metric(set)->mutable_value(1)->set_number(2); },
       "v1.Metric.METRIC_L2 = 1: is gone"},
      {[](auto* set) { Remove(0, File(set)->mutable_service(0)->mutable_method()); },
       "v1.Fitter.Fit: is gone"},
      {[](auto* set) { Method(set, 0)->set_input_type(".v1.Map"); },
       "v1.Fitter.Fit: request was .v1.Light and is .v1.Map"},
      {[](auto* set) { Method(set, 0)->set_output_type(".v1.Light"); },
       "v1.Fitter.Fit: response was .v1.Map and is .v1.Light"},
      {[](auto* set) { Method(set, 0)->set_client_streaming(true); },
       "v1.Fitter.Fit: number of requests was one and is a stream"},
      {[](auto* set) { Method(set, 1)->clear_server_streaming(); },
       "v1.Fitter.Track: number of responses was a stream and is one"},
      {[](auto* set) { File(set)->clear_service(); }, "v1.Fitter: is gone"}};
  for (const auto& [change, words] : cases) {
    FileDescriptorSet now = Example();
    change(&now);
    EXPECT_THAT(BreakingChanges(Example(), now), ElementsAre(HasSubstr(words)));
  }
}

TEST(SchemaChanges, AdditionsAreNone) {
  const std::vector<Change> cases = {
      [](auto*) {},
      [](auto* set) {
        FieldDescriptorProto* field = Light(set)->add_field();
        *field = *Field(set, 1);
        field->set_name("title");
        field->set_number(7);
      },
      [](auto* set) { File(set)->add_message_type()->set_name("Camera"); },
      [](auto* set) {
        Metric(set)->add_value()->set_name("METRIC_L1");
        Metric(set)->mutable_value(2)->set_number(2);
      },
      [](auto* set) { *File(set)->mutable_service(0)->add_method() = *Method(set, 0); },
      [](auto* set) { set->add_file()->set_name("b.proto"); },
      [](auto* set) { Field(set, 1)->mutable_options()->set_deprecated(true); },
      [](auto* set) { Field(set, 1)->set_json_name("name"); },
      [](auto* set) { Light(set)->mutable_field()->SwapElements(0, 1); },
      [](auto* set) { Light(set)->mutable_reserved_range(0)->set_end(20); },
      [](auto* set) {
        Remove(1, Light(set)->mutable_field());
        auto* range = Light(set)->add_reserved_range();
        range->set_start(2);
        range->set_end(3);
        Light(set)->add_reserved_name("position");
      },
      [](auto* set) {
        Remove(1, Metric(set)->mutable_value());
        auto* range = Metric(set)->add_reserved_range();
        range->set_start(1);
        range->set_end(1);
        Metric(set)->add_reserved_name("METRIC_L2");
      }};
  for (const Change& change : cases) {
    FileDescriptorSet now = Example();
    change(&now);
    EXPECT_THAT(BreakingChanges(Example(), now), IsEmpty());
  }
}

// Nothing of the real schema can go unnoticed: each field, value and method in turn.
TEST(SchemaChanges, EveryPartOfTheSchemaIsMissedWhenItGoes) {
  const FileDescriptorSet released = SchemaNow();
  int num_parts = 0;
  const auto expect_missed = [&](auto* entries, const FileDescriptorSet& now) {
    const auto kept = *entries;
    for (int i = 0; i < kept.size(); ++i) {
      entries->DeleteSubrange(i, 1);
      EXPECT_FALSE(BreakingChanges(released, now).empty()) << kept[i].ShortDebugString();
      *entries = kept;
      ++num_parts;
    }
  };
  FileDescriptorSet now = released;
  for (FileDescriptorProto& file : *now.mutable_file()) {
    expect_missed(file.mutable_message_type(), now);
    expect_missed(file.mutable_enum_type(), now);
    for (DescriptorProto& message : *file.mutable_message_type()) {
      expect_missed(message.mutable_field(), now);
      expect_missed(message.mutable_enum_type(), now);
      for (EnumDescriptorProto& values : *message.mutable_enum_type()) {
        expect_missed(values.mutable_value(), now);
      }
    }
    for (EnumDescriptorProto& values : *file.mutable_enum_type()) {
      expect_missed(values.mutable_value(), now);
    }
    for (auto& service : *file.mutable_service()) expect_missed(service.mutable_method(), now);
  }
  EXPECT_GT(num_parts, 200);
}

}  // namespace
}  // namespace lightfit
