#include "wire/proto_json.h"

#include <google/protobuf/util/json_util.h>

#include <cmath>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "wire/utf8.h"

namespace lightfit {

absl::Status JsonToProto(absl::string_view json, google::protobuf::Message& message) {
  google::protobuf::util::JsonParseOptions options;
  options.ignore_unknown_fields = true;
  const auto status = google::protobuf::util::JsonStringToMessage(
      google::protobuf::StringPiece(json.data(), json.size()), &message, options);
  if (status.ok()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("is not the JSON of a ",
                   std::string(message.GetDescriptor()->full_name()),
                   ": ",
                   Utf8Text({status.message().data(), status.message().size()})));
}

absl::StatusOr<std::string> ProtoToJson(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  options.always_print_primitive_fields = true;
  std::string json;
  const auto status = google::protobuf::util::MessageToJsonString(message, &json, options);
  if (status.ok()) return json;
  return absl::InternalError(
      absl::StrCat("cannot be written as JSON: ",
                   std::string(status.message().data(), status.message().size())));
}

absl::Status CheckFinite(const google::protobuf::Message& message, const std::string& where) {
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  reflection.ListFields(message, &fields);
  for (const google::protobuf::FieldDescriptor* field : fields) {
    const bool repeated = field->is_repeated();
    const int count = repeated ? reflection.FieldSize(message, field) : 1;
    for (int i = 0; i < count; ++i) {
      std::string path = absl::StrCat(where, ".", field->name());
      if (repeated) absl::StrAppend(&path, "[", i, "]");
      if (field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE) {
        absl::Status status =
            CheckFinite(repeated ? reflection.GetRepeatedMessage(message, field, i)
                                 : reflection.GetMessage(message, field),
                        path);
        if (!status.ok()) return status;
      } else if (field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_DOUBLE) {
        const double value = repeated ? reflection.GetRepeatedDouble(message, field, i)
                                      : reflection.GetDouble(message, field);
        if (!std::isfinite(value)) {
          return absl::InternalError(absl::StrFormat("%s = %g, want a finite number", path, value));
        }
      }
    }
  }
  return absl::OkStatus();
}

}  // namespace lightfit
