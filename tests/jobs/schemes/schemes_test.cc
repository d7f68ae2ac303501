// Everybody's ways to set up a light's maps: what they spend, what they hold, how they are judged.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "jobs/compare/stage.h"
#include "jobs/schemes/asked_maps.h"
#include "jobs/schemes/fitted.h"
#include "jobs/schemes/judge_maps.h"
#include "jobs/schemes/published.h"
#include "jobs/schemes/shipped.h"
#include "partition/fit_plan.h"
#include "render/judge_plan.h"
#include "render/shipped/judge_rays.h"
#include "tests/jobs/compare/compare_scene.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

const Light kSun = Light::Directional("sun", {-1, -1.3, 0.4});
const Light kLamp = Light::Point("lamp", {0.5, 3.5, 1.0});  // among the boxes

constexpr SchemeBudget kBudget = {{120, 100}, 3};

class SchemesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    absl::StatusOr<RayCaster> caster = RayCaster::Build(BoxesOnFloor());
    ASSERT_THAT(caster, IsOk());
    caster_ = std::make_unique<RayCaster>(*std::move(caster));
    absl::StatusOr<CompareStage> stage = MakeStage(*caster_, BoxesCamera(120, 90), 80, 60);
    ASSERT_THAT(stage, IsOk());
    stage_ = *std::move(stage);
  }

  absl::StatusOr<SchemeMaps> SetUpFor(const Light& light, const Scheme& scheme) const {
    const LitStage lit = Lit(stage_, light);
    return scheme.set_up({stage_.view, *lit.surfaces, lit.light});
  }

  std::vector<Lighting> TruthOf(const Light& light) const {
    return TrueLighting(*caster_, stage_.screen, light);
  }

  std::unique_ptr<RayCaster> caster_;
  CompareStage stage_;
};

std::vector<Scheme> AllSchemes(const SchemeBudget& budget) {
  std::vector<Scheme> schemes;
  for (const Method method : AllMethods()) schemes.push_back(MethodScheme(method, budget));
  for (const auto& more :
       {SlicesSchemes(budget), PublishedSchemes(budget), ShippedSchemes(budget)}) {
    schemes.insert(schemes.end(), more.begin(), more.end());
  }
  return schemes;
}

// Null where there is none.
const Scheme* FindScheme(const std::vector<Scheme>& schemes, const std::string& name) {
  const auto named = [&name](const Scheme& scheme) { return scheme.name == name; };
  const auto found = std::find_if(schemes.begin(), schemes.end(), named);
  return found == schemes.end() ? nullptr : &*found;
}

// Of what engines ship, those for one kind of light alone.
const std::set<std::string> kSunsOnly = {"pages", "stable3"};
const std::set<std::string> kLampsOnly = {
    "cube", "cube, turned", "paraboloids", "paraboloids, drawn"};

bool IsFor(const Light& light, const std::string& name) {
  return (light.kind == Light::Kind::kPoint ? kSunsOnly : kLampsOnly).count(name) == 0;
}

TEST_F(SchemesTest, NoneSpendsMoreThanTheBudgetAndNamesDiffer) {
  std::set<std::string> names;
  int num_set_up = 0;
  for (const Scheme& scheme : AllSchemes(kBudget)) {
    EXPECT_TRUE(names.insert(scheme.name).second) << scheme.name;
    for (const Light& light : {kSun, kLamp}) {
      SCOPED_TRACE(absl::StrCat(scheme.name, ", ", light.name));
      const absl::StatusOr<SchemeMaps> maps = SetUpFor(light, scheme);
      if (!maps.ok()) {
        EXPECT_THAT(maps, StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr(light.name)));
        continue;
      }
      ++num_set_up;
      EXPECT_THAT(ValidateMaps(*maps, light), IsOk());
      EXPECT_GE(NumMaps(*maps), 1);
      EXPECT_LE(NumTexels(*maps), kBudget.texels());
      EXPECT_GT(NumTexels(*maps), kBudget.texels() / 3);
    }
  }
  for (const char* name : {"ZP3+LiSPSM", "ZP3", "PSSM3", "stable3", "SDSM3", "pages", "cube"}) {
    EXPECT_THAT(names, Contains(name));
  }
  EXPECT_GT(num_set_up, 20);
}

TEST_F(SchemesTest, ThoseOfTheOtherKindOfLightSaySo) {
  const std::vector<Scheme> schemes = AllSchemes(kBudget);
  for (const auto& [names, light] : {std::pair{kSunsOnly, kLamp}, {kLampsOnly, kSun}}) {
    for (const std::string& name : names) {
      const Scheme* scheme = FindScheme(schemes, name);
      ASSERT_NE(scheme, nullptr) << name;
      EXPECT_THAT(SetUpFor(light, *scheme),
                  StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("lights")));
    }
  }
}

// A filter of twice the guard's width finds texels of the map for all that the camera sees.
TEST_F(SchemesTest, GuardedMapsKeepReceiversOffTheirEdges) {
  SchemeBudget guarded = kBudget;
  guarded.guard_texels = 2.5;
  std::vector<Scheme> schemes = SlicesSchemes(guarded);
  for (const Method method : AllMethods()) schemes.push_back(MethodScheme(method, guarded));
  for (const auto& more : {PublishedSchemes(guarded), CascadeSchemes(guarded)}) {
    schemes.insert(schemes.end(), more.begin(), more.end());
  }
  for (const Scheme& scheme : schemes) {
    SCOPED_TRACE(scheme.name);
    const absl::StatusOr<SchemeMaps> maps = SetUpFor(kSun, scheme);
    ASSERT_THAT(maps, IsOk());
    EXPECT_EQ(maps->guard_texels, 2.5);
    EXPECT_LE(NumTexels(*maps), guarded.texels());
    const std::vector<int> asked = AskedMaps(*maps, kSun, stage_.readback_surfaces);
    for (size_t i = 0; i < asked.size(); ++i) {
      const bool is_surface = stage_.readback_surfaces.pixels[i].is_surface();
      ASSERT_EQ(asked[i] >= 0, is_surface) << "pixel " << i;
    }
  }
}

TEST_F(SchemesTest, AFittedSchemeIsTheFit) {
  PlanOptions options;
  options.max_maps = 3;
  options.texels = kBudget.texels();
  options.guard_texels = 1.0;
  const LitStage lit = Lit(stage_, kSun);
  const absl::StatusOr<LightPlan> fit = FitPlan(**lit.surfaces, lit.light, options);
  ASSERT_THAT(fit, IsOk());
  const absl::StatusOr<SchemeMaps> maps = SetUpFor(kSun, FittedScheme("ours", options));
  ASSERT_THAT(maps, IsOk());
  ASSERT_NE(PlanOf(*maps), nullptr);
  ASSERT_EQ(PlanOf(*maps)->maps.size(), fit->maps.size());
  for (size_t k = 0; k < fit->maps.size(); ++k) {
    EXPECT_EQ(PlanOf(*maps)->maps[k].map_from_world, fit->maps[k].map_from_world);
  }
  EXPECT_EQ(maps->guard_texels, 1.0);
  EXPECT_EQ(BorderOf(*maps), fit->border);
}

// Whatever kind the maps are of, they are judged by the judge of that kind.
TEST_F(SchemesTest, EveryKindOfMapsHasItsJudge) {
  const auto expect_same = [](const absl::StatusOr<ShadowImage>& a,
                              const absl::StatusOr<ShadowImage>& b) {
    ASSERT_THAT(a, IsOk());
    ASSERT_THAT(b, IsOk());
    EXPECT_EQ(a->ideal, b->ideal);
    EXPECT_EQ(a->practical, b->practical);
    EXPECT_EQ(a->wrong.ideal, b->wrong.ideal);
    EXPECT_GT(a->wrong.ideal, 0);
  };
  const RayCaster& caster = *caster_;
  const SurfaceImage& screen = stage_.screen;
  int num_judged = 0;
  for (const Light& light : {kSun, kLamp}) {
    const std::vector<Lighting> truth = TruthOf(light);
    for (const Scheme& scheme : ShippedSchemes(kBudget)) {
      SCOPED_TRACE(absl::StrCat(scheme.name, ", ", light.name));
      if (!IsFor(light, scheme.name)) continue;
      const absl::StatusOr<SchemeMaps> maps = SetUpFor(light, scheme);
      ASSERT_THAT(maps, IsOk());
      ++num_judged;
      const auto judged = JudgeMaps(caster, screen, truth, light, *maps);
      if (scheme.name == "pages") {
        expect_same(judged,
                    JudgePages(caster, screen, truth, light, std::get<PagedMap>(maps->maps)));
      } else if (scheme.name == "paraboloids") {
        const auto& pair = std::get<ParaboloidPair>(maps->maps);
        expect_same(judged, JudgeParaboloids(caster, screen, truth, light, pair));
      } else if (scheme.name == "paraboloids, drawn") {
        const auto& pair = std::get<RasterisedPair>(maps->maps).pair;
        expect_same(judged, JudgeDrawnParaboloids(caster, screen, truth, light, pair));
      } else {
        expect_same(judged, JudgePlan(caster, screen, truth, light, *PlanOf(*maps)));
      }
    }
  }
  EXPECT_EQ(num_judged, 3 + 5);  // of the sun and of the lamp
}

TEST_F(SchemesTest, TheFirstPhaseIsThatOfAllPhases) {
  JudgeOptions options;
  options.phases = 4;
  for (const auto& [light, name] : {std::pair{kSun, "pages"}, {kSun, "SDSM3"}, {kLamp, "cube"}}) {
    SCOPED_TRACE(name);
    const std::vector<Scheme> schemes = ShippedSchemes(kBudget);
    const Scheme* scheme = FindScheme(schemes, name);
    ASSERT_NE(scheme, nullptr);
    const absl::StatusOr<SchemeMaps> maps = SetUpFor(light, *scheme);
    ASSERT_THAT(maps, IsOk());
    const std::vector<Lighting> truth = TruthOf(light);
    const auto all = JudgeMaps(*caster_, stage_.screen, truth, light, *maps, options);
    const auto first = JudgeMapsFirstPhase(*caster_, stage_.screen, truth, light, *maps, options);
    ASSERT_THAT(all, IsOk());
    ASSERT_THAT(first, IsOk());
    EXPECT_EQ(all->ideal, first->ideal);
    EXPECT_EQ(all->practical, first->practical);
  }
}

TEST_F(SchemesTest, WhatAPixelAsksIsAMapOfTheScheme) {
  for (const auto& [light, name, num_numbers] : {std::tuple{kSun, "stable3", 3},
                                                 {kSun, "pages", 8},
                                                 {kLamp, "paraboloids", 2},
                                                 {kLamp, "paraboloids, drawn", 2}}) {
    SCOPED_TRACE(name);
    const std::vector<Scheme> schemes = ShippedSchemes(kBudget);
    const Scheme* scheme = FindScheme(schemes, name);
    ASSERT_NE(scheme, nullptr);
    const absl::StatusOr<SchemeMaps> maps = SetUpFor(light, *scheme);
    ASSERT_THAT(maps, IsOk());
    const std::vector<int> asked = AskedMaps(*maps, light, stage_.screen);
    ASSERT_EQ(asked.size(), stage_.screen.pixels.size());
    std::set<int> numbers;
    for (size_t i = 0; i < asked.size(); ++i) {
      EXPECT_EQ(asked[i] < 0, !stage_.screen.pixels[i].is_surface());
      if (asked[i] >= 0) numbers.insert(asked[i]);
    }
    EXPECT_GE(numbers.size(), 2u);
    EXPECT_LT(*numbers.rbegin(), num_numbers);
  }
}

TEST_F(SchemesTest, SmallBudgetsHaveSmallerPages) {
  const absl::StatusOr<SchemeMaps> maps = SetUpFor(kSun, PagesScheme("pages", {.map = {60, 50}}));
  ASSERT_THAT(maps, IsOk());
  EXPECT_EQ(std::get<PagedMap>(maps->maps).page_side, 16);
  EXPECT_LE(NumTexels(*maps), 3000);
}

TEST_F(SchemesTest, APlanThatCannotBeLookedUpIsRefused) {
  SchemeMaps maps;
  EXPECT_THAT(ValidateMaps(maps, kSun),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("map")));
  const absl::StatusOr<SchemeMaps> focused =
      SetUpFor(kSun, MethodScheme(Method::kFocused, kBudget));
  ASSERT_THAT(focused, IsOk());
  maps = *focused;
  EXPECT_THAT(ValidateMaps(maps, kSun), IsOk());
  maps.guard_texels = 50.0;  // of 100 rows nothing is left
  EXPECT_THAT(ValidateMaps(maps, kSun),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("map")));
  EXPECT_THAT(ValidateMaps(*focused, Light::Directional("moon", {1, -1, 0})),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("light")));
}

}  // namespace
}  // namespace lightfit
