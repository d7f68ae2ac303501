// tests/calls/requests.h
//
// Requests made of read-backs, and what every call owes to whatever comes in.
#pragma once

#include <gmock/gmock.h>
#include <google/protobuf/stubs/logging.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <iostream>
#include <random>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/types/span.h"
#include "calls/call_context.h"
#include "lightfit/v1/service.pb.h"
#include "optimizer/readback/readback.h"
#include "wire/camera_proto.h"
#include "wire/light_proto.h"
#include "wire/proto_json.h"

namespace lightfit::testing {

inline v1::FineCover FineCoverMessage(const FineCover& cover) {
  const auto bytes = [](const auto& values) {
    return std::string(reinterpret_cast<const char*>(values.data()), 4 * values.size());
  };
  v1::FineCover proto;
  proto.set_columns(cover.columns);
  proto.set_rows(cover.rows);
  proto.set_nearest(bytes(cover.nearest));
  proto.set_furthest(bytes(cover.furthest));
  proto.set_shadow_bits(bytes(cover.shadow_bits));
  proto.set_lit_bits(bytes(cover.lit_bits));
  if (!cover.lit_bits.empty()) proto.set_lit_lights(cover.lit_lights);
  return proto;
}

inline v1::Readback ReadbackMessage(const Readback& readback) {
  v1::Readback proto;
  *proto.mutable_camera() = CameraToProto(readback.camera, readback.depth_kind);
  const auto bytes = [](const auto& values) {
    return std::string(reinterpret_cast<const char*>(values.data()), 4 * values.size());
  };
  proto.set_depth(bytes(readback.depth));
  proto.set_shadow_bits(bytes(readback.shadow_bits));
  if (!readback.facing_bits.empty()) {
    proto.set_facing_bits(bytes(readback.facing_bits));
    proto.set_facing_lights(readback.facing_lights);
  }
  if (!readback.mapped_bits.empty()) {
    proto.set_mapped_bits(bytes(readback.mapped_bits));
    proto.set_mapped_lights(readback.mapped_lights);
  }
  return proto;
}

// Read-back and lights, the first fields of many requests. Light l must have shadow bit l.
template <typename Request>
Request RequestOf(const Readback& readback, absl::Span<const Light> lights) {
  Request request;
  *request.mutable_readback() = ReadbackMessage(readback);
  for (const Light& light : lights) *request.add_lights() = LightToProto(light);
  return request;
}

// One thing that is wrong with a request, and what the answer must say of it.
template <typename Request>
struct BadInput {
  std::function<void(Request*)> spoil;
  std::string words;
  absl::StatusCode code = absl::StatusCode::kInvalidArgument;
};

template <typename Request, typename Answer>
void ExpectRefused(const Request& good, const std::vector<BadInput<Request>>& bad, Answer answer) {
  for (const BadInput<Request>& input : bad) {
    Request request = good;
    input.spoil(&request);
    const absl::Status status = answer(request, CallContext()).status();
    EXPECT_EQ(status.code(), input.code) << input.words << "\n" << status;
    EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr(input.words));
  }
}

// Before it begins, and at moments drawn at random: CANCELLED, or the answer as it always is.
template <typename Request, typename Answer>
void ExpectStops(const Request& request, Answer answer) {
  std::stop_source stopped;
  stopped.request_stop();
  CallContext context;
  context.stop = stopped.get_token();
  EXPECT_EQ(answer(request, context).status().code(), absl::StatusCode::kCancelled);

  const auto begin = std::chrono::steady_clock::now();
  const auto whole = answer(request, CallContext());
  ASSERT_TRUE(whole.ok()) << whole.status();
  const std::chrono::duration<double> duration = std::chrono::steady_clock::now() - begin;
  constexpr uint32_t kSeed = 7;
  std::cout << "seed " << kSeed << "\n";
  std::mt19937 random(kSeed);
  for (int i = 0; i < 5; ++i) {
    std::stop_source source;
    context.stop = source.get_token();
    const double share = std::uniform_real_distribution<double>(0.0, 1.0)(random);
    std::thread stopper([&source, share, duration] {
      std::this_thread::sleep_for(share * duration);
      source.request_stop();
    });
    const auto result = answer(request, context);
    stopper.join();
    if (result.ok()) {
      EXPECT_EQ(result->SerializeAsString(), whole->SerializeAsString());
    } else {
      EXPECT_EQ(result.status().code(), absl::StatusCode::kCancelled) << result.status();
    }
  }
}

// Some bytes of it other, gone, there twice or new; mostly near the ends, where the fields are that
// are no pixels.
inline std::string Mutated(std::string bytes, std::mt19937* random) {
  const auto below = [random](size_t limit) { return (*random)() % limit; };
  for (size_t count = 1 + below(4); count > 0 && !bytes.empty(); --count) {
    constexpr size_t kNear = 400;  // bytes
    size_t at = below(bytes.size());
    if (const size_t where = below(3); where > 0) {
      at = below(std::min(kNear, bytes.size()));
      if (where == 2) at = bytes.size() - 1 - at;
    }
    switch (below(5)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ 1 << below(8));
        break;
      case 1:
        bytes[at] = static_cast<char>((*random)());
        break;
      case 2:
        bytes.erase(at, 1 + below(12));
        break;
      case 3:
        bytes.insert(at, bytes.substr(at, 1 + below(40)));
        break;
      case 4:  // infinities, NaN and huge integers are such runs
        for (size_t i = at; i < std::min(at + 8, bytes.size()); ++i) bytes[i] = '\xff';
        break;
    }
  }
  return bytes;
}

// Answers to damaged requests: a message of finite numbers and UTF-8 that says more than nothing,
// or a status whose message does.
template <typename Request, typename Answer>
void ExpectSurvivesMutations(const Request& request, Answer answer, int count) {
  constexpr uint32_t kSeed = 20261122;
  std::cout << "seed " << kSeed << "\n";
  std::mt19937 random(kSeed);
  const std::string bytes = request.SerializeAsString();
  const google::protobuf::LogSilencer silencer;  // it reports strings that are not UTF-8
  int num_parsed = 0, num_answered = 0;
  for (int i = 0; i < count; ++i) {
    Request mutated;
    if (!mutated.ParseFromString(Mutated(bytes, &random))) continue;
    ++num_parsed;
    const auto result = answer(mutated, CallContext());
    if (result.ok()) {
      ++num_answered;
      EXPECT_TRUE(CheckFinite(*result, "result").ok());
      auto read = *result;
      EXPECT_TRUE(read.ParseFromString(result->SerializeAsString()));  // fails on what is not UTF-8
      continue;
    }
    EXPECT_FALSE(result.status().message().empty());
    EXPECT_TRUE(result.status().code() == absl::StatusCode::kInvalidArgument ||
                result.status().code() == absl::StatusCode::kResourceExhausted)
        << result.status();
  }
  std::cout << num_parsed << " of " << count << " parse, " << num_answered << " are answered\n";
  EXPECT_GT(num_parsed, count / 20);
  EXPECT_GT(num_answered, 0);
  EXPECT_LT(num_answered, num_parsed);
}

}  // namespace lightfit::testing
