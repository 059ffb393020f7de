#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include "apps/commands.h"
#include "apps/plugin_flags.h"
#include "harness/base/atomic_file.h"
#include "harness/base/freed_memory.h"
#include "harness/base/in_parallel.h"
#include "harness/base/progress.h"
#include "harness/base/units.h"
#include "harness/perception/perception_json.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/replay.h"
#include "harness/report/console.h"
#include "harness/report/page_html.h"
#include "harness/report/perception_page.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_file.h"
#include "renderers/catalogue.h"

namespace touchstone::apps {
namespace {

namespace pc = perception;

struct PerceiveOptions {
  std::string real, mesh, mesh_unit = "m", direction = "force", answers, out, scaling = "reference-norm";
  std::vector<std::string> conditions, models;
  PluginFlags plugins;
  double explained_share = 0.9;
  double rate_Hz = 0.0;
  double dead_zone_N = 0.0;
  double band_Hz = pc::kFingerBandHigh_Hz;
  double duration_tolerance = 0.2;
  std::size_t window = pc::kRateHardnessWindow;
  bool hardness_in_band = false;
};

std::pair<std::string, std::string> name_and_file(const std::string& text, const char* option) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    throw UsageError(fmt::format("{} {}: NAME=FILE was expected", option, text));
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

Vec3 direction_of(const std::string& text, const Recording& real) {
  static const std::map<std::string, Vec3> axes{{"+x", Vec3::UnitX()},  {"-x", -Vec3::UnitX()}, {"+y", Vec3::UnitY()},
                                                {"-y", -Vec3::UnitY()}, {"+z", Vec3::UnitZ()},  {"-z", -Vec3::UnitZ()}};
  if (text == "force") return pc::press_direction(real);
  const auto found = axes.find(text);
  if (found == axes.end())
    throw UsageError(fmt::format("--direction {}: force, +x, -x, +y, -y, +z or -z was expected", text));
  return found->second;
}

// What the model renders along the real process's own path.
Recording rendered_by(const Model& model, const std::shared_ptr<const Surface>& surface, const Recording& real) {
  const auto renderer = make_renderer(model, surface);
  const RenderedTrajectory rendered = replay(*renderer, InTrajectory{real.motion});
  Recording recording;
  recording.motion = real.motion;
  recording.f_W_N = rendered.f_W_N;
  recording.source = model.source;
  return recording;
}

// Where the files come from, in their order: hashing many recordings takes as long as comparing them.
std::vector<InputFile> described(const std::vector<std::pair<std::string, std::string>>& role_and_file) {
  std::vector<InputFile> result(role_and_file.size());
  const auto describe = [&](std::size_t i) {
    result[i] = describe_input(role_and_file[i].first, role_and_file[i].second);
  };
  in_parallel(result.size(), describe, 1);
  return result;
}

std::string table_of(const pc::PerceptualEvaluation& evaluation) {
  std::vector<std::vector<std::string>> rows{{"condition", "rank", "distance"}};
  for (const auto& m : pc::statistical_methods()) rows.front().emplace_back(m.method.name);
  for (const auto& c : evaluation.conditions) {
    rows.push_back({c.name, fmt::format("{}", c.rank_perception), fmt::format("{:.4f}", c.distance)});
    for (const auto& value : c.statistics) rows.back().push_back(value ? fmt::format("{:.4g}", *value) : "none");
  }
  return align_columns(rows);
}

ExitStatus perceive_command(const PerceiveOptions& options) {
  pc::EvaluationOptions settings;
  settings.scaling = pc::feature_scaling(options.scaling);
  settings.explained_share = options.explained_share;
  settings.matrix.rate_Hz = options.rate_Hz;
  settings.duration_tolerance = options.duration_tolerance;
  settings.image.sensor_dead_zone_N = options.dead_zone_N;
  settings.image.output_band_Hz = options.band_Hz;
  settings.image.rate_hardness_window = options.window;
  settings.image.rate_hardness_in_band = options.hardness_in_band;
  if (options.conditions.empty() && options.models.empty()) {
    throw UsageError("at least one --condition NAME=FILE or --model NAME=MODEL is needed");
  }
  if (!options.models.empty() && options.mesh.empty())
    throw UsageError("--model needs --mesh, the object that it renders");
  ensure_writable_folder(options.out);

  const Recording real = load_recording(options.real);
  const Vec3 outward = direction_of(options.direction, real);
  const double contact_N = settings.image.force_law.absolute_threshold;
  std::vector<std::pair<std::string, std::string>> inputs{{"real", options.real}};

  std::vector<pc::ConditionSource> sources;
  std::vector<std::string> names;
  for (const auto& text : options.conditions) {
    const auto [name, file] = name_and_file(text, "--condition");
    inputs.emplace_back("condition " + name, file);
    names.push_back(name);
    sources.push_back({name, [file = file, outward, contact_N] {
                         return std::vector<pc::PressSignal>{
                             pc::press_signal(load_recording(file), outward, contact_N)};
                       }});
  }
  std::shared_ptr<const Surface> surface;
  if (!options.models.empty()) {
    surface = make_embree_surface(load_mesh(options.mesh, length_unit_factor(options.mesh_unit)));
    inputs.emplace_back("mesh", options.mesh);
  }
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
  const auto evaluation = pc::evaluate({pc::press_signal(real, outward, contact_N)}, sources, settings);
  std::optional<pc::SubjectiveComparison> people;
  if (answers) people = pc::compare_with_people(evaluation, *answers);
  const auto* const shown = people ? &*people : nullptr;

  const std::filesystem::path out = options.out;
  write_file(out / "perception.json", pc::evaluation_to_json(evaluation, shown));
  write_html(out / "report.html", perception_page("Perceptual evaluation", evaluation, shown, provenance));
  fmt::print("{}", table_of(evaluation));
  for (const auto& remark : evaluation.remarks) fmt::print(stderr, "note: {}\n", remark);
  fmt::print("{} of {} dimensions explain {:.1f} %; {} and {}\n", evaluation.space.dimensions,
             evaluation.space.available, 100.0 * evaluation.space.explained_share, (out / "report.html").string(),
             (out / "perception.json").string());
  return ExitStatus::passed;
}

}  // namespace

void add_perceive(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand(
      "perceive",
      "Rank rendering conditions by how close they feel to a real process, beside what plain statistics say");
  auto options = std::make_shared<PerceiveOptions>();
  command->add_option("--real", options->real, "Recording of the real process (CSV or HDF5)")->required();
  command->add_option("--condition", options->conditions, "NAME=FILE, a recording of a condition; repeat for more");
  command->add_option("--model", options->models, "NAME=MODEL, a condition that a model renders along the real path");
  command->add_option("--mesh", options->mesh, "The object that models render");
  command->add_option("--mesh-unit", options->mesh_unit, "Unit of the mesh's coordinates: m, mm, cm, km, um")
      ->capture_default_str();
  command->add_option("--answers", options->answers, "Paired comparisons, CSV with subject,first,second,chosen");
  command->add_option("--out", options->out, "Folder for perception.json and report.html")->required();
  command
      ->add_option("--direction", options->direction,
                   "Outward direction of pressing: force (that of the real process), +x, -x, +y, -y, +z, -z")
      ->capture_default_str();
  command
      ->add_option("--scaling", options->scaling,
                   "Scaling of features: reference-norm, none, block-spread, standardised, pooled-range")
      ->capture_default_str();
  command->add_option("--explained", options->explained_share, "Share of the variance that the dimensions explain")
      ->capture_default_str();
  command->add_option("--window", options->window, "Window of rate-hardness in samples")->capture_default_str();
  command->add_flag("--hardness-in-band", options->hardness_in_band,
                    "Rate-hardness after the output band rather than as measured");
  command->add_option("--band", options->band_Hz, "Output band of the finger in Hz (2-6 in the literature), 0 for none")
      ->capture_default_str();
  command->add_option("--dead-zone", options->dead_zone_N, "Dead zone of the force sensor in N")->capture_default_str();
  command->add_option("--rate", options->rate_Hz, "Common rate in Hz; 0: the real recording's median rate")
      ->capture_default_str();
  command
      ->add_option("--duration-tolerance", options->duration_tolerance,
                   "Durations may differ by this share of the real one")
      ->capture_default_str();
  options->plugins.add_to(*command);
  command->footer(
      "Examples:\n"
      "  touchstone perceive --real spring.csv --condition omega=omega.csv --condition touch=touch.csv --out "
      "perceived\n"
      "  touchstone perceive --real press.csv --model stiff=stiff.json --model soft=soft.json --mesh phantom.obj "
      "--mesh-unit mm --out perceived\n"
      "  touchstone perceive --real spring.csv --condition a=a.csv --condition b=b.csv --condition c=c.csv "
      "--answers answers.csv --out perceived");
  command->callback([options, &run] { run = [options] { return perceive_command(*options); }; });
}

}  // namespace touchstone::apps
