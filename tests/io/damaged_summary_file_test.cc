// Summary files that were damaged by accident or on purpose: errors, or fits of finite numbers.

#include <gtest/gtest.h>

#include <cstdint>
#include <iostream>
#include <iterator>
#include <random>
#include <string>

#include "tests/io/summary_examples.h"

namespace lightfit {
namespace {

using testing::FileAround;
using testing::FitsOrSaysWhy;
using testing::YardBytes;
using testing::YardProto;

TEST(DamagedSummaryFile, EveryCutIsAnError) {
  const std::string& whole = YardBytes();
  for (size_t length = 0; length < whole.size(); ++length) {
    const absl::StatusOr<SummarySet> set = ParseSummarySet(whole.substr(0, length));
    ASSERT_EQ(set.status().code(), absl::StatusCode::kInvalidArgument) << length;
    ASSERT_FALSE(set.status().message().empty());
  }
}

std::string Damaged(std::string bytes, size_t first, std::mt19937* random) {
  const int count = 1 + static_cast<int>((*random)() % 4);
  for (int i = 0; i < count; ++i) {
    const size_t at = first + (*random)() % (bytes.size() - first);
    // A single bit, or any byte.
    bytes[at] =
        static_cast<char>((*random)() % 2 == 0 ? bytes[at] ^ 1 << (*random)() % 8 : (*random)());
  }
  return bytes;
}

TEST(DamagedSummaryFile, RandomDamageIsAnError) {
  std::mt19937 random(testing::kSeed);
  std::cout << "seed " << testing::kSeed << "\n";
  for (int i = 0; i < 1000; ++i) {
    const std::string bytes = Damaged(YardBytes(), 0, &random);
    if (bytes == YardBytes()) continue;
    EXPECT_EQ(ParseSummarySet(bytes).status().code(), absl::StatusCode::kInvalidArgument);
  }
}

// Damage that its maker has put the right checksum on: an error, or numbers that can be worked on.
TEST(DamagedSummaryFile, DamageWithARightChecksumIsAnErrorOrUsable) {
  std::mt19937 random(testing::kSeed);
  std::cout << "seed " << testing::kSeed << "\n";
  const std::string payload = YardBytes().substr(20);
  int errors = 0, usable = 0;
  for (int i = 0; i < 1000; ++i) {
    const absl::StatusOr<SummarySet> set =
        ParseSummarySet(FileAround(Damaged(payload, 0, &random)));
    if (set.ok()) {
      // Fits are slow beside the rest: a tenth of them.
      if (usable++ % 10 == 0) FitsOrSaysWhy(set->lights[random() % 3], set->options);
    } else {
      EXPECT_FALSE(set.status().message().empty());
      ++errors;
    }
  }
  std::cout << errors << " errors, " << usable << " usable\n";
  EXPECT_GT(errors, 500);
  EXPECT_GT(usable, 0);
}

// The worst numbers that pass the checks one by one.
TEST(DamagedSummaryFile, WildNumbersAreErrorsOrUsable) {
  std::mt19937 random(testing::kSeed);
  std::cout << "seed " << testing::kSeed << "\n";
  int errors = 0, usable = 0;
  for (int i = 0; i < 120; ++i) {
    v1::SummaryFile proto = YardProto();
    const double values[] = {1e100, -1e100, 1e-300, -1.0, 5e-324, 1e30, -1e-30};
    for (v1::LightSummary& light : *proto.mutable_lights()) {
      v1::SummaryTotal& total = *light.mutable_total();
      const double value = values[random() % std::size(values)];
      v1::ExactSum* sums[] = {
          total.mutable_tensor(static_cast<int>(random() % 36)),
          total.mutable_total_weight(),
          total.mutable_footprint_sum(),
          total.mutable_cover()->mutable_mean_ray(static_cast<int>(random() % 3))};
      v1::ExactSum& sum = *sums[random() % std::size(sums)];
      sum.clear_parts();
      sum.add_parts(value);
      if (random() % 4 == 0) total.mutable_cover()->set_far(1e100);
      if (random() % 4 == 0 && !light.light().position().empty()) {
        light.mutable_light()->set_position(0, 1e300 * value);
      }
    }
    const absl::StatusOr<SummarySet> set = ParseSummarySet(FileAround(proto.SerializeAsString()));
    if (set.ok()) {
      FitsOrSaysWhy(set->lights[random() % 3], set->options);
      ++usable;
    } else {
      ++errors;
    }
  }
  std::cout << errors << " errors, " << usable << " usable\n";
  EXPECT_GT(errors, 10);
  EXPECT_GT(usable, 10);
}

}  // namespace
}  // namespace lightfit
