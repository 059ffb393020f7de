#include "harness/pipeline/perceiving/by_paper.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/freed_memory.h"
#include "harness/base/progress.h"
#include "harness/perception/perception_json.h"
#include "harness/perception/subjective/paired_comparisons.h"
#include "harness/pipeline/perceiving/processes.h"
#include "harness/report/console.h"
#include "harness/report/page_html.h"
#include "harness/report/perception_page.h"

namespace touchstone::pipeline {
namespace {

namespace pc = perception;

// The measuring parts of a process (eq 1, 2): THUMB.csv+FINGER.csv, in the same order for every process. A file whose
// name has a plus sign is one file.
std::vector<std::string> parts_of(const std::string& text) {
  if (std::filesystem::exists(text)) return {text};
  std::vector<std::string> files;
  std::size_t first = 0;
  for (std::size_t plus = text.find('+'); plus != std::string::npos; plus = text.find('+', first)) {
    files.push_back(text.substr(first, plus - first));
    first = plus + 1;
  }
  files.push_back(text.substr(first));
  return files;
}

std::vector<pc::PressSignal> signals_of(const PerceiveRequest& request, const std::string& text, const Vec3& outward,
                                        double contact_N) {
  std::vector<pc::PressSignal> signals;
  const auto files = parts_of(text);
  for (const auto& file : files) {
    signals.push_back(pc::press_signal(read_recording(request, file), outward, contact_N));
    // Parts go by their place, so that those of two processes meet.
    if (files.size() > 1) signals.back().name = fmt::format("part {}", signals.size());
  }
  return signals;
}

}  // namespace

PaperFiles evaluate_by_paper(const rendering::Catalogue& catalogue, const PerceiveRequest& request) {
  PaperFiles result;
  pc::EvaluationOptions settings;
  settings.scaling = pc::feature_scaling(request.paper.scaling);
  settings.explained_share = request.paper.explained_share.value_or(0.9);  // the paper's
  settings.matrix.rate_Hz = request.paper.rate_Hz;
  settings.duration_tolerance = request.paper.duration_tolerance;
  settings.image.sensor_dead_zone_N = request.paper.dead_zone_N;
  settings.image.output_band_Hz = request.paper.band_Hz;
  settings.image.rate_hardness_window = request.paper.window;
  settings.image.rate_hardness_in_band = request.paper.hardness_in_band;
  const auto real_files = parts_of(request.real);
  if (real_files.size() > 1 && !request.models.empty())
    throw UsageError("--model renders one path; the real process has several parts");
  const recording::Recording real = read_recording(request, real_files.front());
  const Vec3 outward = press_direction_of(request.direction, real);
  const double contact_N = settings.image.force_law.absolute_threshold;
  RolesAndFiles inputs;
  for (const auto& file : real_files) inputs.emplace_back("real", file);

  std::vector<pc::ConditionSource> sources;
  std::vector<std::string> names;
  for (const auto& [name, file] : request.conditions) {
    for (const auto& part : parts_of(file)) inputs.emplace_back("condition " + name, part);
    names.push_back(name);
    sources.push_back(
        {name, [&request, file = file, outward, contact_N] { return signals_of(request, file, outward, contact_N); }});
  }
  std::vector<std::string> notes;
  std::shared_ptr<const surface::Surface> surface;
  auto mode = recording::InTrajectoryMode::measured;
  if (!request.models.empty()) {
    surface = rendered_object(request, real, notes);
    inputs.emplace_back("mesh", request.mesh);
    mode = models_path_of(catalogue, request, real, *surface, notes);
  }
  check_real(request, real, surface.get(), notes);
  for (const auto& rendering : request.models) {
    inputs.emplace_back("model " + rendering.name, rendering.file);
    catalogue.find(rendering.model);
    names.push_back(rendering.name);
    sources.push_back(
        {rendering.name, [&catalogue, &model = rendering.model, surface, &real, outward, contact_N, mode] {
           const recording::Recording rendered = rendered_by(catalogue, model, surface, real, real.motion, mode);
           return std::vector<pc::PressSignal>{pc::press_signal(rendered, outward, contact_N)};
         }});
  }
  std::optional<pc::PairedComparisons> answers;
  if (!request.paper.answers.empty()) {
    answers = pc::read_answers(request.paper.answers, names);
    inputs.emplace_back("answers", request.paper.answers);
  }
  result.provenance = report::make_provenance(request.command_line);
  result.provenance.inputs = described(inputs);
  keep_freed_memory();

  Progress progress("conditions", sources.size());
  settings.progress = [&progress](std::size_t done) { progress.update(done); };
  pc::PerceptualEvaluation& evaluation = result.evaluation =
      pc::evaluate(signals_of(request, request.real, outward, contact_N), sources, settings);
  evaluation.remarks.insert(evaluation.remarks.begin(), notes.begin(), notes.end());
  if (answers) result.people = pc::compare_with_people(evaluation, *answers);
  return result;
}

std::string PaperFiles::table() const {
  std::vector<std::vector<std::string>> rows{{"condition", "rank", "distance"}};
  for (const auto& m : pc::statistical_methods()) rows.front().emplace_back(m.method.name);
  for (const auto& c : evaluation.conditions) {
    rows.push_back({c.name, fmt::format("{}", c.rank_perception), fmt::format("{:.4f}", c.distance)});
    for (const auto& value : c.statistics) rows.back().push_back(value ? fmt::format("{:.4g}", *value) : "none");
  }
  return report::align_columns(rows);
}

void write_by_paper(const PaperFiles& files, const std::filesystem::path& folder) {
  const auto* const people = files.people ? &*files.people : nullptr;
  write_file(folder / "perception.json", pc::evaluation_to_json(files.evaluation, people));
  write_html(folder / "report.html",
             perception_page("Perceptual evaluation", files.evaluation, people, files.provenance));
}

}  // namespace touchstone::pipeline
