#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "apps/command_perceive_options.h"
#include "apps/commands.h"
#include "harness/base/atomic_file.h"
#include "harness/base/freed_memory.h"
#include "harness/base/progress.h"
#include "harness/discrepancy/instrument_description.h"
#include "harness/perception/judge/judged_conditions.h"
#include "harness/recording/recording_file.h"
#include "harness/report/console.h"
#include "harness/report/judgement_page.h"
#include "harness/report/page_html.h"
#include "renderers/catalogue.h"

namespace touchstone::apps {
namespace {

namespace pc = perception;

pc::JudgeOptions judge_options(const PerceiveOptions& options) {
  pc::JudgeOptions settings;
  if (!options.thresholds.empty()) settings.thresholds = pc::read_thresholds(options.thresholds);
  if (options.depth_known) settings.thresholds.depth_fraction = 0.0;
  if (!options.instrument.empty()) {
    const auto instrument = load_instrument(options.instrument);
    settings.declared = {instrument.force_noise_N, instrument.force_noise_time_constant_s,
                         geometry_deviation_m(instrument)};
  }
  for (const auto& name : options.without) {
    std::string known;
    bool found = false;
    for (std::size_t c = 0; c < pc::kChannels; ++c) {
      const auto channel = static_cast<pc::Channel>(c);
      known += fmt::format("{}{}", c == 0 ? "" : ", ", pc::name_of(channel));
      if (name != pc::name_of(channel)) continue;
      settings.without.push_back(channel);
      found = true;
    }
    if (!found) throw UsageError(fmt::format("--without {}: one of {} was expected", name, known));
  }
  return settings;
}

std::string judged_table(const pc::JudgedConditions& judged) {
  std::vector<std::vector<std::string>> rows{{"rank", "condition", "a person tells it", "95 %", "d'", "verdict", "by"}};
  std::vector<const pc::JudgedCondition*> ranked;
  for (const auto& c : judged.conditions) ranked.push_back(&c);
  std::ranges::sort(ranked, {}, &pc::JudgedCondition::rank);
  for (const auto* c : ranked) {
    const pc::Judgement& j = c->judgement;
    std::string by = "nothing above noise";
    if (j.gives_away) {
      const auto& channel = j.channels[static_cast<std::size_t>(*j.gives_away)];
      by = fmt::format("{}: {}", pc::name_of(channel.channel), channel.what);
    }
    rows.push_back({fmt::format("{}", c->rank), c->name, fmt::format("{:.0f} %", 100.0 * j.noticed_probability),
                    fmt::format("{:.0f} to {:.0f}", 100.0 * j.noticed_low95, 100.0 * j.noticed_high95),
                    fmt::format("{:.2f}", j.d_prime), std::string(pc::name_of(j.verdict)), by});
  }
  return align_columns(rows);
}

// Models and files as sources of recordings; what is wrong with a model is said before anything runs.
struct PerceiveSources {
  std::vector<pc::RecordingSource> repeats;
  std::vector<pc::RecordingSource> conditions;
  std::vector<std::pair<std::string, std::string>> inputs;
  std::vector<std::string> notes;
};

PerceiveSources perceive_sources(const PerceiveOptions& options, const Recording& real) {
  PerceiveSources sources;
  sources.inputs.emplace_back("real", options.real);
  const auto from_file = [&options, &real](const std::string& name, const std::string& file) {
    return pc::RecordingSource{name, [&options, &real, file] {
                                 Recording recording = read_recording(options, file);
                                 check_condition(real, recording);
                                 return recording;
                               }};
  };
  for (const auto& file : options.repeats) {
    sources.inputs.emplace_back("repeat", file);
    sources.repeats.push_back(from_file(file, file));
  }
  for (const auto& text : options.conditions) {
    const auto [name, file] = name_and_file(text, "--condition");
    sources.inputs.emplace_back("condition " + name, file);
    sources.conditions.push_back(from_file(name, file));
  }
  std::shared_ptr<const Surface> surface;
  if (!options.models.empty()) {
    surface = rendered_object(options, real, sources.notes);
    sources.inputs.emplace_back("mesh", options.mesh);
  }
  check_real(options, real, surface.get(), sources.notes);
  const Plugins plugins = options.plugins.load();
  for (const auto& text : options.models) {
    const auto [name, file] = name_and_file(text, "--model");
    sources.inputs.emplace_back("model " + name, file);
    const Model model = load_model(file, plugins);
    find_renderer(model);
    sources.conditions.push_back({name, [model, surface, &real] { return rendered_by(model, surface, real); }});
  }
  if (!options.thresholds.empty()) sources.inputs.emplace_back("thresholds", options.thresholds);
  if (!options.instrument.empty()) sources.inputs.emplace_back("instrument", options.instrument);
  return sources;
}

ExitStatus perceive_by_judge(const PerceiveOptions& options) {
  if (!options.answers.empty()) throw UsageError("--answers goes with --method paper");
  if (options.explained_share) throw UsageError("--explained goes with --method paper; the judge has no dimensions");
  const pc::JudgeOptions settings = judge_options(options);
  const Recording real = read_recording(options, options.real);
  const Vec3 outward = press_direction_of(options.direction, real);
  const PerceiveSources sources = perceive_sources(options, real);
  Provenance provenance = make_provenance(command_line());
  provenance.inputs = described(sources.inputs);
  keep_freed_memory();
  Progress progress("conditions", sources.conditions.size());
  const auto judged = pc::judge_conditions(real, sources.repeats, sources.conditions, outward, settings,
                                           [&progress](std::size_t done) { progress.update(done); });
  const std::filesystem::path out = options.out;
  write_file(out / "perception.json", pc::judged_to_json(judged, settings));
  write_html(out / "report.html",
             judgement_page("What a person would notice", judged, settings, sources.notes, provenance));
  fmt::print("{}", judged_table(judged));
  for (const auto& note : sources.notes) fmt::print(stderr, "note: {}\n", note);
  std::vector<std::string> said;
  for (const auto& condition : judged.conditions) {
    for (const auto& remark : condition.judgement.remarks) {
      if (std::ranges::count(said, remark) > 0) continue;
      fmt::print(stderr, "note: {}\n", remark);
      said.push_back(remark);
    }
  }
  fmt::print("{} and {}\n", (out / "report.html").string(), (out / "perception.json").string());
  return ExitStatus::passed;
}

ExitStatus perceive_command(const PerceiveOptions& options) {
  if (options.conditions.empty() && options.models.empty()) {
    throw UsageError("at least one --condition NAME=FILE or --model NAME=MODEL is needed");
  }
  if (!options.models.empty() && options.mesh.empty())
    throw UsageError("--model needs --mesh, the object that it renders");
  ensure_writable_folder(options.out);
  return options.method == "paper" ? perceive_by_paper(options) : perceive_by_judge(options);
}

// Of --method paper.
void add_paper_flags(CLI::App& command, PerceiveOptions& options) {
  command.add_option("--answers", options.answers, "Paper: paired comparisons, CSV with subject,first,second,chosen");
  command
      .add_option("--scaling", options.scaling,
                  "Paper: scaling of features: reference-norm, none, block-spread, standardised, pooled-range")
      ->capture_default_str();
  command.add_option("--explained", options.explained_share,
                     "Paper: share of the variance that the dimensions explain: 0.9, as in the paper, if not given");
  command.add_option("--window", options.window, "Paper: window of rate-hardness in samples")->capture_default_str();
  command.add_flag("--hardness-in-band", options.hardness_in_band,
                   "Paper: rate-hardness after the output band rather than as measured");
  command
      .add_option("--band", options.band_Hz,
                  "Paper: output band of the finger in Hz (2-6 in the literature), 0 for none")
      ->capture_default_str();
  command.add_option("--dead-zone", options.dead_zone_N, "Paper: dead zone of the force sensor in N")
      ->capture_default_str();
  command.add_option("--rate", options.rate_Hz, "Paper: common rate in Hz; 0: the real recording's median rate")
      ->capture_default_str();
  command
      .add_option("--duration-tolerance", options.duration_tolerance,
                  "Paper: durations may differ by this share of the real one")
      ->capture_default_str();
}

}  // namespace

void add_perceive(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand(
      "perceive",
      "Say for each rendering how likely a person tells it from the real thing, by which channel, and what to change");
  auto options = std::make_shared<PerceiveOptions>();
  command->add_option("--real", options->real, "Recording of the real process (CSV or HDF5)")->required();
  command->add_option("--condition", options->conditions, "NAME=FILE, a recording of a condition; repeat for more");
  command->add_option("--model", options->models, "NAME=MODEL, a condition that a model renders along the real path");
  command->add_option("--mesh", options->mesh, "The object that models render");
  command->add_option("--mesh-unit", options->mesh_unit, "Unit of the mesh's coordinates: m, mm, cm, km, um")
      ->capture_default_str();
  command->add_option(
      "--repeat", options->repeats,
      "Another recording of the real process: how much they differ is the noise floor; repeat for more");
  command->add_flag("--flip-force", options->flip_force,
                    "The recordings have the force BY the probe: negate it, in all of them");
  command
      ->add_option("--method", options->method,
                   "judge: probability of noticing, pair by pair; paper: the distance in perception space of Shao, Wu "
                   "and Ouyang")
      ->check(CLI::IsMember({"judge", "paper"}))
      ->capture_default_str();
  command->add_option(
      "--thresholds", options->thresholds,
      "JSON that replaces just noticeable differences; perception.json holds those in use, with their sources");
  command->add_flag("--depth-known", options->depth_known,
                    "The hand is led to the same depth, or presses to a stop, so that forces can be compared there; "
                    "without it, an error of the depth hides differences of the force");
  command->add_option("--instrument", options->instrument,
                      "What the makers declare (touchstone-instrument/1), for the noise floor without repeats");
  command->add_option("--without", options->without,
                      "Leave a channel out of the sum, e.g. position where the frames of the recordings differ");
  command->add_option(
      "--extend-edges", options->extend_edges,
      "Continue open edges of the mesh by this width, with its unit (2mm), 0 for none; as needed if not "
      "given");
  command->add_option("--out", options->out, "Folder for perception.json and report.html")->required();
  command
      ->add_option("--direction", options->direction,
                   "Outward direction of pressing: force (that of the real process), +x, -x, +y, -y, +z, -z")
      ->capture_default_str();
  add_paper_flags(*command, *options);
  options->plugins.add_to(*command);
  command->footer(
      "Examples:\n"
      "  touchstone perceive --real spring.csv --repeat again.csv --condition omega=omega.csv --condition "
      "touch=touch.csv "
      "--out perceived\n"
      "  touchstone perceive --real press.csv --model stiff=stiff.json --model soft=soft.json --mesh phantom.obj "
      "--mesh-unit mm --out perceived\n"
      "  touchstone perceive --real spring.csv --condition a=a.csv --condition b=b.csv --condition c=c.csv "
      "--method paper --answers answers.csv --out perceived");
  command->callback([options, &run] { run = [options] { return perceive_command(*options); }; });
}

}  // namespace touchstone::apps
