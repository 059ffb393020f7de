#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>

#include "apps/commands.h"
#include "apps/discrepancy_page.h"
#include "apps/plugin_flags.h"
#include "harness/base/atomic_file.h"
#include "harness/base/units.h"
#include "harness/discrepancy/findings.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/model.h"
#include "harness/report/page_html.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/facet_angle.h"
#include "harness/surface/mesh_file.h"
#include "renderers/catalogue.h"
#include "renderers/model_predictor.h"

namespace touchstone::apps {
namespace {

constexpr std::size_t noise_replicas = 8;
constexpr double held_back_block_s = 2.0;

struct Options {
  std::filesystem::path model;
  std::filesystem::path mesh;
  std::string mesh_unit = "m";
  std::filesystem::path recording;
  std::filesystem::path holdout;
  std::filesystem::path instrument;
  std::filesystem::path out;
  std::filesystem::path json;
  std::uint64_t seed = 1;
  PluginFlags plugins;
};

std::vector<Candidate> all_candidates() {
  std::vector<Candidate> candidates;
  for (const auto& effect : effect_catalogue()) candidates.push_back({effect.name, Side::contact, effect.parameters});
  for (const auto& entry : instrument_declarations()) {
    candidates.push_back({entry.name, Side::instrument, entry.parameters});
  }
  return candidates;
}

InstrumentDescription instrument_of(const Options& options, const Recording& train, const TriangleMesh& mesh) {
  InstrumentDescription instrument =
      options.instrument.empty() ? estimate_instrument(train) : load_instrument(options.instrument);
  instrument.normal_error_rad = median_facet_angle_rad(mesh);
  return instrument;
}

ForceGap measure_gap(const SearchResult& search, const SearchData& data) {
  ForceGap gap;
  gap.train_before_N = rms_force_error_N(data.train, data.train.predictor->predict(search.start));
  gap.train_after_N = rms_force_error_N(data.train, data.train.predictor->predict(search.model));
  gap.holdout_before_N = rms_force_error_N(data.holdout, data.holdout.predictor->predict(search.start));
  gap.holdout_after_N = rms_force_error_N(data.holdout, data.holdout.predictor->predict(search.model));
  gap.noise_floor_N = search.noise_rms_N;
  return gap;
}

// Only rivals alike need another recording; the first pair decides what to do.
std::optional<NextExperiment> next_experiment(const SearchResult& search, const SearchData& data,
                                              const MakePredictor& make, double force_noise_N) {
  for (const FoundEffect& effect : search.found) {
    for (const Rival& rival : effect.rivals) {
      if (!rival.alike) continue;
      return propose_experiment(*data.train.recording, data.train.predictor->predict(search.model), search.model,
                                rival.model, make, force_noise_N);
    }
  }
  return std::nullopt;
}

ExitStatus discrepancy(const Options& options) {
  ensure_writable_folder(options.out);
  const Model model = load_model(options.model, options.plugins.load());
  const TriangleMesh mesh = load_mesh(options.mesh, length_unit_factor(options.mesh_unit));
  const auto surface = make_embree_surface(mesh);
  make_renderer(model, surface);  // refuses a wrong model before the long work begins
  const Recording train = load_recording(options.recording);
  const std::optional<Recording> second =
      options.holdout.empty() ? std::nullopt : std::optional(load_recording(options.holdout));
  const Recording& holdout = second ? *second : train;
  const InstrumentDescription instrument = instrument_of(options, train, mesh);

  const MakePredictor make = [&](const MotionColumns& motion) { return make_model_predictor(surface, motion); };
  const auto train_predictor = make(train.motion);
  const auto holdout_predictor = make(holdout.motion);
  NoiseModel train_noise(train.motion, instrument, make, noise_replicas, options.seed);
  NoiseModel holdout_noise(holdout.motion, instrument, make, noise_replicas, options.seed + 1);
  const double held_back_s = second ? 0.0 : held_back_block_s;
  const SearchData data{{&train, train_predictor.get(), &train_noise, {held_back_s, false}},
                        {&holdout, holdout_predictor.get(), &holdout_noise, {held_back_s, true}},
                        block_window_s(instrument.position_rate_Hz, train.motion),
                        6.0 * instrument.force_noise_N + instrument.force_step_N.maxCoeff()};
  const auto candidates = all_candidates();

  Findings findings;
  findings.search =
      search_effects(data, model, candidates, {}, [](const std::string& line) { fmt::print(stderr, "{}\n", line); });
  findings.gap = measure_gap(findings.search, data);
  const Prediction before = data.holdout.predictor->predict(model);
  const Prediction after = data.holdout.predictor->predict(findings.search.model);
  findings.where = sort_by_regime(data.holdout, before, after, data.force_floor_N);
  findings.next = next_experiment(findings.search, data, make, instrument.force_noise_N);
  findings.instrument_declared = instrument.declared;
  findings.blocks_held_back = !second;
  conclude(findings, candidates);

  std::string trajectory;
  if (findings.next && !findings.ambiguous.empty()) {
    trajectory = "next.csv";
    save_trajectory(options.out / trajectory, InTrajectory{findings.next->motion});
  }
  write_file(options.out / "model.json", model_to_json(findings.search.model) + "\n");
  const std::string json = findings_to_json(findings, trajectory);
  write_file(options.out / "findings.json", json);
  if (!options.json.empty()) write_file(options.json, json);
  Provenance provenance = make_provenance(command_line());
  provenance.inputs = {describe_input("model", options.model), describe_input("mesh", options.mesh),
                       describe_input("recording", options.recording)};
  if (second) provenance.inputs.push_back(describe_input("holdout", options.holdout));
  if (instrument.declared) provenance.inputs.push_back(describe_input("instrument", options.instrument));
  write_html(options.out / "report.html", discrepancy_page(findings, data.holdout, before, after, mesh, provenance));

  fmt::print("{}\n{}\n", to_string(findings.verdict), findings.explanation);
  for (std::size_t e = 0; e < findings.search.found.size(); ++e) {
    fmt::print("  {}\n", findings.search.found[e].name);
    for (const FoundParameter& p : findings.parameters[e]) {
      fmt::print("    {:28} {:>12.5g} {:8} 95 %: {:.5g} to {:.5g}\n", p.name, p.value, p.unit, p.low95, p.high95);
    }
  }
  fmt::print("held-out RMS force error: before {:.4f} N, after {:.4f} N, expected of noise {:.4f} N\nreport: {}\n",
             findings.gap.holdout_before_N, findings.gap.holdout_after_N, findings.gap.noise_floor_N,
             (options.out / "report.html").string());
  return ExitStatus::passed;
}

}  // namespace

void add_discrepancy(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand(
      "discrepancy", "Find where simulation and measurement disagree, name the missing effect and show the gap shrink");
  const auto options = std::make_shared<Options>();
  command->add_option("--model", options->model, "starting model (JSON)")->required();
  command->add_option("--mesh", options->mesh, "object: OBJ, OFF, PLY or STL")->required();
  command->add_option("--mesh-unit", options->mesh_unit, "unit of the mesh: m, mm, cm or km")->capture_default_str();
  command->add_option("--recording", options->recording, "measured positions and forces to learn from")->required();
  command->add_option("--holdout", options->holdout,
                      "second recording to judge by; without it, alternating blocks of 2 s of the first are kept back");
  command->add_option("--instrument", options->instrument,
                      "what the makers of sensor and tracker declare (JSON); without it the noise is estimated");
  command->add_option("--out", options->out, "folder for report.html, findings.json, model.json")->required();
  command->add_option("--json", options->json, "write the findings here too");
  command->add_option("--seed", options->seed, "of the simulated noise")->capture_default_str();
  options->plugins.add_to(*command);
  command->footer(
      "Examples:\n"
      "  touchstone discrepancy --model base.json --mesh object.obj --recording train.csv --holdout test.csv \\\n"
      "      --instrument sensor.json --out found\n"
      "  touchstone discrepancy --model base.json --mesh object.stl --mesh-unit mm --recording scan.csv --out found\n"
      "  touchstone replay --model found/model.json --mesh object.obj --trajectory test.csv --out rendered.csv\n"
      "Measured positions are the in-trajectory as they stand.");
  command->callback([options, &run] { run = [options] { return discrepancy(*options); }; });
}

}  // namespace touchstone::apps
