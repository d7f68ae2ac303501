#include "jobs/shot/judge.h"

#include <utility>

#include "base/text_file.h"
#include "optimizer/evaluate.h"
#include "optimizer/fit.h"

namespace lightfit {
namespace {

// The view says which border it is for.
FitOptions AnyBorder(FitOptions options) {
  options.border = BorderChoice::kAutomatic;
  return options;
}

absl::StatusOr<ShotFit> JudgeFit(const ShotJob& job,
                                 const LightView& view,
                                 const TrackedMatrix& tracked,
                                 const ReadbackFile* file_before,
                                 const std::optional<LightMap>& map_before) {
  ShotFit fit;
  fit.tracked = tracked;
  LightMatrix& matrix = fit.tracked.matrix;
  std::optional<LightView> other;  // where the border was chosen otherwise
  if (matrix.border != view.border) {
    absl::StatusOr<LightView> made =
        ViewLight(*view.surfaces, *view.light, matrix.border, job.fit());
    if (!made.ok()) return made.status();
    other = *std::move(made);
  }
  absl::StatusOr<Figures> figures = EvaluateMatrix(other.has_value() ? *other : view,
                                                   matrix.map_from_world,
                                                   matrix.map,
                                                   AnyBorder(job.fit()),
                                                   matrix.border);
  if (!figures.ok()) return figures.status();
  matrix.figures = *std::move(figures);
  if (file_before == nullptr || !map_before.has_value()) return fit;
  const absl::StatusOr<Crawl> crawl =
      MeasureCrawl({file_before->View(), map_before->map_from_world, job.map},
                   {view.surfaces->readback, matrix.map_from_world, matrix.map, view.surfaces},
                   *view.light,
                   job.fit().samples);
  if (!crawl.ok()) return crawl.status();
  fit.crawl = *crawl;
  return fit;
}

}  // namespace

absl::StatusOr<ReadbackFile> ReadFrame(const ShotFrame& frame, absl::Span<const Light> lights) {
  if (!frame.exr.ok()) return frame.exr.status();
  absl::StatusOr<ReadbackFile> file = ReadReadbackExr(frame.path, lights, *frame.exr);
  if (!file.ok()) return file.status();
  const absl::Status status = InFile(frame.path, ValidateReadback(file->View()));
  if (!status.ok()) return status;
  return file;
}

FrameViews::FrameViews(const ShotJob& job, const absl::StatusOr<ReadbackFile>& file)
    : surfaces_(file.ok() ? FindSurfaces(file->View(), LightMask(job.lights), job.fit().samples)
                          : absl::StatusOr<Surfaces>(file.status())) {
  for (size_t i = 0; i < job.lights.size(); ++i) {
    const absl::Status status =
        file.ok() && !file->light_status[i].ok() ? file->light_status[i] : surfaces_.status();
    if (status.ok()) {
      views_.push_back(ViewLight(*surfaces_, job.lights[i], job.fit()));
    } else {
      views_.emplace_back(status);
    }
  }
}

TrackedMatrices FitReadable(absl::Span<const Light> lights,
                            const absl::StatusOr<ReadbackFile>& file,
                            const std::function<TrackedMatrices(absl::Span<const Light>)>& fit) {
  if (!file.ok()) return TrackedMatrices(lights.size(), file.status());
  std::vector<Light> readable;
  for (size_t i = 0; i < lights.size(); ++i) {
    if (file->light_status[i].ok()) readable.push_back(lights[i]);
  }
  TrackedMatrices fits = fit(readable);
  TrackedMatrices all;
  size_t next = 0;
  for (const absl::Status& status : file->light_status) {
    if (status.ok()) {
      all.push_back(std::move(fits[next++]));
    } else {
      all.emplace_back(status);
    }
  }
  return all;
}

LightMaps MapsOf(absl::Span<const absl::StatusOr<TrackedMatrix>> matrices) {
  LightMaps maps;
  for (const absl::StatusOr<TrackedMatrix>& matrix : matrices) {
    maps.emplace_back();
    if (matrix.ok()) maps.back() = {matrix->matrix.map_from_world, matrix->matrix.border};
  }
  return maps;
}

LightMaps MapsOf(const ShotJob& job, const v1::FitResult& result) {
  LightMaps maps(job.lights.size());
  for (size_t i = 0; i < maps.size() && static_cast<int>(i) < result.lights_size(); ++i) {
    const v1::LightResult& light = result.lights(static_cast<int>(i));
    if (!light.has_map_from_world()) continue;
    const absl::StatusOr<Eigen::Matrix4d> map =
        MatrixFromProto(light.map_from_world(), "mapFromWorld");
    const absl::StatusOr<Border> border = BorderFromProto(light.border(), "border");
    if (map.ok() && border.ok()) maps[i] = {*map, *border};
  }
  return maps;
}

std::vector<absl::StatusOr<ShotFit>> JudgeFits(
    const ShotJob& job,
    const FrameViews& views,
    absl::Span<const absl::StatusOr<TrackedMatrix>> matrices,
    const FrameBefore& before) {
  std::vector<absl::StatusOr<ShotFit>> fits;
  for (size_t i = 0; i < matrices.size(); ++i) {
    if (!matrices[i].ok()) {
      fits.emplace_back(matrices[i].status());
      continue;
    }
    if (!views[i].ok()) {
      fits.emplace_back(views[i].status());
      continue;
    }
    const bool has_before = before.file != nullptr && before.file->light_status[i].ok();
    fits.push_back(JudgeFit(job,
                            *views[i],
                            *matrices[i],
                            has_before ? before.file : nullptr,
                            has_before ? before.maps[i] : std::nullopt));
  }
  return fits;
}

}  // namespace lightfit
