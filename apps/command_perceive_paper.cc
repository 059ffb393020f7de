#include <fmt/format.h>

#include <filesystem>

#include "apps/command_perceive_options.h"
#include "apps/program.h"
#include "harness/base/atomic_file.h"
#include "harness/base/freed_memory.h"
#include "harness/base/progress.h"
#include "harness/perception/perception_json.h"
#include "harness/recording/recording_file.h"
#include "harness/report/console.h"
#include "harness/report/page_html.h"
#include "harness/report/perception_page.h"
#include "renderers/catalogue.h"

namespace touchstone::apps {
namespace {

namespace pc = perception;

std::string paper_table(const pc::PerceptualEvaluation& evaluation) {
  std::vector<std::vector<std::string>> rows{{"condition", "rank", "distance"}};
  for (const auto& m : pc::statistical_methods()) rows.front().emplace_back(m.method.name);
  for (const auto& c : evaluation.conditions) {
    rows.push_back({c.name, fmt::format("{}", c.rank_perception), fmt::format("{:.4f}", c.distance)});
    for (const auto& value : c.statistics) rows.back().push_back(value ? fmt::format("{:.4g}", *value) : "none");
  }
  return align_columns(rows);
}

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

std::vector<pc::PressSignal> signals_of(const PerceiveOptions& options, const std::string& text, const Vec3& outward,
                                        double contact_N) {
  std::vector<pc::PressSignal> signals;
  const auto files = parts_of(text);
  for (const auto& file : files) {
    signals.push_back(pc::press_signal(read_recording(options, file), outward, contact_N));
    // Parts go by their place, so that those of two processes meet.
    if (files.size() > 1) signals.back().name = fmt::format("part {}", signals.size());
  }
  return signals;
}

}  // namespace

ExitStatus perceive_by_paper(const PerceiveOptions& options) {
  pc::EvaluationOptions settings;
  settings.scaling = pc::feature_scaling(options.scaling);
  settings.explained_share = options.explained_share.value_or(0.9);  // the paper's
  settings.matrix.rate_Hz = options.rate_Hz;
  settings.duration_tolerance = options.duration_tolerance;
  settings.image.sensor_dead_zone_N = options.dead_zone_N;
  settings.image.output_band_Hz = options.band_Hz;
  settings.image.rate_hardness_window = options.window;
  settings.image.rate_hardness_in_band = options.hardness_in_band;
  const auto real_files = parts_of(options.real);
  if (real_files.size() > 1 && !options.models.empty())
    throw UsageError("--model renders one path; the real process has several parts");
  const Recording real = read_recording(options, real_files.front());
  const Vec3 outward = press_direction_of(options.direction, real);
  const double contact_N = settings.image.force_law.absolute_threshold;
  std::vector<std::pair<std::string, std::string>> inputs;
  for (const auto& file : real_files) inputs.emplace_back("real", file);

  std::vector<pc::ConditionSource> sources;
  std::vector<std::string> names;
  for (const auto& text : options.conditions) {
    const auto [name, file] = name_and_file(text, "--condition");
    for (const auto& part : parts_of(file)) inputs.emplace_back("condition " + name, part);
    names.push_back(name);
    sources.push_back(
        {name, [&options, file = file, outward, contact_N] { return signals_of(options, file, outward, contact_N); }});
  }
  std::vector<std::string> notes;
  std::shared_ptr<const Surface> surface;
  if (!options.models.empty()) {
    surface = rendered_object(options, real, notes);
    inputs.emplace_back("mesh", options.mesh);
  }
  check_real(options, real, surface.get(), notes);
  const Plugins plugins = options.plugins.load();
  for (const auto& text : options.models) {
    const auto [name, file] = name_and_file(text, "--model");
    inputs.emplace_back("model " + name, file);
    const Model model = load_model(file, plugins);
    find_renderer(model);
    names.push_back(name);
    sources.push_back({name, [model, surface, &real, outward, contact_N] {
                         const Recording rendered = rendered_by(model, surface, real);
                         return std::vector<pc::PressSignal>{pc::press_signal(rendered, outward, contact_N)};
                       }});
  }
  std::optional<pc::PairedComparisons> answers;
  if (!options.answers.empty()) {
    answers = pc::read_answers(options.answers, names);
    inputs.emplace_back("answers", options.answers);
  }
  Provenance provenance = make_provenance(command_line());
  provenance.inputs = described(inputs);
  keep_freed_memory();

  Progress progress("conditions", sources.size());
  settings.progress = [&progress](std::size_t done) { progress.update(done); };
  auto evaluation = pc::evaluate(signals_of(options, options.real, outward, contact_N), sources, settings);
  evaluation.remarks.insert(evaluation.remarks.begin(), notes.begin(), notes.end());
  std::optional<pc::SubjectiveComparison> people;
  if (answers) people = pc::compare_with_people(evaluation, *answers);
  const auto* const shown = people ? &*people : nullptr;

  const std::filesystem::path out = options.out;
  write_file(out / "perception.json", pc::evaluation_to_json(evaluation, shown));
  write_html(out / "report.html", perception_page("Perceptual evaluation", evaluation, shown, provenance));
  fmt::print("{}", paper_table(evaluation));
  for (const auto& remark : evaluation.remarks) fmt::print(stderr, "note: {}\n", remark);
  fmt::print("{} of {} dimensions explain {:.1f} %; {} and {}\n", evaluation.space.dimensions,
             evaluation.space.available, 100.0 * evaluation.space.explained_share, (out / "report.html").string(),
             (out / "perception.json").string());
  return ExitStatus::passed;
}

}  // namespace touchstone::apps
