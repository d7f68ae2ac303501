// Writes the first inputs of every target, for corpora to grow from: a small read-back
// (fuzz/small_readback.h) in the forms that targets take.
//   fuzz_make_seeds REPOSITORY FOLDER      FOLDER/TARGET/NAME, such as fuzz/corpus/fit/yard
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/text_file.h"
#include "calls/allocate_call.h"
#include "calls/fit_call.h"
#include "calls/pixel_buffer.h"
#include "calls/summarize_call.h"
#include "calls/track_session.h"
#include "fuzz/calls.h"
#include "fuzz/exr_variants.h"
#include "fuzz/inputs.pb.h"
#include "fuzz/scene_seeds.h"
#include "fuzz/small_readback.h"
#include "io/readback_exr_write.h"
#include "io/summary_file.h"
#include "optimizer/fit.h"
#include "wire/camera_proto.h"
#include "wire/light_proto.h"
#include "wire/options_proto.h"
#include "wire/plan_shot_proto.h"
#include "wire/proto_json.h"
#include "wire/shot_proto.h"
#include "wire/summary_proto.h"

namespace lightfit::fuzz {
namespace {

void Write(const std::string& path, absl::string_view bytes) {
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
}

v1::MapSize SmallMap() {
  v1::MapSize map;
  map.set_width(256);
  map.set_height(128);
  return map;
}

v1::PlanOptions SmallPlan() {
  v1::PlanOptions options;
  options.set_max_maps(3);
  options.set_texels(8192);
  options.set_guard_texels(0.5);
  return options;
}

v1::FitRequest FitSeed(const SmallReadback& yard) {
  v1::FitRequest request = RequestOf<v1::FitRequest>(yard);
  *request.mutable_map() = SmallMap();
  return request;
}

// An allocation makes dozens of fits.
void UseQuickSearch(v1::AllocateRequest* request) {
  request->mutable_options()->set_search(v1::SEARCH_ROTATION_LINE_SEARCH);
  request->mutable_options()->set_affine(v1::AFFINE_MIN_AREA_RECTANGLE);
  request->mutable_rules()->set_multiple(256);
  request->mutable_rules()->set_max_side(1024);
}

using Matrices = google::protobuf::RepeatedPtrField<v1::CandidateMatrix>;

// In both of their forms.
Matrices MatricesOf(const v1::FitResult& result) {
  Matrices matrices;
  for (const v1::LightResult& light : result.lights()) {
    if (light.status().code() != 0) continue;
    v1::CandidateMatrix& candidate = *matrices.Add();
    candidate.set_light(light.name());
    *candidate.mutable_map() = light.map();
    if (matrices.size() == 1) {
      *candidate.mutable_map_from_world() = light.map_from_world();
    } else {
      *candidate.mutable_clip_from_world() = light.clip_from_world();
      *candidate.mutable_clip() = light.clip();
    }
  }
  return matrices;
}

SummarySet SummariesOf(const SmallReadback& yard, const FitOptions& options) {
  std::vector<LightSummary> lights;
  for (const Light& light : yard.lights) {
    lights.push_back(
        SummaryOfFrame(light, Summarize(yard.file.View(), light, options), "yard.exr", options));
  }
  return MakeSummarySet(options, std::move(lights));
}

class Seeds {
 public:
  Seeds(const std::string& repository, const std::string& folder)
      : yard_(SmallYard(repository + "/examples/yard_180")),
        scene_(ReadTextFile(repository + "/examples/yard_180/scene.json").value()),
        folder_(folder) {}

  void WriteCalls() const {
    v1::FitRequest fit = FitSeed(yard_);
    Save("fit/yard", fit);
    v1::FitRequest other = fit;
    UseOtherForms(yard_, other.mutable_readback());
    *other.mutable_options() = FitOptionsToProto(FitOptions::AsPublished());
    other.set_foretell_wrong(true);
    Save("fit/other_forms", other);
    v1::FitRequest plan = fit;
    plan.clear_map();
    *plan.mutable_plan_options() = SmallPlan();
    Save("fit/plan", plan);
    v1::FitRequest cover = fit;
    AddFineCover(yard_, cover.mutable_readback());
    Save("fit/cover", cover);
    WriteStreams(fit);

    v1::EvaluateRequest evaluate = RequestOf<v1::EvaluateRequest>(yard_);
    *evaluate.mutable_matrices() = MatricesOf(AnswerFit(fit, CallContext()).value());
    Save("evaluate/yard", evaluate);
    WriteSummarize(evaluate.matrices());
    WriteCompare(evaluate.matrices());

    v1::AllocateRequest allocate = RequestOf<v1::AllocateRequest>(yard_);
    allocate.set_budget_texels(1 << 17);
    UseQuickSearch(&allocate);
    v1::LightWeight& weight = *allocate.add_weights();
    weight.set_light(yard_.lights[0].name);
    weight.set_weight(2.0);
    Save("allocate/budget", allocate);
    v1::AllocateRequest plans = RequestOf<v1::AllocateRequest>(yard_);
    plans.set_budget_texels(1 << 17);
    *plans.mutable_plan_options() = SmallPlan();
    plans.mutable_plan_options()->clear_texels();
    plans.mutable_plan_options()->mutable_sizes()->set_max_side(256);
    Save("allocate/plans", plans);
    allocate.clear_weights();
    allocate.mutable_tolerance()->set_kind(v1::Tolerance::KIND_P99);
    allocate.mutable_tolerance()->set_limit_px(2.0);
    Save("allocate/tolerance", allocate);
  }

  void WriteSummaries() const {
    FitOptions squares;
    squares.metric = Metric::kL2;
    for (const auto& [name, options] :
         {std::pair{"l1", FitOptions()}, std::pair{"squares", squares}}) {
      const SummarySet set = SummariesOf(yard_, options);
      const std::string file = SerializeSummarySet(set, "fuzzer").value();
      Write(absl::StrCat(folder_, "/summary_file/", name), file);
      SummarySet sum = set;
      if (AddToSet(set, &sum).ok()) {
        Write(absl::StrCat(folder_, "/summary_file/", name, "_twice"),
              SerializeSummarySet(sum, "fuzzer").value());
      }
      v1::FitSummaryRequest fit;
      *fit.mutable_map() = SmallMap();
      fit.add_summary_files(file);
      Save(absl::StrCat("fit_summary/", name, "_file"), fit);
      fit.clear_summary_files();
      *fit.add_summaries() = SummarySetToProto(set);
      *fit.add_summaries() = SummarySetToProto(set);
      Save(absl::StrCat("fit_summary/", name), fit);
      v1::AllocateRequest allocate;
      UseQuickSearch(&allocate);
      *allocate.add_summaries() = SummarySetToProto(set);
      allocate.set_budget_texels(1 << 17);
      Save(absl::StrCat("allocate/budget_", name), allocate);
      allocate.mutable_tolerance()->set_kind(v1::Tolerance::KIND_RMS);
      allocate.mutable_tolerance()->set_limit_px(2.0);
      Save(absl::StrCat("allocate/tolerance_", name), allocate);
    }
  }

  void WriteJson() const {
    v1::LightList lights;
    for (const Light& light : yard_.lights) *lights.add_lights() = LightToProto(light);
    SaveJson("lights_json/list", lights);
    Write(folder_ + "/lights_json/scene", scene_);
    SaveJson("camera_json/camera", CameraToProto(yard_.file.camera, DepthKind::kCameraZ));
    Write(folder_ + "/camera_json/scene", scene_);

    const v1::FitRequest fit = FitSeed(yard_);
    v1::TrackSetup setup;
    *setup.mutable_map() = fit.map();
    TrackSession session = TrackSession::Begin(setup).value();
    v1::TrackFrame frame;
    *frame.mutable_lights() = fit.lights();
    const v1::TrackResult tracked = session.Update(frame, yard_.file.View(), {});
    SaveJson("result_json/track", tracked.result());
    SaveJson("matrices_json/result", tracked.result());
    v1::FitRequest plan = fit;
    plan.clear_map();
    *plan.mutable_plan_options() = SmallPlan();
    const v1::FitResult plans = AnswerFit(plan, CallContext()).value();
    SaveJson("matrices_json/plan", plans);
    SaveJson("result_json/plan", plans);
    v1::AllocateRequest allocate = RequestOf<v1::AllocateRequest>(yard_);
    allocate.set_budget_texels(1 << 17);
    SaveJson("result_json/allocation", AnswerAllocate(allocate, CallContext()).value());
    for (const char* text :
         {"{\"map_from_world\": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],\n"
          " \"map\": {\"width\": 64, \"height\": 32}}\n",
          "{\"clip_from_world\": {\"m\": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]},\n"
          " \"clip\": {\"yUp\": true}}\n",
          "{\"clipFromWorld\": [[1,0,0,0], [0,1,0,0], [0,0,1,0], [0,0,0,1]],\n"
          " \"clip\": \"opengl\"}\n"}) {
      Write(absl::StrCat(folder_, "/matrices_json/single", absl::string_view(text).size()), text);
    }
  }

  void WriteScenes() const {
    for (const auto& [name, bytes] : SceneSeeds()) Write(absl::StrCat(folder_, "/", name), bytes);
  }

  void WriteExr() const {
    const std::string path = folder_ + "/exr/yard";
    std::filesystem::create_directories(folder_ + "/exr");
    const absl::Status status = WriteReadbackExr(path, yard_.file.View(), yard_.lights);
    if (!status.ok() || !WriteExrVariants(path, folder_ + "/exr")) std::cerr << status << "\n";
  }

 private:
  void Save(const std::string& name, const google::protobuf::Message& message) const {
    Write(absl::StrCat(folder_, "/", name), message.SerializeAsString());
  }

  void SaveJson(const std::string& name, const google::protobuf::Message& message) const {
    Write(absl::StrCat(folder_, "/", name), ProtoToJson(message).value());
  }

  // A read-back, one with summaries in both forms, and summaries alone.
  void WriteSummarize(const Matrices& matrices) const {
    v1::SummarizeRequest request = RequestOf<v1::SummarizeRequest>(yard_);
    request.set_frame_number(7.25);
    ShortenSearch(request.mutable_options());  // as the target does, so that summaries add up
    Save("summarize/yard", request);
    v1::SummarizeRequest weighed = request;
    *weighed.mutable_weigh_by() = matrices;
    Save("summarize/weighed", weighed);
    v1::SummarizeRequest squares = request;
    squares.mutable_options()->set_metric(v1::METRIC_L2);
    UseOtherForms(yard_, squares.mutable_readback());
    Save("summarize/squares", squares);
    const v1::SummarizeResult first = AnswerSummarize(request, CallContext()).value();
    request.set_frame_number(8.0);
    request.add_summary_files(first.summary_file());
    Save("summarize/added", request);
    *request.add_summaries() = AnswerSummarize(request, CallContext()).value().summary();
    request.clear_readback();
    request.clear_lights();
    Save("summarize/frame_twice", request);
    request.clear_summary_files();
    Save("summarize/summaries", request);
  }

  void WriteCompare(const Matrices& matrices) const {
    v1::CompareRequest request = RequestOf<v1::CompareRequest>(yard_);
    *request.mutable_map() = SmallMap();
    Save("compare/yard", request);
    v1::GivenMatrices& given = *request.add_given();
    given.set_name("engine");
    *given.mutable_matrices() = matrices;
    *request.mutable_options() = FitOptionsToProto(FitOptions::AsPublished());
    UseOtherForms(yard_, request.mutable_readback());
    Save("compare/given", request);
  }

  // One that goes on from what another has remembered.
  static TrackInput PlanTrack(const v1::Readback& pixels,
                              const google::protobuf::RepeatedPtrField<v1::Light>& lights) {
    v1::TrackSetup setup;
    *setup.mutable_plan_options() = SmallPlan();
    v1::TrackFrame frame;
    *frame.mutable_readback() = pixels;
    *frame.mutable_lights() = lights;
    TrackSession session = TrackSession::Begin(setup).value();
    const ReadbackView view = ReadbackView::Of(pixels, lights.size(), CallLimits()).value();
    *setup.mutable_state() = session.Update(frame, view.view(), {}).result().shot().tracker_state();
    *setup.mutable_plan_tracker() =
        PlanTrackerSettingsToProto(PlanTrackerOptions::ForStability(0.5));
    TrackInput track;
    *track.add_requests()->mutable_setup() = setup;
    for (int number = 1; number <= 2; ++number) {
      frame.set_number(number);
      *track.add_requests()->mutable_frame() = frame;
    }
    return track;
  }

  void WriteStreams(v1::FitRequest fit) const {
    const v1::Readback pixels = fit.readback();
    const size_t num_bytes = pixels.depth().size();
    FitStreamInput stream;
    RemovePixels(fit.mutable_readback());
    *stream.add_requests()->mutable_request() = fit;
    *stream.add_requests() = PixelsOf(pixels, 0, 400);
    *stream.add_requests() = PixelsOf(pixels, 400, num_bytes);
    Save("fit_stream/bits", stream);

    v1::FitRequest other = fit;
    UseOtherForms(yard_, other.mutable_readback());
    const v1::Readback planes = other.readback();
    RemovePixels(other.mutable_readback());
    stream.Clear();
    *stream.add_requests()->mutable_request() = other;
    stream.add_requests()->mutable_pixels()->set_depth(planes.depth());
    stream.add_requests()->mutable_pixels()->set_mapped_bits(planes.mapped_bits());
    for (int l = 0; l < planes.shadow_planes_size(); ++l) {
      v1::PixelChunk& chunk = *stream.add_requests()->mutable_pixels();
      chunk.set_shadow_plane(planes.shadow_planes(l));
      chunk.set_shadow_plane_index(l);
      chunk.set_facing_plane(planes.facing_planes(l));
      chunk.set_facing_plane_index(l);
    }
    Save("fit_stream/planes", stream);

    TrackInput track;
    *track.add_requests()->mutable_setup()->mutable_map() = SmallMap();
    v1::TrackFrame frame;
    *frame.mutable_readback() = pixels;
    *frame.mutable_lights() = fit.lights();
    for (int number = 1; number <= 2; ++number) {
      frame.set_number(number);
      *track.add_requests()->mutable_frame() = frame;
    }
    Save("track/whole", track);
    *track.mutable_requests(0)->mutable_setup()->mutable_tracker() =
        TrackerSettingsToProto(TrackerOptions::AsPublished());
    track.mutable_requests()->RemoveLast();
    RemovePixels(track.mutable_requests(1)->mutable_frame()->mutable_readback());
    *track.add_requests()->mutable_pixels() = PixelsOf(pixels, 0, 400).pixels();
    *track.add_requests()->mutable_pixels() = PixelsOf(pixels, 400, num_bytes).pixels();
    Save("track/pieces", track);
    Save("track/plan", PlanTrack(pixels, fit.lights()));
  }

  SmallReadback yard_;
  std::string scene_;
  std::string folder_;
};

}  // namespace
}  // namespace lightfit::fuzz

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: " << argv[0] << " REPOSITORY FOLDER\n";
    return 2;
  }
  const lightfit::fuzz::Seeds seeds(argv[1], argv[2]);
  seeds.WriteCalls();
  seeds.WriteSummaries();
  seeds.WriteJson();
  seeds.WriteScenes();
  seeds.WriteExr();
}
