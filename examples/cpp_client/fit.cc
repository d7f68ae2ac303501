// A client of `lightfit serve`: streams a read-back of any size, prints the lightfit.v1.FitResult
// as JSON.
//   cpp_client 127.0.0.1:50071 request.json depth.f32 shadow.u32
// examples/write_request.py writes the three files.
#include <google/protobuf/util/json_util.h>
#include <grpcpp/grpcpp.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <regex>
#include <string>

#include "lightfit/v1/service.grpc.pb.h"

namespace {

constexpr size_t kChunkBytes = 1 << 20;

std::string ReadFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// gRPC sends every connection through a proxy of the environment, those to this machine too.
bool IsThisMachine(const std::string& address) {
  static const std::regex pattern(
      R"((unix|unix-abstract):.*|((dns|ipv4|ipv6):/*)?(localhost|127\.[0-9.]+|\[::1\]):[0-9]+)",
      std::regex::icase);
  return std::regex_match(address, pattern);
}

// The variable that gRPC takes its proxy from; null: there is none.
const char* ProxyVariable() {
  for (const char* name : {"grpc_proxy", "https_proxy", "http_proxy"}) {
    if (std::getenv(name) != nullptr) return name;  // NOLINT(concurrency-mt-unsafe): one thread
  }
  return nullptr;
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): out of memory ends it
  if (argc != 5) {
    std::fprintf(stderr, "usage: cpp_client HOST:PORT request.json depth.f32 shadow.u32\n");
    return 1;
  }
  lightfit::v1::FitStreamRequest first;
  const auto parsed =
      google::protobuf::util::JsonStringToMessage(ReadFile(argv[2]), first.mutable_request());
  if (!parsed.ok()) {
    std::fprintf(stderr, "%s: %s\n", argv[2], parsed.ToString().c_str());
    return 1;
  }

  const bool is_direct = IsThisMachine(argv[1]);
  grpc::ChannelArguments arguments;
  if (is_direct) arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  const std::unique_ptr<lightfit::v1::LightFit::Stub> stub = lightfit::v1::LightFit::NewStub(
      grpc::CreateCustomChannel(argv[1], grpc::InsecureChannelCredentials(), arguments));
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));
  lightfit::v1::FitResult result;
  const auto stream = stub->FitStream(&context, &result);

  // A write fails when the server has ended the call; Finish() says why.
  bool open = stream->Write(first);
  const std::string depth = ReadFile(argv[3]);
  for (size_t begin = 0; open && begin < depth.size(); begin += kChunkBytes) {
    lightfit::v1::FitStreamRequest part;
    part.mutable_pixels()->set_depth(depth.substr(begin, kChunkBytes));
    open = stream->Write(part);
  }
  const std::string shadow_bits = ReadFile(argv[4]);
  for (size_t begin = 0; open && begin < shadow_bits.size(); begin += kChunkBytes) {
    lightfit::v1::FitStreamRequest part;
    part.mutable_pixels()->set_shadow_bits(shadow_bits.substr(begin, kChunkBytes));
    open = stream->Write(part);
  }
  stream->WritesDone();
  const grpc::Status status = stream->Finish();
  if (!status.ok()) {
    std::fprintf(stderr, "%s: %s\n", argv[1], status.error_message().c_str());
    if (const char* variable = ProxyVariable(); variable != nullptr && !is_direct) {
      std::fprintf(stderr, "unless no_proxy names it, it was asked through %s\n", variable);
    }
    return 1;
  }

  std::string json;
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  const auto printed = google::protobuf::util::MessageToJsonString(result, &json, options);
  std::printf("%s", json.c_str());
  return printed.ok() ? 0 : 1;
}
