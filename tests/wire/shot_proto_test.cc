// What a shot's frame has beside its matrices, written and read back.

#include "wire/shot_proto.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "wire/proto_json.h"

namespace lightfit {
namespace {

TEST(ShotProto, EveryActionHasItsOwnWord) {
  std::set<v1::TrackerAction> words;
  for (const TrackerAction action : {TrackerAction::kFirst,
                                     TrackerAction::kKept,
                                     TrackerAction::kShifted,
                                     TrackerAction::kRelaid,
                                     TrackerAction::kReplaced,
                                     TrackerAction::kInvalid}) {
    words.insert(TrackerActionToProto(action));
  }
  EXPECT_EQ(words.size(), 6u);
  EXPECT_EQ(words.count(v1::TRACKER_ACTION_UNSPECIFIED), 0u);
}

TEST(ShotProto, SettingsAreThoseOfTheTracker) {
  const v1::TrackerSettings settings = TrackerSettingsToProto(TrackerOptions::AsPublished());
  EXPECT_EQ(settings.keeps(), v1::TRACKER_KEEPS_AXIS);
  EXPECT_EQ(settings.replace_below(), 0.8);
  EXPECT_EQ(settings.update_every_frames(), 3);
  EXPECT_EQ(settings.cover_margin_percent(), 0.0);
  EXPECT_TRUE(settings.hard_validity());
}

// A tracker that goes on from a file must not differ in the last bit.
TEST(ShotProto, StatesReadBackExactly) {
  const std::vector<Light> lights = {Light::Directional("sun", {0, 0.1, -1}, 3),
                                     Light::Point("key", {1, 2, 3}, 5)};
  constexpr uint32_t kSeed = 3;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> exponent(-12.0, 12.0);
  v1::ShotInfo shot;
  std::vector<TrackedState> states;
  for (const Light& light : lights) {
    TrackedState state = {light, {64, 32}, Border::kDark, Eigen::Matrix4d::Zero(), 17, 2};
    for (int i = 0; i < 16; ++i) state.map_from_world(i) = -std::pow(10.0, exponent(random));
    *shot.add_tracker_state() = TrackedStateToProto(state);
    states.push_back(state);
  }
  v1::ShotInfo read;
  ASSERT_TRUE(JsonToProto(ProtoToJson(shot).value(), read).ok());
  const auto back = TrackedStatesFromProto(read, lights, {64, 32});
  ASSERT_TRUE(back.ok()) << back.status();
  ASSERT_EQ(back->size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ((*back)[i].light.name, lights[i].name);
    EXPECT_EQ((*back)[i].light.shadow_bit, lights[i].shadow_bit);
    EXPECT_EQ((*back)[i].map_from_world, states[i].map_from_world) << "seed " << kSeed;
    EXPECT_EQ((*back)[i].frames_kept, 17);
    EXPECT_EQ((*back)[i].frames_since_update, 2);
  }
  // A light that is gone is forgotten.
  EXPECT_EQ(TrackedStatesFromProto(read, {lights[1]}, {64, 32})->size(), 1u);
}

TEST(ShotProto, RefusesMatricesThatAreNone) {
  v1::ShotInfo shot;
  shot.add_tracker_state()->set_light("sun");
  const std::vector<Light> lights = {Light::Directional("sun", {0, 0, -1})};
  EXPECT_FALSE(TrackedStatesFromProto(shot, lights, {64, 64}).ok());
}

}  // namespace
}  // namespace lightfit
