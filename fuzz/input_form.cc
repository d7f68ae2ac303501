#include "fuzz/input_form.h"

#include <google/protobuf/stubs/logging.h>
#include <zlib.h>

#include <cstdint>

#include "absl/status/statusor.h"
#include "io/summary_file.h"
#include "wire/proto_json.h"

namespace lightfit::fuzz {
namespace {

using google::protobuf::Message;

constexpr size_t kFrameBytes = 20;  // before the payload of a summary file

std::string SummaryFileOf(const std::string& payload) {
  std::string bytes("\x89LFS\r\n\x1a\n", 8);
  const uLong checksum =
      crc32(0, reinterpret_cast<const Bytef*>(payload.data()), static_cast<uInt>(payload.size()));
  for (const uint64_t word : {uint64_t{kSummaryFormatVersion}, payload.size(), checksum}) {
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(word >> shift));
  }
  return bytes + payload;
}

}  // namespace

std::unique_ptr<Message> MessageOfInput(const InputForm& form, absl::string_view bytes) {
  std::unique_ptr<Message> message(form.prototype->New());
  const google::protobuf::LogSilencer silencer;  // it reports strings that are not UTF-8
  bool is_read = false;
  switch (form.encoding) {
    case Encoding::kJson:
      is_read = JsonToProto(bytes, *message).ok();
      break;
    case Encoding::kSummaryFile:
      if (bytes.size() < kFrameBytes) break;
      bytes.remove_prefix(kFrameBytes);
      [[fallthrough]];
    case Encoding::kMessage:
      is_read = message->ParseFromArray(bytes.data(), static_cast<int>(bytes.size()));
      break;
  }
  if (!is_read) message.reset();
  return message;
}

std::string InputOfMessage(const InputForm& form, const Message& message) {
  switch (form.encoding) {
    case Encoding::kJson:
      return ProtoToJson(message).value_or("");
    case Encoding::kSummaryFile:
      return SummaryFileOf(message.SerializeAsString());
    case Encoding::kMessage:
      break;
  }
  return message.SerializeAsString();
}

}  // namespace lightfit::fuzz
