// fuzz/input_form.h
//
// What a target says of its input, so that custom_mutator.cc can change fields in place of bytes.
// In:   bytes as the target takes them.
// Out:  the message that they hold, and back.
#pragma once

#include <google/protobuf/message.h>

#include <memory>
#include <string>

#include "absl/strings/string_view.h"

namespace lightfit::fuzz {

enum class Encoding {
  kMessage,      // serialised
  kJson,         // protobuf JSON
  kSummaryFile,  // io/summary_file.h: the message in a frame with its length and checksum
};

struct InputForm {
  const google::protobuf::Message* prototype;
  Encoding encoding;
};

// Of the target that is linked in: those with a message in their input define it.
InputForm FormOfInput();

// Null when the bytes do not hold one.
std::unique_ptr<google::protobuf::Message> MessageOfInput(const InputForm& form,
                                                          absl::string_view bytes);

std::string InputOfMessage(const InputForm& form, const google::protobuf::Message& message);

}  // namespace lightfit::fuzz
