#include "harness/pipeline/discrepancy/workflow.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/input_files.h"
#include "harness/discrepancy/findings.h"
#include "harness/discrepancy/tracker_spectrum.h"
#include "harness/pipeline/discrepancy/earlier_run.h"
#include "harness/pipeline/discrepancy/force_gap.h"
#include "harness/pipeline/discrepancy/golden_offer.h"
#include "harness/pipeline/discrepancy/inputs.h"
#include "harness/pipeline/discrepancy/page.h"
#include "harness/pipeline/discrepancy/thinning.h"
#include "harness/pipeline/discrepancy/verify.h"
#include "harness/recording/recording_file.h"
#include "harness/recording_checks/repeat_floor.h"
#include "harness/rendering/model.h"
#include "harness/rendering/predictor.h"
#include "harness/report/page_html.h"
#include "harness/surface/facet_angle.h"

namespace touchstone::pipeline {
using discrepancy::Evidence;
using discrepancy::Findings;
using discrepancy::InstrumentDescription;
using discrepancy::NoiseModel;
using discrepancy::Part;
using recording::Recording;
using rendering::Candidate;
using rendering::Catalogue;
using rendering::MakePredictor;
using rendering::Model;
using rendering::Prediction;
using report::describe_input;

namespace {

constexpr double held_back_least_blocks = 20.0;  // a short recording has shorter blocks

// The noise of the force from the part that is learnt from.
InstrumentDescription estimate_from(const Recording& train, const Part& learnt_from) {
  InstrumentDescription instrument = discrepancy::estimate_instrument(train);
  instrument.force_noise_N = discrepancy::estimate_instrument(samples_of(learnt_from, train)).force_noise_N;
  return instrument;
}

InstrumentDescription instrument_of(const DiscrepancyFiles& files, const Recording& train, const Part& learnt_from,
                                    const surface::TriangleMesh& mesh, const surface::Surface& surface) {
  InstrumentDescription instrument =
      files.instrument.empty() ? estimate_from(train, learnt_from) : discrepancy::load_instrument(files.instrument);
  if (!(instrument.force_noise_N > 0.0)) {
    throw BadData(files.instrument.empty()
                      ? fmt::format("{}: no noise of the force can be estimated from it: give the sensor's with "
                                    "--instrument, whose force_noise_N is above zero",
                                    files.recording.string())
                      : fmt::format("{}: /force_noise_N: above zero was expected: everything is judged by it",
                                    files.instrument.string()));
  }
  std::vector<std::int32_t> touched;
  const std::size_t stride = std::max<std::size_t>(1, train.size() / 1000);
  for (std::size_t i = 0; i < train.size(); i += stride) {
    touched.push_back(surface.closest(train.motion.p_W_m[i]).triangle);
  }
  instrument.normal_error_rad = median_facet_angle_rad(mesh, touched);
  instrument.mesh_extent_m = mesh.bounds().diagonal().norm();
  if (instrument.declared) instrument.position_low_pass = measured_low_pass(train.motion, instrument);
  return instrument;
}

// The estimate with the tracker that the spectrum shows, if it shows one with more noise.
std::optional<InstrumentDescription> suggest_instrument(const InstrumentDescription& estimated,
                                                        const MotionColumns& motion) {
  if (estimated.declared) return std::nullopt;
  const std::optional<discrepancy::TrackerNoise> tracker = discrepancy::tracker_noise(motion);
  if (!tracker || !(tracker->position_noise_m > estimated.position_noise_m)) return std::nullopt;
  InstrumentDescription suggested = estimated;
  suggested.position_noise_m = tracker->position_noise_m;
  suggested.position_rate_Hz = tracker->position_rate_Hz;
  return suggested;
}

// An estimate of the noise that expects more than even the starting model leaves is too large: quantization, vibration
// and jitter look like noise to it. It is brought down to the residual.
void bound_by_residual(InstrumentDescription& instrument, const Recording& train, const Part& learnt_from,
                       const Model& model, const MakePredictor& make, const DiscrepancyFiles& files) {
  if (instrument.declared) return;
  const Prediction nominal = make(train.motion)->predict(model);
  NoiseModel noise(train.motion, nominal.n_W, instrument, make, files.seed, files.seed + 2);
  double expected = 0.0, left = 0.0;
  const auto squares = noise.expected_squares(model, nominal);
  for (std::size_t i = 0; i < train.size(); ++i) {
    if (!learnt_from.contains(train.motion.t_s[i], train.motion.t_s.front())) continue;
    expected += squares[i];
    left += (train.f_W_N[i] - nominal.f_W_N[i]).squaredNorm();
  }
  if (!(left > 0.0) || !(expected > left)) return;
  const double factor = std::sqrt(left / expected);
  instrument.force_noise_N *= factor;
  instrument.position_noise_m *= factor;
}

// Of how many samples the search takes the mean. A short recording whose tracker nobody described stays as it is; of a
// long one the tracker is assumed to be no faster than a hand needs.
std::size_t mean_over(const Recording& train, const InstrumentDescription& instrument) {
  constexpr double tracker_Hz = 60.0;
  constexpr std::size_t long_recording = 40000;  // samples: a sensor's minute
  if (!instrument.declared && train.size() < long_recording) return 1;
  const double rate_Hz = instrument.declared ? instrument.position_rate_Hz : tracker_Hz;
  return samples_per_mean(train.motion, discrepancy::block_window_s(rate_Hz, train.motion));
}

// Nothing where no law was found, where it does not help on the held-out samples, or where noise alone leaves as much
// as the start does.
std::optional<discrepancy::LawGap> measure_law(const discrepancy::SearchResult& search, const Evidence& samples,
                                               double noise_N) {
  if (!search.law.found()) return std::nullopt;
  const auto rms_N = [&](const Model& model) { return rms_force_error_N(samples, samples.predictor->predict(model)); };
  discrepancy::LawGap gap{rms_N(search.base), rms_N(search.model), rms_N(search.law.model), 0.0,
                          search.law_gain,    search.law_error};
  const double beyond = gap.start_N * gap.start_N - noise_N * noise_N;
  if (!(gap.with_N < gap.without_N) || !(beyond > 0.0)) return std::nullopt;
  gap.closed = (gap.start_N * gap.start_N - gap.with_N * gap.with_N) / beyond;
  return gap;
}

// One file for each piece, and the model with the law.
void write_law(const Findings& findings, const std::filesystem::path& out) {
  std::size_t count = 0;
  for (const discrepancy::LawPiece& piece : findings.search.law.pieces)
    write_file(out / fmt::format("law-{}.json", ++count), effect_to_json(*piece.effect));
  write_file(out / "empirical.json", model_to_json(findings.search.law.model, out) + "\n");
}

// Only indistinguishable rivals need another recording; the first pair decides what to do.
std::optional<discrepancy::NextExperiment> next_experiment(const discrepancy::SearchResult& search,
                                                           const discrepancy::SearchData& data,
                                                           const MakePredictor& make,
                                                           const InstrumentDescription& instrument) {
  for (const discrepancy::FoundEffect& effect : search.found) {
    for (const discrepancy::Rival& rival : effect.rivals) {
      if (!rival.indistinguishable) continue;
      return discrepancy::propose_experiment(*data.learning.recording, data.learning.predictor->predict(search.model),
                                             search.model, rival.model, make, instrument.force_noise_N,
                                             instrument.position_noise_m);
    }
  }
  return std::nullopt;
}

// Once more from the files alone, if possible in a process that knows nothing of this one. Nothing if it cannot be
// repeated; throws if it leaves another error.
std::optional<double> run_again(const Catalogue& catalogue, const DiscrepancyFiles& files, const Evidence& samples,
                                const Model& after, double force_noise_N) {
  if (files.synthesize_in_trajectory || files.plugins != nullptr) return std::nullopt;
  DiscrepancyFiles written = files;
  written.model = files.out / "model.json";
  if (!files.holdout.empty()) written.recording = files.holdout;
  const std::optional<double> again_N =
      files.program.empty() ? rms_of_files_N(catalogue, written) : rms_in_fresh_process_N(written);
  if (!again_N) return std::nullopt;
  Evidence whole = samples;
  whole.part = {};
  const double here_N = rms_force_error_N(whole, whole.predictor->predict(after));
  if (std::abs(*again_N - here_N) > 1e-9 * std::max(here_N, force_noise_N)) {
    throw BadData(fmt::format("{}: run again from this file alone, the model leaves {} N instead of {} N",
                              written.model.string(), *again_N, here_N));
  }
  return again_N;
}

report::Provenance provenance_of(const DiscrepancyFiles& files, bool instrument_declared) {
  report::Provenance provenance = report::make_provenance(files.command_line);
  provenance.inputs = {describe_input("model", files.model), describe_input("recording", files.recording)};
  if (!files.mesh.empty()) provenance.inputs.push_back(describe_input("mesh", files.mesh));
  if (!files.holdout.empty()) provenance.inputs.push_back(describe_input("holdout", files.holdout));
  if (!files.repeat.empty()) provenance.inputs.push_back(describe_input("repeat", files.repeat));
  for (const auto& file : files.effects) provenance.inputs.push_back(describe_input("effect", file));
  if (instrument_declared) provenance.inputs.push_back(describe_input("instrument", files.instrument));
  return provenance;
}

// What a user reads on the console.
std::string findings_text(const Findings& findings, const DiscrepancyFiles& files) {
  std::string text = fmt::format("{}\n{}\n", to_string(findings.verdict), findings.explanation);
  for (const discrepancy::VerdictGate& gate : findings.gates) {
    if (!gate.passed)
      text += fmt::format("  gate {}{}: {} {:.4g}, limit {:.4g} ({})\n", gate.code,
                          gate.code == findings.code ? ", which decides" : "", gate.statistic, gate.value, gate.limit,
                          gate.limit_from);
  }
  for (std::size_t e = 0; e < findings.search.found.size(); ++e) {
    text += fmt::format("  {}\n", findings.search.found[e].name);
    for (const discrepancy::FoundParameter& p : findings.parameters[e]) {
      text += fmt::format("    {:28} {:>12.5g} {:8} {}\n", p.name, p.value, p.unit,
                          p.undetermined.empty() ? fmt::format("95 %: {:.5g} to {:.5g}", p.low95, p.high95)
                                                 : "not determined: " + p.undetermined);
    }
  }
  if (findings.law) {
    text += "  an empirical law, no physics:\n";
    for (const std::string& line : law_formulas(findings.search.law)) text += fmt::format("    {}\n", line);
    for (const discrepancy::LawPiece& piece : findings.search.law.pieces) {
      for (const rendering::ParameterDeclaration& p : piece.effect->parameters)
        text += fmt::format("    {:28} {:>12.5g} {}\n", p.name, p.initial, p.unit);
    }
    text += "    seen:";
    for (const discrepancy::SeenRange& range : findings.search.law.seen)
      text += fmt::format(" {} {:.3g} to {:.3g} {};", range.variable, range.low, range.high, range.unit);
    text += fmt::format("\n    the model with it: {}; each piece for --effect: law-1.json and so on\n",
                        (files.out / "empirical.json").string());
  }
  text += fmt::format(
      "held-out RMS force error{}: before {:.4g} N, after {:.4g} N, expected of {} noise {:.4g} N{}\nreport: {}\n",
      findings.gap.means ? fmt::format(" of means over {} samples", findings.gap.means->count) : "",
      findings.gap.holdout_before_N, findings.gap.holdout_after_N,
      findings.instrument_declared ? "the declared" : "the estimated", findings.gap.noise_floor_N,
      findings.gap.repeat_floor_N ? fmt::format(", floor of the repeat {:.4g} N", *findings.gap.repeat_floor_N) : "",
      (files.out / "report.html").string());
  if (!files.golden.empty()) {
    text += "a golden case of it is written; it counts once it is accepted:\n" + golden_commands(files.golden);
  } else if (findings.verdict == discrepancy::FindingsVerdict::explained) {
    text += "to keep the gap closed, make it a golden case: add --golden golden/NAME\n";
  }
  return text;
}

// What the answer needs at the end: it reads all files a second time, in a process of its own, and is judged in as many
// simulated motions as were prepared since, under two or three models.
double checks_after_s(std::chrono::steady_clock::time_point begun) {
  constexpr double answers_over_reading = 1.5;
  return answers_over_reading * std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

}  // namespace

DiscrepancyAnswer run_discrepancy(const Catalogue& catalogue, const DiscrepancyFiles& files,
                                  const std::function<void(const std::string&)>& report) {
  discrepancy::SearchSettings settings;
  settings.time_limit_s = files.time_limit_s;
  const DiscrepancyInputs inputs = load_inputs(catalogue, files);
  ensure_writable_folder(files.out);  // after the input, which may be bad; before the long work
  for (const std::string& remark : inputs.remarks) report(remark);
  const EarlierRun earlier(files.out);
  for (const char* const name : {"model.json", "empirical.json", "law-1.json"})
    refuse_to_replace_input(files.out / name);  // before the long work
  std::optional<recording_checks::RepeatFloor> floor;
  if (!files.repeat.empty()) floor = recording_checks::repeat_floor_of_files(files.recording, files.repeat);
  const Model& model = inputs.model;
  const auto candidates = all_candidates(catalogue, files.effects);
  const surface::TriangleMesh& mesh = inputs.mesh;
  const auto& surface = inputs.surface;
  const Recording& train = inputs.train;
  const auto& second = inputs.holdout;
  const Recording& holdout = second ? *second : train;
  // Refuses a wrong model before the long work begins; alive, its examined mesh serves all that follow.
  const auto alive = catalogue.make(model, surface);
  const MakePredictor make = [&](const MotionColumns& motion) { return catalogue.make_predictor(surface, motion); };
  const double duration_s = train.motion.t_s.back() - train.motion.t_s.front();
  const double held_back_s = second ? 0.0 : std::min(files.block_s, duration_s / held_back_least_blocks);
  const Part learnt_from{{held_back_s, false}, {}};
  InstrumentDescription instrument = instrument_of(files, train, learnt_from, mesh, *surface);
  const InstrumentDescription sensor = instrument;
  const std::size_t count = mean_over(train, instrument);
  const Part held_back{{held_back_s, true}, {}};
  const Recording train_means = thinned(train, count, learnt_from);
  const Recording holdout_means = thinned(holdout, count, held_back);
  if (count > 1) {
    instrument = instrument.declared ? instrument_of_means(instrument, train.motion, count)
                                     : instrument_of(files, train_means, learnt_from, mesh, *surface);
  }
  bound_by_residual(instrument, train_means, learnt_from, model, make, files);
  const auto train_predictor = make(train_means.motion);
  const auto holdout_predictor = make(holdout_means.motion);
  NoiseModel train_noise(train_means.motion, train_predictor->predict(model).n_W, instrument, make, files.seed,
                         files.seed + 2);
  NoiseModel holdout_noise(holdout_means.motion, holdout_predictor->predict(model).n_W, instrument, make,
                           files.seed + 1, files.seed + 2);
  auto data = discrepancy::divide({&train_means, train_predictor.get(), &train_noise, learnt_from},
                                  {&holdout_means, holdout_predictor.get(), &holdout_noise, held_back},
                                  discrepancy::block_window_s(instrument.position_rate_Hz, train_means.motion));
  data.force_floor_N = 6.0 * sensor.force_noise_N + sensor.force_step_N.maxCoeff();
  data.position_noise_m = instrument.position_noise_m;
  data.geometry_error_m = instrument.geometry_error_m;

  Findings findings;
  settings.checks_s = checks_after_s(settings.begun);
  findings.search = search_effects(data, model, candidates, settings, report);
  const auto samples_predictor = count > 1 ? make(holdout.motion) : nullptr;
  Evidence samples = data.holdout;
  if (count > 1) {
    samples.recording = &holdout;
    samples.predictor = samples_predictor.get();
    findings.search.spectrum = spectrum_of_samples({&train, second ? &holdout : nullptr, files.seed, sensor, make},
                                                   findings.search.model, data.window_s);
  }
  const double beyond_means_N2 = count > 1 ? square_beyond_means_N2(sensor, instrument) : 0.0;
  const MeasuredGap measured = measure_gap(findings.search, data, {samples, count, beyond_means_N2});
  findings.gap = measured.gap;
  if (floor) findings.gap.apply_repeat_floor(floor->force_N, floor->within_N);
  findings.gap.tolerance_N = files.tolerance_N;
  findings.gap.unnoticed_passes = files.unnoticed_passes;
  findings.shares = merge_inseparable(share_gap(measured.on, findings.search.start, findings.search.model));
  const Prediction before = measured.on.predictor->predict(model);
  const Prediction after = measured.on.predictor->predict(findings.search.model);
  // Of forces that nobody feels there is none.
  if (const double jnd = left_in_jnd(measured.on, after); std::isfinite(jnd)) findings.gap.left_jnd = jnd;
  findings.where = sort_by_regime(measured.on, before, after, data.force_floor_N);
  findings.next = next_experiment(findings.search, data, make, instrument);
  findings.instrument_declared = instrument.declared;
  findings.suggested_instrument = suggest_instrument(sensor, train.motion);
  findings.blocks_held_back = !second;
  findings.law = measure_law(findings.search, measured.on, findings.gap.noise_floor_N);
  conclude(findings, candidates);

  earlier.remove();
  std::string trajectory;
  if (findings.next && !findings.ambiguous.empty()) {
    trajectory = "next.csv";
    save_trajectory(files.out / trajectory, recording::InTrajectory{findings.next->motion});
  }
  write_file(files.out / "model.json", model_to_json(findings.search.model, files.out) + "\n");
  if (findings.law) write_law(findings, files.out);
  if (findings.suggested_instrument)
    write_file(files.out / discrepancy::suggested_instrument_file, instrument_to_json(*findings.suggested_instrument));
  findings.gap.holdout_after_again_N =
      run_again(catalogue, files, samples, findings.search.model, instrument.force_noise_N);
  const std::string json = findings_to_json(findings, trajectory);
  write_file(files.out / "findings.json", json);
  write_html(files.out / "report.html", discrepancy_page(findings, candidates, measured.on, before, after, mesh,
                                                         provenance_of(files, instrument.declared)));
  if (!files.golden.empty()) write_golden_case(files.golden, mesh, holdout, findings.search.model);
  DiscrepancyAnswer answer{findings.verdict, {}, findings_text(findings, files)};
  for (const discrepancy::FoundEffect& effect : findings.search.found) answer.effects.push_back(effect.name);
  return answer;
}

}  // namespace touchstone::pipeline
