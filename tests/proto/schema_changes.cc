#include "tests/proto/schema_changes.h"

#include <algorithm>
#include <map>

#include "absl/strings/str_cat.h"

namespace lightfit::testing {
namespace {

using google::protobuf::DescriptorProto;
using google::protobuf::EnumDescriptorProto;
using google::protobuf::EnumValueDescriptorProto;
using google::protobuf::FieldDescriptorProto;
using google::protobuf::FileDescriptorProto;
using google::protobuf::FileDescriptorSet;
using google::protobuf::MethodDescriptorProto;
using google::protobuf::ServiceDescriptorProto;

template <typename Proto>
struct Declared {
  const Proto* proto;
  std::string file;  // generated code is named after it
};

// Everything that a schema declares, by full name.
struct Schema {
  std::map<std::string, Declared<DescriptorProto>> messages;
  std::map<std::string, Declared<EnumDescriptorProto>> enums;
  std::map<std::string, Declared<ServiceDescriptorProto>> services;

  explicit Schema(const FileDescriptorSet& set) {
    for (const FileDescriptorProto& file : set.file()) {
      for (const DescriptorProto& message : file.message_type()) {
        AddMessage(message, file.package(), file.name());
      }
      for (const EnumDescriptorProto& values : file.enum_type()) {
        enums[absl::StrCat(file.package(), ".", values.name())] = {&values, file.name()};
      }
      for (const ServiceDescriptorProto& service : file.service()) {
        services[absl::StrCat(file.package(), ".", service.name())] = {&service, file.name()};
      }
    }
  }

  void AddMessage(const DescriptorProto& message,
                  const std::string& scope,
                  const std::string& file) {
    const std::string name = absl::StrCat(scope, ".", message.name());
    messages[name] = {&message, file};
    for (const DescriptorProto& nested : message.nested_type()) AddMessage(nested, name, file);
    for (const EnumDescriptorProto& values : message.enum_type()) {
      enums[absl::StrCat(name, ".", values.name())] = {&values, file};
    }
  }
};

class Comparison {
 public:
  std::vector<std::string> Of(const Schema& released, const Schema& now) {
    Compare(released.messages, now.messages);
    Compare(released.enums, now.enums);
    Compare(released.services, now.services);
    return changes_;
  }

 private:
  template <typename... Words>
  void Say(const Words&... words) {
    changes_.push_back(absl::StrCat(words...));
  }

  // Says when a property is not what it was.
  void CompareText(const std::string& name,
                   const char* property,
                   const std::string& before,
                   const std::string& after) {
    if (before != after) Say(name, ": ", property, " was ", before, " and is ", after);
  }

  template <typename Proto>
  void Compare(const std::map<std::string, Declared<Proto>>& released,
               const std::map<std::string, Declared<Proto>>& now) {
    for (const auto& [name, before] : released) {
      const auto found = now.find(name);
      if (found == now.end()) {
        Say(name, ": is gone");
        continue;
      }
      CompareText(name, "file", before.file, found->second.file);
      CompareDeclared(name, *before.proto, *found->second.proto);
    }
  }

  void CompareDeclared(const std::string& name,
                       const DescriptorProto& before,
                       const DescriptorProto& after) {
    CompareReserved(name, before, after);
    CompareNumbered(name, before.field(), after.field(), after, [&](const auto& a, const auto& b) {
      CompareField(absl::StrCat(name, ".", a.name()), before, a, after, b);
    });
  }

  void CompareDeclared(const std::string& name,
                       const EnumDescriptorProto& before,
                       const EnumDescriptorProto& after) {
    CompareReserved(name, before, after);
    CompareNumbered(name, before.value(), after.value(), after, [](const auto&, const auto&) {});
  }

  void CompareDeclared(const std::string& name,
                       const ServiceDescriptorProto& before,
                       const ServiceDescriptorProto& after) {
    for (const MethodDescriptorProto& a : before.method()) {
      const std::string path = absl::StrCat(name, ".", a.name());
      const auto found = std::find_if(
          after.method().begin(), after.method().end(), [&a](const MethodDescriptorProto& b) {
            return a.name() == b.name();
          });
      if (found == after.method().end()) {
        Say(path, ": is gone");
        continue;
      }
      const auto streams = [](bool is_streaming) { return is_streaming ? "a stream" : "one"; };
      CompareText(path, "request", a.input_type(), found->input_type());
      CompareText(path, "response", a.output_type(), found->output_type());
      CompareText(path,
                  "number of requests",
                  streams(a.client_streaming()),
                  streams(found->client_streaming()));
      CompareText(path,
                  "number of responses",
                  streams(a.server_streaming()),
                  streams(found->server_streaming()));
    }
  }

  // Fields of a message, or values of an enumeration. What has the same number is the same; what is
  // gone must leave number and name reserved, in `owner`.
  template <typename Entries, typename Owner, typename CompareEntry>
  void CompareNumbered(const std::string& name,
                       const Entries& before,
                       const Entries& after,
                       const Owner& owner,
                       const CompareEntry& compare_entry) {
    for (const auto& a : before) {
      const std::string path = absl::StrCat(name, ".", a.name());
      const auto found = std::find_if(
          after.begin(), after.end(), [&a](const auto& b) { return a.number() == b.number(); });
      if (found != after.end()) {
        CompareText(path, "name", a.name(), found->name());
        compare_entry(a, *found);
      } else if (!IsReserved(owner, a.number()) || !IsReserved(owner, a.name())) {
        Say(path, " = ", a.number(), ": is gone; reserve its number and its name");
      }
    }
  }

  void CompareField(const std::string& name,
                    const DescriptorProto& message_before,
                    const FieldDescriptorProto& before,
                    const DescriptorProto& message_after,
                    const FieldDescriptorProto& after) {
    const auto presence = [](const FieldDescriptorProto& field) {
      return field.proto3_optional() ? "explicit" : "implicit";
    };
    CompareText(name, "type", TypeOf(before), TypeOf(after));
    CompareText(name,
                "label",
                FieldDescriptorProto::Label_Name(before.label()),
                FieldDescriptorProto::Label_Name(after.label()));
    CompareText(name, "presence", presence(before), presence(after));
    CompareText(name, "oneof", OneofOf(message_before, before), OneofOf(message_after, after));
  }

  static std::string TypeOf(const FieldDescriptorProto& field) {
    return field.has_type_name() ? field.type_name()
                                 : FieldDescriptorProto::Type_Name(field.type());
  }

  static std::string OneofOf(const DescriptorProto& message, const FieldDescriptorProto& field) {
    // An optional field is the only one of a oneof that nobody wrote.
    if (!field.has_oneof_index() || field.proto3_optional()) return "none";
    return message.oneof_decl(field.oneof_index()).name();
  }

  // What was reserved stays so, and with it the names and numbers of what is gone.
  template <typename Owner>
  void CompareReserved(const std::string& name, const Owner& before, const Owner& after) {
    for (const std::string& word : before.reserved_name()) {
      if (!IsReserved(after, word)) Say(name, ": the name ", word, " is no longer reserved");
    }
    for (const auto& range : before.reserved_range()) {
      const bool is_kept = std::any_of(
          after.reserved_range().begin(), after.reserved_range().end(), [&range](const auto& r) {
            return r.start() <= range.start() && range.end() <= r.end();
          });
      if (!is_kept) Say(name, ": the number ", range.start(), " is no longer reserved");
    }
  }

  template <typename Owner>
  static bool IsReserved(const Owner& owner, const std::string& name) {
    const auto& names = owner.reserved_name();
    return std::find(names.begin(), names.end(), name) != names.end();
  }

  static bool IsReserved(const DescriptorProto& message, int number) {
    return std::any_of(message.reserved_range().begin(),
                       message.reserved_range().end(),
                       [number](const auto& r) { return r.start() <= number && number < r.end(); });
  }

  // Ranges of enumerations have their last number in them.
  static bool IsReserved(const EnumDescriptorProto& values, int number) {
    return std::any_of(
        values.reserved_range().begin(), values.reserved_range().end(), [number](const auto& r) {
          return r.start() <= number && number <= r.end();
        });
  }

  std::vector<std::string> changes_;
};

}  // namespace

std::vector<std::string> BreakingChanges(const FileDescriptorSet& released,
                                         const FileDescriptorSet& now) {
  return Comparison().Of(Schema(released), Schema(now));
}

}  // namespace lightfit::testing
