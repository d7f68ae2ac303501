// python/native/module.cc
//
// lightfit._native: the calls of calls/ and the EXR reader, for the package in python/lightfit.
// In:   serialized requests of lightfit.v1, and pixels as numpy arrays, which are not copied.
// Out:  serialized results; what fails raises an exception of lightfit.errors.
#include <google/protobuf/message_lite.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "calls/allocate_call.h"
#include "calls/call_context.h"
#include "calls/compare/compare_call.h"
#include "calls/evaluate_call.h"
#include "calls/fine_cover_buffer.h"
#include "calls/fit_call.h"
#include "calls/pixel_buffer.h"
#include "calls/request_lights.h"
#include "calls/summarize_call.h"
#include "calls/summary_call.h"
#include "calls/track_session.h"
#include "io/camera_convention.h"
#include "io/fine_cover_exr.h"
#include "io/readback_exr.h"
#include "lightfit/v1/camera.pb.h"
#include "lightfit/v1/light.pb.h"
#include "lightfit/v1/service.pb.h"
#include "python/native/stoppable.h"
#include "wire/camera_proto.h"

namespace lightfit {
namespace {

namespace py = pybind11;

using DepthArray = py::array_t<float, py::array::c_style>;
using BitsArray = py::array_t<uint32_t, py::array::c_style>;

[[noreturn]] void Raise(const absl::Status& status) {
  const py::object error =
      py::module_::import("lightfit.errors")
          .attr("error_of")(static_cast<int>(status.code()), std::string(status.message()));
  PyErr_SetObject(py::type::handle_of(error).ptr(), error.ptr());
  throw py::error_already_set();
}

template <typename Message>
Message Parsed(const std::string& bytes) {
  Message message;
  if (!message.ParseFromString(bytes)) {
    Raise(absl::InvalidArgumentError(
        absl::StrCat(message.GetTypeName(), ": cannot be parsed, want one of this version")));
  }
  return message;
}

absl::Status Late(double timeout_s) {
  return absl::DeadlineExceededError(
      absl::StrFormat("was not done within timeout_s = %g: raise it, or send less", timeout_s));
}

// Memory is the caller's own business here: pixels are in it already.
CallContext ContextOf(const std::stop_token& stop) {
  CallContext context;
  context.limits.max_pixels = int64_t{1} << 40;
  context.limits.max_matrices = std::numeric_limits<int>::max();
  context.limits.max_summaries = std::numeric_limits<int>::max();
  context.stop = stop;
  return context;
}

// Serializes the answer of work(context), or raises.
template <typename Work>
py::bytes Answer(std::optional<double> timeout_s, const Work& work) {
  const auto [answer, is_late] =
      RunStoppable(timeout_s, [&](const std::stop_token& stop) { return work(ContextOf(stop)); });
  if (answer.ok()) return answer->SerializeAsString();
  if (is_late && absl::IsCancelled(answer.status())) Raise(Late(*timeout_s));
  Raise(answer.status());
}

template <typename Value>
absl::Span<const Value> SpanOf(const py::array_t<Value, py::array::c_style>& array) {
  return {array.data(), static_cast<size_t>(array.size())};
}

absl::Span<const uint32_t> SpanOf(const std::optional<BitsArray>& array) {
  return array.has_value() ? SpanOf(*array) : absl::Span<const uint32_t>();
}

// A read-back of arrays, which it refers to, and of the finer cover in its message.
class ArrayReadback {
 public:
  ArrayReadback(const v1::Readback& proto,
                int num_lights,
                const DepthArray& depth,
                const BitsArray& shadow_bits,
                const std::optional<BitsArray>& facing_bits,
                const std::optional<BitsArray>& mapped_bits) {
    const absl::StatusOr<ReadbackHeader> header =
        ReadbackHeaderFromProto(proto, num_lights, ContextOf({}).limits);
    if (!header.ok()) {
      view_ = header.status();
      return;
    }
    view_ = ReadbackOf(
        *header, SpanOf(depth), SpanOf(shadow_bits), SpanOf(facing_bits), SpanOf(mapped_bits));
    if (header->fine.is_absent()) return;
    buffer_.emplace(header->fine);
    absl::Status status = buffer_->Append(proto.fine_cover());
    if (status.ok()) status = buffer_->CheckComplete();
    if (!status.ok()) {
      view_ = status;
      return;
    }
    fine_cover_ = buffer_->View();
    view_->fine_cover = &fine_cover_;
  }

  // The view refers to this object.
  ArrayReadback(const ArrayReadback&) = delete;
  ArrayReadback& operator=(const ArrayReadback&) = delete;

  const absl::StatusOr<Readback>& view() const { return view_; }

 private:
  std::optional<FineCoverBuffer> buffer_;
  FineCover fine_cover_;
  absl::StatusOr<Readback> view_ = absl::UnknownError("not read");
};

py::bytes Fit(const std::string& request_bytes,
              const DepthArray& depth,
              const BitsArray& shadow_bits,
              const std::optional<BitsArray>& facing_bits,
              const std::optional<BitsArray>& mapped_bits,
              std::optional<double> timeout_s) {
  const auto request = Parsed<v1::FitRequest>(request_bytes);
  const ArrayReadback readback(
      request.readback(), request.lights_size(), depth, shadow_bits, facing_bits, mapped_bits);
  if (!readback.view().ok()) Raise(readback.view().status());
  return Answer(timeout_s, [&](const CallContext& context) {
    return AnswerFit(request, *readback.view(), context);
  });
}

// Calls whose request holds all there is.
py::bytes Call(const std::string& method,
               const std::string& request_bytes,
               std::optional<double> timeout_s) {
  const auto answer = [&](const auto& request, const auto& call) {
    return Answer(timeout_s, [&](const CallContext& context) { return call(request, context); });
  };
  if (method == "FitSummary") {
    return answer(Parsed<v1::FitSummaryRequest>(request_bytes), AnswerFitSummary);
  }
  if (method == "Evaluate") {
    return answer(Parsed<v1::EvaluateRequest>(request_bytes), AnswerEvaluate);
  }
  if (method == "Allocate") {
    return answer(Parsed<v1::AllocateRequest>(request_bytes), AnswerAllocate);
  }
  if (method == "Summarize") {
    return answer(Parsed<v1::SummarizeRequest>(request_bytes), AnswerSummarize);
  }
  if (method == "Compare") {
    return answer(Parsed<v1::CompareRequest>(request_bytes), AnswerCompare);
  }
  Raise(absl::UnimplementedError(absl::StrCat("there is no call \"", method, "\"")));
}

// One sequence of frames. Two threads that use it take turns.
class TrackedSequence {
 public:
  explicit TrackedSequence(const std::string& setup_bytes)
      : session_(Begin(Parsed<v1::TrackSetup>(setup_bytes))) {}

  py::bytes Update(const std::string& frame_bytes,
                   const DepthArray& depth,
                   const BitsArray& shadow_bits,
                   const std::optional<BitsArray>& facing_bits,
                   const std::optional<BitsArray>& mapped_bits,
                   std::optional<double> timeout_s) {
    const auto frame = Parsed<v1::TrackFrame>(frame_bytes);
    const ArrayReadback readback(
        frame.readback(), frame.lights_size(), depth, shadow_bits, facing_bits, mapped_bits);
    auto [answer, is_late] = RunStoppable(timeout_s, [&](const std::stop_token& stop) {
      const std::lock_guard<std::mutex> lock(mutex_);
      return session_.Update(frame, readback.view(), stop);
    });
    if (is_late && answer.status().code() == static_cast<int>(absl::StatusCode::kCancelled)) {
      Raise(Late(*timeout_s));
    }
    return answer.SerializeAsString();
  }

 private:
  static TrackSession Begin(const v1::TrackSetup& setup) {
    absl::StatusOr<TrackSession> session = TrackSession::Begin(setup);
    if (!session.ok()) Raise(session.status());
    return *std::move(session);
  }

  std::mutex mutex_;
  TrackSession session_;
};

// Hands a buffer over to numpy.
template <typename Value>
py::array ArrayOf(std::vector<Value> values, int width, int height) {
  auto owned = std::make_unique<std::vector<Value>>(std::move(values));
  Value* data = owned->data();
  const py::capsule owner(owned.release(),
                          [](void* buffer) { delete static_cast<std::vector<Value>*>(buffer); });
  return py::array_t<Value>({height, width}, data, owner);
}

// Takes fields["name"], if it is there, as the type of *value.
template <typename Value>
void Take(const py::dict& fields, const char* name, Value* value) {
  if (fields.contains(name)) *value = fields[name].cast<Value>();
}

// Fields as read_exr() of lightfit/exr.py names them; empty ones mean the default.
absl::StatusOr<ReadbackExrOptions> ExrOptionsOf(const py::dict& fields) {
  ReadbackExrOptions options;
  std::string convention, shadow_channel, facing_channel, mapped_channel, camera_bytes;
  Take(fields, "camera_convention", &convention);
  Take(fields, "near", &options.camera_exr.near);
  Take(fields, "far", &options.camera_exr.far);
  Take(fields, "pixel_aspect", &options.camera_exr.pixel_aspect);
  if (fields.contains("background")) options.background = fields["background"].cast<float>();
  Take(fields, "depth_channel", &options.depth_channel);
  Take(fields, "view", &options.view);
  Take(fields, "shadow_channel", &shadow_channel);
  Take(fields, "shadow_channels", &options.shadow_channels);
  Take(fields, "shadow_bits_channel", &options.shadow_bits_channel);
  Take(fields, "facing_channel", &facing_channel);
  Take(fields, "mapped_channel", &mapped_channel);
  Take(fields, "camera", &camera_bytes);
  if (!shadow_channel.empty()) options.shadow_channel_format = shadow_channel;
  if (!facing_channel.empty()) options.facing_channel_format = facing_channel;
  if (!mapped_channel.empty()) options.mapped_channel_format = mapped_channel;
  const absl::StatusOr<CameraConvention> parsed = ParseCameraConvention(convention);
  if (!parsed.ok()) return parsed.status();
  options.camera_exr.convention = *parsed;
  int depth_kind_number = v1::DEPTH_KIND_UNSPECIFIED;
  Take(fields, "depth_kind", &depth_kind_number);
  absl::StatusOr<std::optional<DepthKind>> depth_kind =
      DepthKindFromProto(static_cast<v1::DepthKind>(depth_kind_number));
  if (!depth_kind.ok()) return depth_kind.status();
  if (!camera_bytes.empty()) {
    absl::StatusOr<StatedCamera> camera = CameraFromProto(Parsed<v1::Camera>(camera_bytes));
    if (!camera.ok()) return camera.status();
    options.camera = camera->camera;
    if (!depth_kind->has_value()) *depth_kind = camera->depth_kind;
  }
  options.depth_kind = depth_kind->value_or(DepthKind::kCameraZ);
  return options;
}

absl::StatusOr<std::vector<Light>> LightsOfList(const std::string& lights_bytes) {
  const absl::StatusOr<std::vector<RequestLight>> requested =
      LightsOfRequest(Parsed<v1::LightList>(lights_bytes).lights());
  if (!requested.ok()) return requested.status();
  std::vector<Light> lights;
  for (const RequestLight& light : *requested) lights.push_back(light.light);
  return lights;
}

// What calls find in the pixels, they say.
py::list WarningsOfFile(const ReadbackFile& file) {
  py::list texts;
  for (const ReadbackWarning& warning : file.warnings) {
    if (!warning.is_of_pixels) texts.append(warning.text);
  }
  return texts;
}

// (depth, shadow bits, (facing bits, lights), (mapped bits, lights), lightfit.v1.Camera, [(code,
// message) of each light], lightfit.v1.ReadbackOrigin, background or None, [warning]); of the
// lights 0 where there are no bits.
py::tuple ReadExr(const std::string& path,
                  const std::string& lights_bytes,
                  const py::dict& fields) {
  const absl::StatusOr<std::vector<Light>> lights = LightsOfList(lights_bytes);
  if (!lights.ok()) Raise(lights.status());
  const absl::StatusOr<ReadbackExrOptions> options = ExrOptionsOf(fields);
  if (!options.ok()) Raise(options.status());

  absl::StatusOr<ReadbackFile> file;
  {
    const py::gil_scoped_release others_run;
    file = ReadReadbackExr(path, *lights, *options);
  }
  if (!file.ok()) Raise(file.status());
  py::list statuses;
  for (const absl::Status& status : file->light_status) {
    statuses.append(py::make_tuple(static_cast<int>(status.code()), std::string(status.message())));
  }
  const int width = file->camera.width, height = file->camera.height;
  const auto optional = [&](std::vector<uint32_t> words, uint32_t lights) {
    py::object array = py::none();
    if (!words.empty()) array = ArrayOf(std::move(words), width, height);
    return py::make_tuple(array, lights);
  };
  return py::make_tuple(
      ArrayOf(std::move(file->depth), width, height),
      ArrayOf(std::move(file->shadow_bits), width, height),
      optional(std::move(file->facing_bits), file->facing_lights),
      optional(std::move(file->mapped_bits), file->mapped_lights),
      py::bytes(CameraToProto(file->camera, file->depth_kind).SerializeAsString()),
      statuses,
      py::bytes(OriginToProto(file->origin).SerializeAsString()),
      file->background.has_value() ? py::object(py::float_(*file->background)) : py::none(),
      WarningsOfFile(*file));
}

// (depth, shadow bits, (lit bits, lights)) of the read-back whose lightfit.v1.Camera that is; of
// the lights 0 where there are no bits.
py::tuple ReadCoverExr(const std::string& path,
                       const std::string& lights_bytes,
                       const py::dict& fields,
                       const std::string& camera_bytes) {
  const absl::StatusOr<std::vector<Light>> lights = LightsOfList(lights_bytes);
  if (!lights.ok()) Raise(lights.status());
  const absl::StatusOr<ReadbackExrOptions> options = ExrOptionsOf(fields);
  if (!options.ok()) Raise(options.status());
  const absl::StatusOr<StatedCamera> camera = CameraFromProto(Parsed<v1::Camera>(camera_bytes));
  if (!camera.ok()) Raise(camera.status());
  ReadbackFile readback;
  readback.camera = camera->camera;
  readback.depth_kind = camera->depth_kind.value_or(DepthKind::kCameraZ);

  absl::StatusOr<FineCoverFile> file;
  {
    const py::gil_scoped_release others_run;
    file = ReadFineCoverExr(path, *lights, *options, readback);
  }
  if (!file.ok()) Raise(file.status());
  py::object lit = py::none();
  if (!file->lit_bits.empty()) lit = ArrayOf(std::move(file->lit_bits), file->columns, file->rows);
  return py::make_tuple(ArrayOf(std::move(file->depth), file->columns, file->rows),
                        ArrayOf(std::move(file->shadow_bits), file->columns, file->rows),
                        py::make_tuple(lit, file->lit_lights));
}

}  // namespace

PYBIND11_MODULE(_native, module) {
  module.doc() = "The compiled part of lightfit; see lightfit.fit and lightfit.read_exr.";
  module.def("fit", &Fit);
  module.def("call", &Call);
  module.def("read_exr", &ReadExr);
  module.def("read_cover_exr", &ReadCoverExr);
  py::class_<TrackedSequence>(module, "Track")
      .def(py::init<std::string>())
      .def("update", &TrackedSequence::Update);
}

}  // namespace lightfit
