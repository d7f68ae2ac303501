#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "tests/testing/process.h"

namespace lightfit {
namespace {

// How many frames it skips depends on the machine; what it says about each does not.
TEST(FrameLoopExample, DrawsBothLightsWithMatricesOfThisFrameOrAnEarlierOne) {
  const ProcessResult result = RunProgram("frame_loop", {});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const std::regex expected(
      "frame (\\d+) draws (sun|lamp) with the matrix of frame (\\d+): "
      "(first|kept|shifted|relaid|replaced|invalid)");
  std::istringstream lines(result.out);
  std::set<std::string> lights;
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    ASSERT_TRUE(std::regex_match(line, match, expected)) << line;
    EXPECT_LE(std::stoi(match[3]), std::stoi(match[1])) << line;
    lights.insert(match[2]);
  }
  EXPECT_THAT(lights, ::testing::UnorderedElementsAre("sun", "lamp")) << result.out;
}

// The example is read as documentation: the whole loop on a page.
TEST(FrameLoopExample, FitsOnAPage) {
  std::istringstream source(ReadFile(RepositoryPath("examples/frame_loop/frame_loop.cc")));
  int num_lines = 0;
  for (std::string line; std::getline(source, line);) ++num_lines;
  EXPECT_GT(num_lines, 0);
  EXPECT_LE(num_lines, 60);
}

}  // namespace
}  // namespace lightfit
