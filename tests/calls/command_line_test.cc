// Calls give what the command line writes, bit for bit.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

#include "calls/allocate_call.h"
#include "calls/fit_call.h"
#include "calls/summary_call.h"
#include "io/fine_cover_exr.h"
#include "io/readback_exr.h"
#include "io/readback_exr_write.h"
#include "tests/calls/requests.h"
#include "tests/cli/allocations.h"
#include "tests/cli/summaries.h"
#include "tests/io/summary_examples.h"
#include "tests/testing/box_scene.h"
#include "wire/allocation_json.h"
#include "wire/light_proto.h"
#include "wire/proto_json.h"

namespace lightfit {
namespace {

using testing::Yard;

// `message` as it would be in the file, but for the name of what it was made from.
template <typename Message>
std::string JsonWithoutSource(Message message) {
  message.mutable_readback()->clear_source();
  message.mutable_readback()->clear_origin();
  return *ProtoToJson(message);
}

TEST(CommandLine, AllocateIsTheSame) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("maps.json");
  ASSERT_EQ(AllocateYard({"--budget", "1000000", "--quiet", "--json", path}).exit_code, 0);
  auto request = testing::RequestOf<v1::AllocateRequest>(Yard().file.View(), Yard().lights);
  request.set_budget_texels(1000000);
  const auto result = AnswerAllocate(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  EXPECT_EQ(JsonWithoutSource(*result), JsonWithoutSource(ReadAllocation(path)));
}

// With any sizes, and with those that are allowed.
TEST(CommandLine, AllocateOfPlansIsTheSame) {
  const auto compare = [](const Arguments& more, const auto& fill) {
    SCOPED_TRACE(more.back());
    const TemporaryFolder folder;
    const std::string path = folder.Path("maps.json");
    const Arguments budget = {"--budget", "360000", "--quiet", "--json", path};
    ASSERT_EQ(AllocateYard(Joined(budget, more)).exit_code, 0);
    auto request = testing::RequestOf<v1::AllocateRequest>(Yard().file.View(), Yard().lights);
    request.set_budget_texels(360000);
    fill(request.mutable_plan_options());
    const auto result = AnswerAllocate(request, CallContext());
    ASSERT_THAT(result, testing::IsOk());
    EXPECT_GT(result->lights(0).plan().maps_size(), 1);
    EXPECT_EQ(JsonWithoutSource(*result), JsonWithoutSource(ReadAllocation(path)));
  };
  compare({"--maps", "3", "--guard", "1.5"}, [](v1::PlanOptions* options) {
    options->set_max_maps(3);
    options->set_guard_texels(1.5);
  });
  compare({"--maps", "2", "--power-of-two", "--min-side", "32"}, [](v1::PlanOptions* options) {
    options->set_max_maps(2);
    options->mutable_sizes()->set_powers_of_two(true);
    options->mutable_sizes()->set_min_side(32);
  });
}

TEST(CommandLine, AllocateOfSummariesIsTheSame) {
  const TemporaryFolder folder;
  const std::string summary = YardSummary(folder, "yard.summary", {"--metric", "l2"});
  const std::string path = folder.Path("maps.json");
  const Arguments arguments = {
      "allocate", "--summary", summary, "--tolerance", "rms:1.0", "--quiet", "--json", path};
  ASSERT_EQ(RunLightfit(arguments).exit_code, 0);
  v1::AllocateRequest request;
  request.add_summary_files(ReadFile(summary));
  request.mutable_tolerance()->set_kind(v1::Tolerance::KIND_RMS);
  request.mutable_tolerance()->set_limit_px(1.0);
  const auto result = AnswerAllocate(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  EXPECT_EQ(JsonWithoutSource(*result), JsonWithoutSource(ReadAllocation(path)));
}

TEST(CommandLine, FitOfSummariesIsTheSame) {
  const TemporaryFolder folder;
  const std::string summary = YardSummary(folder, "yard.summary");
  const std::string other = folder.Path("other.summary");
  RunSummarize({YardFrame(folder, "0002.exr"), "--lights", kYardLights, "-o", other});
  const std::string path = folder.Path("fit.json");
  const Arguments arguments = {
      "fit", "--summary", summary, other, "--map", "512x256", "--quiet", "--json", path};
  ASSERT_EQ(RunLightfit(arguments).exit_code, 0);
  v1::FitSummaryRequest request;
  for (const std::string& file : {summary, other}) request.add_summary_files(ReadFile(file));
  request.mutable_map()->set_width(512);
  request.mutable_map()->set_height(256);
  const auto result = AnswerFitSummary(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  EXPECT_EQ(JsonWithoutSource(*result), JsonWithoutSource(ReadResult(path)));
}

// The yardsticks are the command line's alone.
v1::FitResult WithoutYardsticks(v1::FitResult result) {
  for (v1::LightResult& light : *result.mutable_lights()) {
    for (const char* field : {"focused",
                              "as_published",
                              "one_map",
                              "final_over_focused",
                              "final_over_as_published",
                              "final_over_one_map"}) {
      for (google::protobuf::Message* message : std::initializer_list<google::protobuf::Message*>{
               light.mutable_energies(), light.mutable_foretold_wrong()}) {
        const auto* found = message->GetDescriptor()->FindFieldByName(field);
        if (found != nullptr) message->GetReflection()->ClearField(message, found);
      }
    }
  }
  return result;
}

// Whatever the sizes of maps, and of one map too.
TEST(CommandLine, PlansAreTheSame) {
  const auto compare = [](const Arguments& more, const auto& fill) {
    SCOPED_TRACE(more[1]);
    const TemporaryFolder folder;
    const std::string path = folder.Path("plan.json");
    const Arguments fit = {"fit", kYard, "--lights", kYardLights, "--quiet", "--json", path};
    ASSERT_EQ(RunLightfit(Joined(fit, more)).exit_code, 0);
    auto request = testing::RequestOf<v1::FitRequest>(Yard().file.View(), Yard().lights);
    request.set_foretell_wrong(true);
    request.mutable_options()->set_border(v1::BORDER_CHOICE_AUTOMATIC);
    fill(request.mutable_plan_options());
    const auto result = AnswerFit(request, CallContext());
    ASSERT_THAT(result, testing::IsOk());
    EXPECT_GT(result->lights(0).plan().maps_size(), 1);
    EXPECT_EQ(JsonWithoutSource(*result), JsonWithoutSource(WithoutYardsticks(ReadResult(path))));
  };
  compare({"--maps", "4", "--texels", "90000", "--guard", "1.5"}, [](v1::PlanOptions* options) {
    options->set_texels(90000);
    options->set_guard_texels(1.5);
  });
  compare({"--maps", "2", "--map", "256x128"}, [](v1::PlanOptions* options) {
    options->set_max_maps(2);
    options->mutable_each()->set_width(256);
    options->mutable_each()->set_height(128);
  });
}

// With a finer image of the same frame, borders chosen.
TEST(CommandLine, PlansWithAFinerCoverAreTheSame) {
  const TemporaryFolder folder;
  const BoxScene scene = MakeBoxScene(21);
  const std::vector<Light> lights = RandomLights(scene, 21, 2);
  v1::LightList list;
  for (const Light& light : lights) *list.add_lights() = LightToProto(light);
  WriteFile(folder.Path("lights.json"), ProtoToJson(list).value());
  const auto write = [&](const std::string& path, int width, int height) {
    const SyntheticReadback image = Render(scene, RandomCamera(scene, 21, width, height), lights);
    ASSERT_THAT(WriteReadbackExr(path, image.ViewWithFacing(), lights), testing::IsOk());
  };
  const std::string coarse = folder.Path("coarse.exr"), fine = folder.Path("fine.exr");
  write(coarse, 60, 40);
  write(fine, 240, 160);
  const std::string path = folder.Path("plan.json");
  ASSERT_EQ(RunLightfit({"fit",
                         coarse,
                         "--lights",
                         folder.Path("lights.json"),
                         "--cover-readback",
                         fine,
                         "--maps",
                         "2",
                         "--texels",
                         "90000",
                         "--quiet",
                         "--json",
                         path})
                .exit_code,
            0);
  const ReadbackFile file = ReadReadbackExr(coarse, lights).value();
  auto request = testing::RequestOf<v1::FitRequest>(file.View(), lights);
  const FineCoverFile fine_file = ReadFineCoverExr(fine, lights, {}, file).value();
  *request.mutable_readback()->mutable_fine_cover() = testing::FineCoverMessage(fine_file.View());
  request.set_foretell_wrong(true);
  request.mutable_options()->set_border(v1::BORDER_CHOICE_AUTOMATIC);
  request.mutable_plan_options()->set_max_maps(2);
  request.mutable_plan_options()->set_texels(90000);
  const auto result = AnswerFit(request, CallContext());
  ASSERT_THAT(result, testing::IsOk());
  EXPECT_EQ(JsonWithoutSource(*result), JsonWithoutSource(WithoutYardsticks(ReadResult(path))));
}

}  // namespace
}  // namespace lightfit
