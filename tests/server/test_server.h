// tests/server/test_server.h
//
// A server in this process, on a free port, and a client of it.
#pragma once

#include <gmock/gmock.h>
#include <grpc/grpc.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "calls/pixel_buffer.h"
#include "lightfit/v1/service.grpc.pb.h"
#include "server/server.h"
#include "tests/calls/requests.h"
#include "tests/io/summary_examples.h"
#include "tests/testing/plane_readback.h"
#include "wire/options_proto.h"

namespace lightfit::testing {

inline ServerOptions QuietOptions() {
  ServerOptions options;
  options.listen = "127.0.0.1:0";
  options.log_level = "error";
  return options;
}

class TestServer {
 public:
  explicit TestServer(const ServerOptions& options = QuietOptions()) {
    // gRPC that comes down with its last object waits up to ten seconds for a client's poller.
    static const bool is_kept_up = [] {
      grpc_init();
      return true;
    }();
    (void)is_kept_up;
    auto server = Server::Start(options);
    EXPECT_TRUE(server.ok()) << server.status();
    if (!server.ok()) return;
    server_ = *std::move(server);
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
    channel_ = grpc::CreateCustomChannel(
        server_->address(), grpc::InsecureChannelCredentials(), arguments);
    stub_ = v1::LightFit::NewStub(channel_);
  }

  Server& server() { return *server_; }
  const std::shared_ptr<grpc::Channel>& channel() { return channel_; }
  v1::LightFit::Stub& stub() { return *stub_; }

 private:
  std::unique_ptr<Server> server_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::LightFit::Stub> stub_;
};

template <typename Request>
Request WithMap(Request request) {
  request.mutable_map()->set_width(kMap.width);
  request.mutable_map()->set_height(kMap.height);
  return request;
}

// Where the plane of every other light, as shadows do, says something; it is made up.
inline v1::Readback WithFacingPlanes(v1::Readback readback, int num_lights) {
  const size_t num_pixels = readback.depth().size() / 4;
  for (int light = 0; light < num_lights; ++light) {
    std::string* plane = readback.add_facing_planes();
    if (light % 2 == 0) plane->assign(num_pixels - num_pixels / 3, '\xff');
    if (light % 2 == 0) plane->resize(num_pixels, '\0');
  }
  return readback;
}

inline v1::FitRequest YardFitRequest() {
  return WithMap(RequestOf<v1::FitRequest>(Yard().file.View(), Yard().lights));
}

// A fit of a large read-back, sample by sample: seconds of work, unless it is stopped.
inline v1::FitRequest LongFitRequest() {
  constexpr int kWidth = 1280, kHeight = 960;
  PlaneReadback floor = FloorReadback(FloorCamera(kWidth, kHeight));
  std::vector<Light> lights;
  for (int bit = 0; bit < 32; ++bit) {
    floor.Cast(bit, [&](int x, int y) { return (x / (20 + bit) + y / 30) % 2 == 0; });
    lights.push_back(
        Light::Directional("sun" + std::to_string(bit), {0.02 * bit - 0.3, 0.3, -1.0}, bit));
  }
  v1::FitRequest request = WithMap(RequestOf<v1::FitRequest>(floor.View(), lights));
  *request.mutable_options() = FitOptionsToProto(FitOptions::AsPublished());
  request.mutable_options()->set_sample_by_sample(true);
  return request;
}

// A stream's messages: the request, then its pixels in chunks.
inline std::vector<v1::PixelChunk> Chunks(const v1::Readback& readback, size_t chunk_bytes) {
  std::vector<v1::PixelChunk> chunks;
  for (size_t at = 0; at < readback.depth().size(); at += chunk_bytes) {
    chunks.emplace_back().set_depth(readback.depth().substr(at, chunk_bytes));
  }
  for (size_t at = 0; at < readback.shadow_bits().size(); at += chunk_bytes) {
    chunks.emplace_back().set_shadow_bits(readback.shadow_bits().substr(at, chunk_bytes));
  }
  for (int light = 0; light < readback.facing_planes_size(); ++light) {
    const std::string& plane = readback.facing_planes(light);
    for (size_t at = 0; at < plane.size(); at += chunk_bytes) {
      chunks.emplace_back().set_facing_plane(plane.substr(at, chunk_bytes));
      chunks.back().set_facing_plane_index(light);
    }
  }
  return chunks;
}

// Says of facing planes that they follow, and of which lights.
inline v1::Readback WithoutPixels(v1::Readback readback) {
  uint32_t lights = 0;
  for (int light = 0; light < readback.facing_planes_size(); ++light) {
    if (!readback.facing_planes(light).empty()) lights |= uint32_t{1} << light;
  }
  if (lights != 0) {
    readback.set_facing_format(v1::SHADOW_FORMAT_PLANES);
    readback.set_facing_lights(lights);
  }
  ClearPixels(&readback);
  return readback;
}

inline grpc::Status FitInStream(v1::LightFit::Stub& stub,
                                const v1::FitRequest& request,
                                size_t chunk_bytes,
                                grpc::ClientContext* context,
                                v1::FitResult* result) {
  const auto writer = stub.FitStream(context, result);
  v1::FitStreamRequest first;
  *first.mutable_request() = request;
  *first.mutable_request()->mutable_readback() = WithoutPixels(request.readback());
  bool is_open = writer->Write(first);
  for (const v1::PixelChunk& chunk : Chunks(request.readback(), chunk_bytes)) {
    if (!is_open) break;
    v1::FitStreamRequest part;
    *part.mutable_pixels() = chunk;
    is_open = writer->Write(part);
  }
  writer->WritesDone();
  return writer->Finish();
}

}  // namespace lightfit::testing
