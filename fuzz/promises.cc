#include "fuzz/promises.h"

#include <cstdlib>
#include <iostream>
#include <memory>
#include <vector>

#include "absl/strings/str_cat.h"
#include "lightfit/v1/result.pb.h"
#include "wire/proto_json.h"
#include "wire/utf8.h"

namespace lightfit::fuzz {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

void PromiseStatuses(const Message& message) {
  if (message.GetDescriptor() == v1::Status::descriptor()) {
    const auto& status = static_cast<const v1::Status&>(message);
    PromiseOkOrError(absl::Status(static_cast<absl::StatusCode>(status.code()), status.message()));
    return;
  }
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  std::vector<const FieldDescriptor*> fields;
  reflection.ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) continue;
    if (!field->is_repeated()) {
      PromiseStatuses(reflection.GetMessage(message, field));
      continue;
    }
    for (int i = 0; i < reflection.FieldSize(message, field); ++i) {
      PromiseStatuses(reflection.GetRepeatedMessage(message, field, i));
    }
  }
}

}  // namespace

void Promise(bool holds, absl::string_view promise) {
  if (holds) return;
  std::cerr << "\nbroken promise: " << promise << std::endl;
  std::abort();
}

void PromiseError(const absl::Status& status) {
  Promise(!status.ok(), "this is an error");
  Promise(!status.message().empty(), "an error says what is wrong");
  Promise(Utf8Text(status.message()) == status.message(),
          absl::StrCat("an error is UTF-8: ", status.message()));
  Promise(
      status.code() != absl::StatusCode::kInternal && status.code() != absl::StatusCode::kUnknown,
      absl::StrCat("an error is one of the input: ", status.ToString()));
}

void PromiseOkOrError(const absl::Status& status) {
  if (!status.ok()) PromiseError(status);
}

void PromiseMessage(const Message& message) {
  const absl::Status finite = CheckFinite(message, message.GetTypeName());
  Promise(finite.ok(), absl::StrCat("all numbers are finite: ", finite.message()));
  const std::string bytes = message.SerializeAsString();
  const std::unique_ptr<Message> read(message.New());
  Promise(read->ParseFromString(bytes), "a message can be read again: its strings are UTF-8");
  Promise(read->SerializeAsString() == bytes, "a message read again is the same");
  PromiseStatuses(message);
}

}  // namespace lightfit::fuzz
