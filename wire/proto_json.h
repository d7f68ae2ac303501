// wire/proto_json.h
//
// Protobuf messages from and to JSON text, with our kind of status.
#pragma once

#include <google/protobuf/message.h>

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace lightfit {

// Fields that the message does not have are ignored.
absl::Status JsonToProto(absl::string_view json, google::protobuf::Message& message);

// camelCase names in schema order, indented, fields of value 0 included; ends with a new line.
absl::StatusOr<std::string> ProtoToJson(const google::protobuf::Message& message);

// Internal with the name of a field that is NaN or infinite, below `where`. They have no place in a
// result: a reader would have to expect strings for numbers.
absl::Status CheckFinite(const google::protobuf::Message& message, const std::string& where);

}  // namespace lightfit
