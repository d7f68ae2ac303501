#include "io/summary_file.h"

#include <zlib.h>

#include <cstdint>
#include <fstream>
#include <limits>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/text_file.h"
#include "wire/summary_proto.h"

namespace lightfit {

namespace {

constexpr absl::string_view kMagic("\x89LFS\r\n\x1a\n", 8);
constexpr size_t kHeaderBytes = 20;
constexpr int64_t kMaxFileBytes = int64_t{64}
                                  << 20;  // 32 lights of the largest hulls, and 10^6 frames

void AppendUint32(uint32_t value, std::string* bytes) {
  for (int shift = 0; shift < 32; shift += 8) bytes->push_back(static_cast<char>(value >> shift));
}

uint32_t Uint32At(absl::string_view bytes, size_t at) {
  uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<uint8_t>(bytes[at + i]);
  return value;
}

uint32_t ChecksumOf(absl::string_view bytes) {
  return static_cast<uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

absl::Status CheckHeader(absl::string_view bytes) {
  if (!absl::StartsWith(bytes, kMagic)) {
    return absl::InvalidArgumentError(
        bytes.empty() ? "is empty, want a file that lightfit summarize wrote"
                      : "is no summary file, want one that lightfit summarize wrote");
  }
  if (bytes.size() < kHeaderBytes) {
    return absl::InvalidArgumentError("is cut short: summarise its frames again, or copy it again");
  }
  const uint32_t version = Uint32At(bytes, 8);
  if (version != kSummaryFormatVersion) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "has format version %d, this lightfit reads %d: %s",
        version,
        kSummaryFormatVersion,
        version > kSummaryFormatVersion ? "update lightfit" : "summarise its frames again"));
  }
  const size_t want = kHeaderBytes + Uint32At(bytes, 12);
  if (bytes.size() != want) {
    return absl::InvalidArgumentError(
        absl::StrFormat("has %d bytes, and should have %d: summarise its frames again, or copy it "
                        "again",
                        bytes.size(),
                        want));
  }
  if (ChecksumOf(bytes.substr(kHeaderBytes)) != Uint32At(bytes, 16)) {
    return absl::InvalidArgumentError(
        "is damaged, its checksum is wrong: summarise its frames again, or copy it again");
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::string> SerializeSummarySet(const SummarySet& set, absl::string_view writer) {
  v1::SummaryFile proto = SummarySetToProto(set);
  proto.set_writer(std::string(writer));
  const std::string payload = proto.SerializeAsString();
  std::string bytes(kMagic);
  AppendUint32(kSummaryFormatVersion, &bytes);
  AppendUint32(static_cast<uint32_t>(payload.size()), &bytes);
  AppendUint32(ChecksumOf(payload), &bytes);
  bytes += payload;
  // What could not be read is not written: found here, not on another machine tomorrow.
  const absl::StatusOr<SummarySet> read = ParseSummarySet(bytes);
  if (!read.ok()) return read.status();
  return bytes;
}

absl::StatusOr<SummarySet> ParseSummarySet(absl::string_view bytes) {
  if (static_cast<int64_t>(bytes.size()) > kMaxFileBytes) {
    return absl::InvalidArgumentError(
        absl::StrFormat("has %d bytes, no summary has more than %d", bytes.size(), kMaxFileBytes));
  }
  if (absl::Status status = CheckHeader(bytes); !status.ok()) return status;
  const absl::string_view payload = bytes.substr(kHeaderBytes);
  v1::SummaryFile proto;
  if (!proto.ParseFromArray(payload.data(), static_cast<int>(payload.size()))) {
    return absl::InvalidArgumentError("does not hold a lightfit.v1.SummaryFile");
  }
  return SummarySetFromProto(proto);
}

absl::Status WriteSummaryFile(const std::string& path,
                              const SummarySet& set,
                              absl::string_view writer) {
  const absl::StatusOr<std::string> bytes = SerializeSummarySet(set, writer);
  if (!bytes.ok()) return InFile(path, bytes.status());
  return WriteTextFileAtomically(path, *bytes);
}

absl::StatusOr<SummarySet> ReadSummaryFile(const std::string& path) {
  const absl::StatusOr<std::string> bytes = ReadFileBytes(path, kMaxFileBytes);
  if (!bytes.ok()) return bytes.status();
  absl::StatusOr<SummarySet> set = ParseSummarySet(*bytes);
  if (!set.ok()) return InFile(path, set.status());
  return set;
}

bool IsSummaryFile(const std::string& path) {
  if (absl::EndsWith(path, ".summary")) return true;
  char start[kMagic.size()];
  std::ifstream file(path, std::ios::binary);
  return file.read(start, sizeof(start)) && absl::string_view(start, sizeof(start)) == kMagic;
}

int64_t SummaryBytes(const LightSummary& light) {
  return static_cast<int64_t>(LightSummaryToProto(light).ByteSizeLong());
}

}  // namespace lightfit
