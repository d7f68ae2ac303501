#include "server/wire_message.h"

#include <grpcpp/impl/codegen/proto_utils.h>

#include <cstddef>
#include <limits>

#include "absl/strings/str_cat.h"

namespace lightfit {

using google::protobuf::MessageLite;

absl::Status ParseWire(grpc::ByteBuffer* bytes, google::protobuf::Message* message) {
  const grpc::Status status =
      grpc::GenericDeserialize<grpc::ProtoBufferReader, MessageLite>(bytes, message);
  if (status.ok()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("message cannot be parsed, want ",
                   message->GetTypeName(),
                   "; it was cut short, or comes from another schema"));
}

absl::Status SerializeWire(const google::protobuf::Message& message, grpc::ByteBuffer* bytes) {
  const size_t size = message.ByteSizeLong();
  bool is_owned = false;
  if (size <= static_cast<size_t>(std::numeric_limits<int>::max()) &&
      grpc::GenericSerialize<grpc::ProtoBufferWriter, MessageLite>(message, bytes, &is_owned)
          .ok()) {
    return absl::OkStatus();
  }
  return absl::InternalError(
      absl::StrCat("the answer has ", size, " bytes, which no message may have; ask for less"));
}

}  // namespace lightfit
