// fuzz/promises.h
//
// What the library owes to whatever bytes come in.
// In:   an answer: a status, a message, or either.
// Out:  nothing; a broken promise ends the program, which is what fuzzers look for.
#pragma once

#include <google/protobuf/message.h>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace lightfit::fuzz {

// Says `promise` and ends the program unless it `holds`.
void Promise(bool holds, absl::string_view promise);

// An error says what is wrong, in UTF-8, and does not put it down to the library.
void PromiseError(const absl::Status& status);

// Ok, or as PromiseError().
void PromiseOkOrError(const absl::Status& status);

// No NaN and no infinity; the bytes can be read again, which needs UTF-8; every lightfit.v1.Status
// in it is as PromiseOkOrError().
void PromiseMessage(const google::protobuf::Message& message);

template <typename Message>
void PromiseAnswer(const absl::StatusOr<Message>& answer) {
  PromiseOkOrError(answer.status());
  if (answer.ok()) PromiseMessage(*answer);
}

}  // namespace lightfit::fuzz
