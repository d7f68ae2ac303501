// Small EXR files in the layouts and naming habits of renderers: each is read right or refused by
// name, whatever stands beside the depth and in whichever order.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <set>

#include "absl/strings/str_cat.h"
#include "io/readback_exr.h"
#include "tests/io/exr_file.h"
#include "tests/io/testing.h"

namespace lightfit {
namespace {

using testing::ExrPart;

constexpr int kWidth = 4, kHeight = 3;

// A channel and the part that it is in where there are parts.
struct Place {
  std::string channel, part;
};

// Blender, Arnold, RenderMan, V-Ray, Karma, Nuke and what compositors make of them. Names with a
// layer in them work in a file of one part too.
const Place kDepths[] = {{"Z", "depth"},
                         {"Z", "rgba"},
                         {"Z", "Z"},
                         {"z", "z"},
                         {"depth", "depth"},
                         {"Depth", "rgba"},
                         {"zdepth", "zdepth"},
                         {"Z_Depth", "utility"},
                         {"VRayZDepth", "VRayZDepth"},
                         {"Pz", "Pz"},
                         {"depth.V", "depth"},
                         {"depth.R", "depth"},
                         {"depth.Z", "depth"},
                         {"depth.Y", "data"},
                         {"zdepth.red", "rgba"},
                         {"ViewLayer.Depth.Z", "ViewLayer.Depth"},
                         {"View Layer.Depth.V", "rgba"},
                         {"cam1.Z", "cam1"},
                         {"V", "depth"},
                         {"R", "ViewLayer.Depth"},
                         {"red", "depth"},
                         {"Y", "Z"}};

// What stands beside it and is no depth. None of it can be one.
struct Company {
  const char* words;
  std::vector<Place> places;
  bool needs_parts = false;  // in one part it would be a depth
};

const Company kCompanies[] = {
    {"nothing", {}},
    {"position", {{"P.X", "P"}, {"P.Y", "P"}, {"P.Z", "P"}}},
    {"position in a part", {{"X", "P"}, {"Y", "P"}, {"Z", "P"}}},
    {"components as parts", {{"X", "P.X"}, {"Y", "P.Y"}, {"Z", "P.Z"}}},
    {"components without a point", {{"Qx", "aov"}, {"Qy", "aov"}, {"Qz", "aov"}}},
    {"lower case", {{"N.x", "N"}, {"N.y", "N"}, {"N.z", "N"}, {"n.x", "n2"}, {"n.z", "n2"}}},
    {"an unknown vector", {{"foo.X", "foo"}, {"foo.Y", "foo"}, {"foo.Z", "foo"}}},
    {"a vector in three parts", {{"foo.X", "a"}, {"foo.Y", "b"}, {"foo.Z", "c"}}},
    {"Blender's passes",
     {{"ViewLayer.Normal.X", "ViewLayer.Normal"},
      {"ViewLayer.Normal.Y", "ViewLayer.Normal"},
      {"ViewLayer.Normal.Z", "ViewLayer.Normal"},
      {"ViewLayer.Vector.X", "ViewLayer.Vector"},
      {"ViewLayer.Vector.Z", "ViewLayer.Vector"},
      {"ViewLayer.Mist.Z", "ViewLayer.Mist"},
      {"ViewLayer.Denoising Normal.Z", "ViewLayer.Denoising Normal"},
      {"ViewLayer.IndexOB.X", "ViewLayer.IndexOB"}}},
    {"a lone component", {{"P.Z", "P"}, {"Normal.Z", "Normal"}}},
    {"a lone component in a part", {{"Z", "N"}}, true},
    {"mist and filtered depth", {{"Mist.Z", "Mist"}, {"z_filtered.Z", "z_filtered"}}},
    {"a depth in colours",
     {{"depthrgb.depth.R", "c"}, {"depthrgb.depth.G", "c"}, {"depthrgb.depth.B", "c"}}},
    {"texture coordinates", {{"uv.U", "uv"}, {"uv.V", "uv"}, {"st.V", "st"}}},
    {"a light called Z", {{"shadow.Z", "shadow"}, {"facing.Z", "facing"}}}};

enum class Order { kOnePart, kDepthFirst, kDepthLast, kDepthBetween, kWithColour };
constexpr Order kOrders[] = {Order::kOnePart,
                             Order::kDepthFirst,
                             Order::kDepthLast,
                             Order::kDepthBetween,
                             Order::kWithColour};

// Of all pairs of a depth and its company some orders, all of them in turn: files take time.
bool IsDrawn(size_t depth, size_t company, size_t order) {
  return (depth + 2 * company + order) % 5 < 2;
}

// Whether only its part says that it is a depth.
bool NeedsPart(const std::string& channel) {
  return channel == "V" || channel == "R" || channel == "red" || channel == "Y";
}

// Where nobody can tell: a Z beside X and Y, and the part Pz in a file with the part P.X.
bool MayBeAVector(const Place& depth, const std::string& company, Order order) {
  if (order == Order::kOnePart) {
    return depth.channel == "z" &&
           (company == "position in a part" || company == "components as parts");
  }
  return depth.part == "Pz" && company == "components as parts";
}

double DepthValue(int x, int y) { return 2.0 + x + 0.125 * y; }
double OtherDepth(int x, int y) { return 50.0 + x + y; }
double NoDepth(int x, int y) { return 0.25 + 0.01 * x - 0.3 * y; }
double Shadow(int x, int) { return x % 2; }
double OtherShadow(int x, int) { return 1 - x % 2; }

// A file under way: channels go to the part of that name, in the order in which they come.
class FileMaker {
 public:
  explicit FileMaker(bool one_part) : one_part_(one_part) {}

  void Add(const Place& place,
           const std::function<double(int, int)>& value,
           const std::string& view = "") {
    const std::string part =
        one_part_ ? "all" : absl::StrCat(place.part, view.empty() ? "" : ".", view);
    auto found = std::find_if(
        parts_.begin(), parts_.end(), [&part](const ExrPart& p) { return p.name == part; });
    if (found == parts_.end()) {
      ExrPart& added = parts_.emplace_back();
      added.name = part;
      added.view = view;
      added.width = added.data_width = kWidth;
      added.height = added.data_height = kHeight;
      const testing::StandardMatrices matrices = testing::Standard(kWidth, kHeight);
      added.matrices = {{"worldToCamera", matrices.world_to_camera},
                        {"worldToNDC", matrices.world_to_ndc}};
      found = parts_.end() - 1;
    }
    is_twice_ = is_twice_ || !names_.insert(part + "/" + place.channel).second;
    found->channels.push_back({place.channel, Imf::FLOAT, value});
  }

  // Whether some channel stands in a part twice: there is no such file.
  bool is_twice() const { return is_twice_; }
  const std::vector<ExrPart>& parts() const { return parts_; }

 private:
  bool one_part_;
  bool is_twice_ = false;
  std::set<std::string> names_;
  std::vector<ExrPart> parts_;
};

struct Tally {
  int num_right = 0, num_refused = 0, num_wrong = 0;

  int num_files() const { return num_right + num_refused + num_wrong; }
};

enum class Outcome { kRight, kRefused, kWrong };

class DepthCorpus : public ::testing::Test {
 protected:
  // Reads the file and counts what came of it.
  Outcome Judge(const std::vector<ExrPart>& parts, const ReadbackExrOptions& options = {}) {
    const std::string path = folder_.File("a.exr");
    testing::WriteExr(path, parts);
    const std::vector<Light> lights = {
        Light::Directional("sun", Eigen::Vector3d(0.0, 0.0, -1.0), 0)};
    const auto file = ReadReadbackExr(path, lights, options);
    if (!file.ok()) {
      EXPECT_TRUE(testing::HasAll(file.status().message(), {path, "channel", "\""}));
      ++tally_.num_refused;
      return Outcome::kRefused;
    }
    bool is_right = file->light_status[0].ok();
    for (int i = 0; is_right && i < kWidth * kHeight; ++i) {
      const int x = i % kWidth, y = i / kWidth;
      is_right = file->depth[i] == static_cast<float>(DepthValue(x, y)) &&
                 file->shadow_bits[i] == (Shadow(x, y) > 0.5 ? 1U : 0U);
    }
    ++(is_right ? tally_.num_right : tally_.num_wrong);
    return is_right ? Outcome::kRight : Outcome::kWrong;
  }

  void TearDown() override {
    std::printf("%s: %d files, %d read right, %d refused by name, %d wrong\n",
                ::testing::UnitTest::GetInstance()->current_test_info()->name(),
                tally_.num_files(),
                tally_.num_right,
                tally_.num_refused,
                tally_.num_wrong);
    EXPECT_EQ(tally_.num_wrong, 0);
  }

  testing::TemporaryFolder folder_;
  Tally tally_;
};

void AddColour(FileMaker& file) {
  for (const char* channel : {"A", "B", "G", "R"}) file.Add({channel, "rgba"}, NoDepth);
}

FileMaker FileOf(const Place* depth, const Company& company, Order order) {
  FileMaker file(order == Order::kOnePart);
  const auto add_depth = [&](bool now) {
    if (now && depth != nullptr) file.Add(*depth, DepthValue);
  };
  const auto add_company = [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Place place = company.places[i];
      if (order == Order::kWithColour && place.channel.find('.') != std::string::npos) {
        place.part = "rgba";
      }
      file.Add(place, NoDepth);
    }
  };
  const size_t half = company.places.size() / 2;
  add_depth(order == Order::kDepthFirst);
  AddColour(file);
  add_company(0, half);
  add_depth(order == Order::kDepthBetween);
  add_company(half, company.places.size());
  file.Add({"shadow.sun", "shadows"}, Shadow);
  add_depth(order != Order::kDepthFirst && order != Order::kDepthBetween);
  return file;
}

TEST_F(DepthCorpus, TheDepthIsFoundInAnyCompany) {
  for (size_t d = 0; d < std::size(kDepths); ++d) {
    for (size_t c = 0; c < std::size(kCompanies); ++c) {
      for (size_t o = 0; o < std::size(kOrders); ++o) {
        const Place& depth = kDepths[d];
        const Company& company = kCompanies[c];
        const Order order = kOrders[o];
        if (!IsDrawn(d, c, o)) continue;
        if (order == Order::kOnePart && (NeedsPart(depth.channel) || company.needs_parts)) continue;
        const FileMaker file = FileOf(&depth, company, order);
        if (file.is_twice()) continue;
        SCOPED_TRACE(absl::StrCat(
            depth.channel, " in ", depth.part, ", ", company.words, ", ", static_cast<int>(order)));
        const Outcome outcome = Judge(file.parts());
        EXPECT_EQ(outcome,
                  MayBeAVector(depth, company.words, order) ? Outcome::kRefused : Outcome::kRight);
      }
    }
  }
}

TEST_F(DepthCorpus, NothingElseIsTakenForADepth) {
  for (const Company& company : kCompanies) {
    for (const Order order : kOrders) {
      if (order == Order::kOnePart && company.needs_parts) continue;
      const FileMaker file = FileOf(nullptr, company, order);
      if (file.is_twice()) continue;
      SCOPED_TRACE(absl::StrCat(company.words, ", ", static_cast<int>(order)));
      EXPECT_EQ(Judge(file.parts()), Outcome::kRefused);
    }
  }
}

TEST_F(DepthCorpus, TwoAreRefusedUnlessOneIsNamed) {
  for (const Place& depth : kDepths) {
    for (const bool one_part : {false, true}) {
      const bool has_layer = depth.channel.find('.') != std::string::npos;
      if (one_part && !has_layer) continue;
      FileMaker file(one_part);
      AddColour(file);
      const std::string front = one_part ? "fg." : "", back = one_part ? "bg." : "";
      file.Add({back + depth.channel, "bg." + depth.part}, OtherDepth);
      file.Add({front + depth.channel, "fg." + depth.part}, DepthValue);
      file.Add({"shadow.sun", "shadows"}, Shadow);
      SCOPED_TRACE(absl::StrCat(depth.channel, " in ", depth.part));
      EXPECT_EQ(Judge(file.parts()), Outcome::kRefused);
      ReadbackExrOptions options;
      options.depth_channel =
          one_part ? front + depth.channel : absl::StrCat("fg.", depth.part, ".", depth.channel);
      EXPECT_EQ(Judge(file.parts(), options), Outcome::kRight);
    }
  }
}

TEST_F(DepthCorpus, OfTwoViewsTheOneThatIsNamed) {
  for (size_t d = 0; d < std::size(kDepths); ++d) {
    for (size_t c = 0; c < std::size(kCompanies); ++c) {
      for (const bool right_first : {false, true}) {
        const Place& depth = kDepths[d];
        const Company& company = kCompanies[c];
        if ((d + 2 * c + (right_first ? 5 : 0)) % 10 != 0) continue;
        FileMaker file(false);
        for (const std::string view :
             {right_first ? "right" : "left", right_first ? "left" : "right"}) {
          const bool is_left = view == "left";
          for (const Place& place : company.places) file.Add(place, NoDepth, view);
          file.Add(depth, is_left ? DepthValue : OtherDepth, view);
          file.Add({"shadow.sun", "shadows"}, is_left ? Shadow : OtherShadow, view);
        }
        if (file.is_twice()) continue;
        SCOPED_TRACE(absl::StrCat(depth.channel, " in ", depth.part, ", ", company.words));
        EXPECT_EQ(Judge(file.parts()), Outcome::kRefused);
        ReadbackExrOptions options;
        options.view = "left";
        const Outcome outcome = Judge(file.parts(), options);
        EXPECT_EQ(outcome,
                  MayBeAVector(depth, company.words, Order::kDepthLast) ? Outcome::kRefused
                                                                        : Outcome::kRight);
      }
    }
  }
}

}  // namespace
}  // namespace lightfit
