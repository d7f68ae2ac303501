// calls/message_text.h
//
// Words of messages that quote what came from outside.
// In:   bytes of any kind and length: names, file names, messages in summaries.
// Out:  UTF-8, as strings of the schema must be, and short enough for a status.
#pragma once

#include <google/protobuf/repeated_field.h>

#include <string>

#include "absl/strings/string_view.h"
#include "lightfit/v1/result.pb.h"

namespace lightfit {

// Bytes that are not UTF-8 become '?'.
std::string Utf8Text(absl::string_view bytes);

// The same in quotes, and without what goes beyond 64 bytes.
std::string Quoted(absl::string_view name);

// Makes the messages of all statuses UTF-8.
void MakeMessagesUtf8(google::protobuf::RepeatedPtrField<v1::LightResult>* lights);

}  // namespace lightfit
