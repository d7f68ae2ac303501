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
#include <grpcpp/support/byte_buffer.h>

#include "absl/status/status.h"

namespace lightfit {

// Takes the bytes, which are free afterwards. InvalidArgument names the message's type.
absl::Status ParseWire(grpc::ByteBuffer* bytes, google::protobuf::Message* message);

// Internal when the message is larger than any may be.
absl::Status SerializeWire(const google::protobuf::Message& message, grpc::ByteBuffer* bytes);

}  // namespace lightfit
