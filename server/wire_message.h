// server/wire_message.h
//
// Messages as they travel.
// In:   the bytes of a message that may come from anywhere; a result.
// Out:  the message, or an error that the client is told; the bytes.
//
// gRPC's own reader tells a message that it cannot parse from nothing: of a stream it makes its
// end, and of a call of one request UNIMPLEMENTED without a word. So the service takes bytes.
#pragma once

#include <google/protobuf/message.h>
#include <grpcpp/impl/codegen/proto_utils.h>
#include <grpcpp/support/byte_buffer.h>

#include <cstddef>
#include <limits>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace lightfit {

// Takes the bytes, which are free afterwards. InvalidArgument names the message's type.
inline absl::Status ParseWire(grpc::ByteBuffer* bytes, google::protobuf::Message* message) {
  const grpc::Status status =
      grpc::GenericDeserialize<grpc::ProtoBufferReader, google::protobuf::MessageLite>(bytes,
                                                                                       message);
  if (status.ok()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("message cannot be parsed, want ",
                   message->GetTypeName(),
                   "; it was cut short, or comes from another schema"));
}

// Internal when the message is larger than any may be.
inline absl::Status SerializeWire(const google::protobuf::Message& message,
                                  grpc::ByteBuffer* bytes) {
  const size_t size = message.ByteSizeLong();
  bool is_owned = false;
  if (size <= static_cast<size_t>(std::numeric_limits<int>::max()) &&
      grpc::GenericSerialize<grpc::ProtoBufferWriter, google::protobuf::MessageLite>(
          message, bytes, &is_owned)
          .ok()) {
    return absl::OkStatus();
  }
  return absl::InternalError(
      absl::StrCat("the answer has ", size, " bytes, which no message may have; ask for less"));
}

}  // namespace lightfit
