#include "server/request_id.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <thread>
#include <vector>

namespace lightfit {
namespace {

using ::testing::MatchesRegex;

constexpr char kRandomId[] = "[0-9a-f]+";

void ExpectReplaced(const std::string& from_client) {
  const std::string id = RequestId(from_client);
  EXPECT_THAT(id, MatchesRegex(kRandomId)) << from_client;
  EXPECT_EQ(id.size(), 16) << from_client;
}

TEST(RequestId, PrintableNamesOfClientsAreKept) {
  const std::string longest(kMaxRequestIdBytes, 'x');
  const std::vector<std::string> kept = {"a", "shot 12/frame:0004 {\"~\"}", longest};
  for (const std::string& name : kept) EXPECT_EQ(RequestId(name), name);
}

TEST(RequestId, OthersAreReplaced) {
  ExpectReplaced("");
  ExpectReplaced(std::string(kMaxRequestIdBytes + 1, 'x'));
  ExpectReplaced("two\nlines");
  ExpectReplaced("\x1b[31mred");
  ExpectReplaced("caf\xc3\xa9");
  ExpectReplaced(std::string("a\0b", 3));
  ExpectReplaced("\x7f");
}

TEST(RequestId, RandomNamesDiffer) {
  constexpr size_t kNumPerThread = 1000;
  std::vector<std::string> names[4];
  {
    std::vector<std::jthread> threads;
    for (std::vector<std::string>& own : names) {
      threads.emplace_back([&own] {
        for (size_t i = 0; i < kNumPerThread; ++i) own.push_back(RequestId(""));
      });
    }
  }
  std::set<std::string> all;
  for (const std::vector<std::string>& own : names) all.insert(own.begin(), own.end());
  EXPECT_EQ(all.size(), 4 * kNumPerThread);
}

}  // namespace
}  // namespace lightfit
