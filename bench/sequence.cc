// bench/sequence.cc : what a stable shadow map costs over a shot, and what it saves in crawl.
//
// In:   a folder of read-backs (by default shot_walk beside the repository) with scene.json.
// Out:  per light and over all: energy as a multiple of every frame's own best, updates, crawl; of
//       per-frame, tracked at several stabilities, the published rule, and one map for the shot.
//
// The shot is run by the same code as `lightfit shot`, in a temporary folder.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/number.h"
#include "base/parallel.h"
#include "base/table.h"
#include "bench/inputs.h"
#include "io/lights_file.h"
#include "jobs/shot/run.h"
#include "jobs/shot/totals.h"

namespace lightfit {
namespace {

struct Row {
  std::string name;
  ShotMode mode;
  TrackerOptions tracker;
};

std::vector<Row> Rows() {
  std::vector<Row> rows = {{"per-frame", ShotMode::kPerFrame, TrackerOptions()}};
  for (const double stability : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    rows.push_back({absl::StrFormat("tracked, stability %g", stability),
                    ShotMode::kTracked,
                    TrackerOptions::ForStability(stability)});
  }
  // Their rule on our fits: what differs is what is kept, and when.
  rows.push_back({"tracked, published rule", ShotMode::kTracked, TrackerOptions::AsPublished()});
  rows.back().tracker.fit = FitOptions();
  rows.push_back({"per-shot", ShotMode::kPerShot, TrackerOptions()});
  return rows;
}

// A folder that goes when the object does.
class WorkFolder {
 public:
  WorkFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "lightfit_XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~WorkFolder() {
    std::error_code error;
    if (!path_.empty()) std::filesystem::remove_all(path_, error);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

absl::StatusOr<ShotJob> JobOf(const std::string& shot_folder, const std::string& work_folder) {
  absl::StatusOr<FrameList> list = ListFrames({shot_folder});
  if (!list.ok()) return list.status();
  absl::StatusOr<std::vector<Light>> lights = ReadLightsFile(shot_folder + "/scene.json");
  if (!lights.ok()) return lights.status();
  ShotJob job;
  job.name = list->shot;
  job.frames = std::move(list->frames);
  job.lights = *std::move(lights);
  job.folder = work_folder;
  job.num_threads = NumProcessors();
  return job;
}

std::vector<std::string> Cells(const std::string& name, const ShotTotals& totals) {
  const auto text = [](const std::optional<double>& value) {
    return value.has_value() ? FigureText(*value) : std::string("-");
  };
  return {name,
          text(totals.energy_ratio),
          absl::StrCat(totals.num_updates),
          text(totals.phase_drift_texels),
          text(totals.edge_crawl_px),
          totals.wrong_share ? PercentText(*totals.wrong_share) : "-",
          absl::StrCat(totals.num_failed)};
}

Table NewTable(const std::string& light) {
  Table table;
  table.AddColumn("", light);
  table.AddColumn("energy", "/ per-frame");
  table.AddColumn("", "updates");
  table.AddColumn("phase drift", "texels");
  table.AddColumn("edge crawl", "pixels");
  table.AddColumn("wrong", "% of the image");
  table.AddColumn("without", "a matrix");
  return table;
}

absl::Status Run(const std::string& shot_folder) {
  const WorkFolder work;
  absl::StatusOr<ShotJob> job = JobOf(shot_folder, work.path());
  if (!job.ok()) return job.status();
  std::vector<Table> tables;
  for (const Light& light : job->lights) tables.push_back(NewTable(light.name));
  tables.push_back(NewTable("all lights"));
  for (const Row& row : Rows()) {
    // What the row before has computed per frame is there already.
    job->modes = {true, row.mode == ShotMode::kTracked, row.mode == ShotMode::kPerShot};
    job->tracker = row.tracker;
    if (absl::Status status = MakeShotFolders(*job); !status.ok()) return status;
    ShotContext context(*job);
    if (absl::Status status = RunShot(&context); !status.ok()) return status;
    for (size_t i = 0; i < tables.size(); ++i) {
      const std::optional<size_t> light =
          i < job->lights.size() ? std::optional<size_t>(i) : std::nullopt;
      tables[i].AddRow(Cells(row.name, TotalsOf(context.rows, row.mode, light)));
    }
  }
  std::printf("%s: %zu frames, map %d x %d texels\n",
              job->name.c_str(),
              job->frames.size(),
              job->map.width,
              job->map.height);
  for (const Table& table : tables) std::printf("\n%s", table.Text().c_str());
  return absl::OkStatus();
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  std::string folder = lightfit::DefaultReadbackFolder() + "/shot_walk";
  CLI::App app("What a stable shadow map costs over a shot, and what it saves in crawl.");
  app.add_option("--shot", folder, "Folder with frames and scene.json")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const absl::Status status = lightfit::Run(folder);
  if (status.ok()) return 0;
  std::fprintf(stderr, "sequence: %s\n", std::string(status.message()).c_str());
  return 1;
}
