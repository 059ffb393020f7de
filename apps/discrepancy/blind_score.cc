#include "apps/discrepancy/blind_score.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/discrepancy/workflow.h"
#include "harness/base/error.h"
#include "harness/base/json_reader.h"
#include "harness/discrepancy/candidate_starts.h"
#include "harness/discrepancy/instrument_description.h"
#include "harness/discrepancy/joint_fit.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/model.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_file.h"
#include "renderers/model_predictor.h"

namespace touchstone::apps {
namespace {

using nlohmann::json;

double rms_N(const Recording& recording, const Prediction& prediction) {
  double sum = 0.0;
  for (std::size_t i = 0; i < recording.size(); ++i) sum += (recording.f_W_N[i] - prediction.f_W_N[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, recording.size())));
}

std::vector<std::string> names_of(const json& effects) {
  std::vector<std::string> names;
  names.reserve(effects.size());
  for (const auto& effect : effects) names.push_back(effect.at("name").get<std::string>());
  return names;
}

// The true structure, its parameters fitted once more to the training recording: what the best of searches could leave.
// True parameters alone may leave more, since positions are noisy and the mesh has an error.
double refitted_floor_N(const BlindScore& score, const Model& truth, const Recording& train,
                        const std::shared_ptr<const Surface>& surface, Predictor& holdout_predictor,
                        const Recording& holdout, const InstrumentDescription& instrument) {
  const auto predictor = make_model_predictor(surface, train.motion);
  const Prediction nominal = predictor->predict(truth);
  const double stiffness = truth.parameters.at("stiffness_N_per_m");
  const double floor_N = 6.0 * instrument.force_noise_N + instrument.force_step_N.maxCoeff();
  const RecordingScales scales = measure_scales(train, nominal, floor_N, stiffness, instrument.position_noise_m);
  std::vector<FreeParameter> parameters{log_base_parameter("stiffness_N_per_m", 0.1 * stiffness, 10.0 * stiffness)};
  for (const Candidate& candidate : all_candidates()) {
    if (find_entry(truth, candidate.name) == nullptr) continue;
    const auto free = candidate_fit(candidate, scales, train, nominal).parameters;
    parameters.insert(parameters.end(), free.begin(), free.end());
  }
  constexpr double window_s = 1.0 / 30.0;
  FitData data;
  data.predictor = predictor.get();
  data.blocks = make_blocks(train.motion, window_s);
  data.measured_N = block_means(data.blocks, train.f_W_N);
  // All blocks weigh the same, as in the RMS that the gap is measured by.
  data.noise.assign(data.blocks.size(), {Vec3::Zero(), score.floor_N, score.floor_N, Vec3::Zero()});
  constexpr int iterations = 15;
  const JointFit fit = fit_jointly(data, truth, parameters, iterations, false);
  return fit.ok ? rms_N(holdout, holdout_predictor.predict(fit.model)) : score.floor_N;
}

// The floor of the true structure, and the error of the true stiffness alone.
void measure_floor(BlindScore& score, const json& answer, const std::filesystem::path& folder) {
  const Recording holdout = load_recording(folder / "holdout.csv");
  const std::shared_ptr<const Surface> surface = make_embree_surface(load_mesh(folder / "mesh.obj", 1.0));
  const auto predictor = make_model_predictor(surface, holdout.motion);
  Model model = load_model(folder / "model.json");
  model.parameters["stiffness_N_per_m"] = answer.at("true_stiffness_N_per_m").get<double>();
  score.before_N = rms_N(holdout, predictor->predict(model));
  score.floor_N = std::numeric_limits<double>::quiet_NaN();
  for (const auto& effect : answer.at("effects")) {
    const auto side = effect.at("side").get<std::string>();
    if (side == "unknown") return;
    NamedParameters entry{effect.at("name").get<std::string>(), effect.at("parameters"), "/answer"};
    // Dahl's bristle turns exponentially, the renderers' linearly: the same initial slope.
    if (entry.name.ends_with("friction") && entry.name != "viscous-friction" && answer.contains("presliding_m")) {
      entry.parameters["presliding_m"] = answer.at("presliding_m").get<double>();
    }
    (side == "contact" ? model.effects : model.instrument).push_back(std::move(entry));
  }
  score.floor_N = rms_N(holdout, predictor->predict(model));
  if (answer.at("effects").empty()) return;
  const Recording train = load_recording(folder / "train.csv");
  score.floor_N = std::min(score.floor_N, refitted_floor_N(score, model, train, surface, *predictor, holdout,
                                                           load_instrument(folder / "instrument.json")));
}

bool as_sets_ask(const BlindScore& score, const json& findings) {
  const std::set<std::string> named(score.named.begin(), score.named.end());
  const std::set<std::string> expected(score.expected.begin(), score.expected.end());
  if (score.set == "corrupted") return named.empty() && score.data_blamed;
  if (score.expected_verdict == "consistent") return named.empty() && score.verdict == "consistent";
  if (score.expected_verdict == "unexplained") return score.verdict == "unexplained";
  if (score.expected_verdict == "not-identifiable") {
    if (score.verdict != "not-identifiable") return false;
    for (const auto& group : findings.at("ambiguous")) {
      const std::set<std::string> alike(group.begin(), group.end());
      if (std::includes(alike.begin(), alike.end(), expected.begin(), expected.end())) return true;
    }
    return false;
  }
  if (expected.size() == 1) return !score.named.empty() && score.named.front() == *expected.begin();
  return std::includes(named.begin(), named.end(), expected.begin(), expected.end());
}

void compare_parameters(BlindScore& score, const json& answer, const json& findings) {
  for (const auto& truth : answer.at("effects")) {
    for (const auto& found : findings.at("effects")) {
      if (found.at("name") != truth.at("name")) continue;
      for (const auto& parameter : found.at("parameters")) {
        const auto name = parameter.at("name").get<std::string>();
        // A reference depth is chosen, not measured; angles have a period.
        if (!truth.at("parameters").contains(name) || name == "reference_depth_m" || name.ends_with("direction_rad") ||
            name == "phase_rad" || parameter.at("value").is_null()) {
          continue;
        }
        const double value = truth.at("parameters").at(name).get<double>();
        const auto& interval = parameter.at("interval95");
        score.parameters.push_back({truth.at("name").get<std::string>(), name, value,
                                    parameter.at("value").get<double>(),
                                    interval[0].get<double>() <= value && value <= interval[1].get<double>()});
      }
    }
  }
}

struct Share {
  std::size_t right = 0;
  std::size_t all = 0;
};

std::string with_interval(const Share& share) {
  if (share.all == 0) return "-";
  const double n = static_cast<double>(share.all);
  const double p = static_cast<double>(share.right) / n;
  constexpr double z = 1.96;
  const double centre = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double half = z / (1.0 + z * z / n) * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  return fmt::format("{:3.0f} % ({} of {}; 95 %: {:.0f} to {:.0f} %)", 100.0 * p, share.right, share.all,
                     100.0 * std::max(0.0, centre - half), 100.0 * std::min(1.0, centre + half));
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

struct Bar {
  std::string set;
  std::string what;
  double least;  // share right
};

const std::vector<Bar> bars{
    {"one", "one effect, low and middle noise: first choice right", 0.95},
    {"one-noisy", "one effect, high noise: first choice right", 0.85},
    {"two", "two at once: both named", 0.90},
    {"three", "three at once: of the hidden effects, named", 0.80},
    {"none", "nothing missing: nothing named", 0.98},
    {"unknown", "unknown effects: flagged", 0.90},
    {"cannot-tell", "cannot tell: said so, with the right pair", 0.90},
    {"corrupted", "corrupted: nothing named, the data blamed", 1.0},
    {"sample", "samples: right", 1.0},
};

// How often a single effect is found, by the RMS force that it makes over the noise floor.
std::string detection_curve(const std::vector<BlindScore>& scores) {
  constexpr std::array edges{0.0, 0.25, 0.5, 1.0, 2.0, 5.0, std::numeric_limits<double>::infinity()};
  std::string text = "\nfound first, by the effect's RMS force over the noise floor (single effects):\n";
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    Share share;
    for (const BlindScore& score : scores) {
      const double square = score.before_N * score.before_N - score.floor_N * score.floor_N;
      const double strength = std::sqrt(std::max(0.0, square)) / score.floor_N;
      if (score.expected.size() != 1 || !(strength >= edges[i] && strength < edges[i + 1])) continue;
      ++share.all;
      share.right += !score.named.empty() && score.named.front() == score.expected.front() ? 1 : 0;
    }
    if (share.all == 0) continue;
    text += fmt::format("  {:4} to {:4}  {}\n", edges[i], edges[i + 1], with_interval(share));
  }
  return text;
}

}  // namespace

std::vector<BlindScore> score_blind(const std::filesystem::path& answers, const std::filesystem::path& cases,
                                    const std::filesystem::path& results, const std::filesystem::path& again) {
  const json root = load_json(answers);
  if (!root.contains("cases") || !root.at("cases").is_array()) {
    throw BadData(fmt::format("{}: /cases: a list of cases was expected", answers.string()));
  }
  std::vector<BlindScore> scores;
  for (const json& answer : root.at("cases")) {
    BlindScore score;
    try {
      score.id = answer.at("id").get<std::string>();
      score.set = answer.value("set", "sample");
      score.expected_verdict = answer.at("expected_verdict").get<std::string>();
      const auto file = results / score.id / "findings.json";
      if (!std::filesystem::exists(file)) continue;
      const json findings = load_json(file);
      score.verdict = findings.at("verdict").get<std::string>();
      score.expected = names_of(answer.at("effects"));
      if (answer.contains("ambiguous")) score.expected = answer.at("ambiguous").at(0);
      score.named = names_of(findings.at("effects"));
      score.data_blamed = findings.contains("data_fault");
      score.after_N = findings.at("gap").at("holdout").at("after").get<double>();
      measure_floor(score, answer, cases / score.id);
      score.right = as_sets_ask(score, findings);
      compare_parameters(score, answer, findings);
      const auto second = again / score.id / "findings.json";
      if (score.set == "cannot-tell" && !again.empty() && std::filesystem::exists(second)) {
        const json told = load_json(second);
        const auto named = names_of(told.at("effects"));
        score.told_apart = told.at("verdict") == "explained" && !named.empty() &&
                           named.front() == names_of(answer.at("effects")).front();
      }
    } catch (const nlohmann::json::exception& error) {
      throw BadData(fmt::format("{} or findings of case {}: {}", answers.string(), score.id, error.what()));
    }
    const double gap = score.before_N * score.before_N - score.floor_N * score.floor_N;
    score.weak = score.set != "sample" && !score.expected.empty() && gap < 0.25 * score.floor_N * score.floor_N;
    score.closed = (score.before_N * score.before_N - score.after_N * score.after_N) / gap;
    scores.push_back(std::move(score));
  }
  if (scores.empty()) {
    throw BadData(fmt::format("{}: no findings.json of any case of {}; run: touchstone blind run", results.string(),
                              answers.string()));
  }
  return scores;
}

BlindTable blind_table(const std::vector<BlindScore>& scores) {
  std::string text;
  bool all_met = true;
  // A figure that could not be had (no case of the kind) has no bar.
  const auto judged = [&](double value, bool met) {
    if (std::isnan(value)) return "";
    all_met = all_met && met;
    return met ? "met" : "NOT MET";
  };
  for (const Bar& bar : bars) {
    Share share;
    for (const BlindScore& score : scores) {
      if (score.set != bar.set || score.weak) continue;
      if (score.set == "three") {
        for (const std::string& name : score.expected) {
          ++share.all;
          share.right += std::find(score.named.begin(), score.named.end(), name) != score.named.end() ? 1 : 0;
        }
        continue;
      }
      ++share.all;
      share.right += score.right ? 1 : 0;
    }
    if (share.all == 0) continue;
    const double p = static_cast<double>(share.right) / static_cast<double>(share.all);
    text += fmt::format("{:56} bar {:3.0f} %  {}  {}\n", bar.what, 100.0 * bar.least, with_interval(share),
                        judged(p, p >= bar.least));
  }
  Share told;
  for (const BlindScore& score : scores) {
    if (!score.told_apart) continue;
    ++told.all;
    told.right += *score.told_apart ? 1 : 0;
  }
  if (told.all > 0) {
    const double p = static_cast<double>(told.right) / static_cast<double>(told.all);
    text += fmt::format("{:56} bar {:3.0f} %  {}  {}\n", "cannot tell: right once the motion asked for is recorded",
                        90.0, with_interval(told), judged(p, p >= 0.90));
  }
  Share false_flags;
  Share extra;
  std::vector<double> closed;
  std::map<std::string, Share> by_effect;
  std::map<std::string, std::vector<double>> errors;
  Share inside;
  std::size_t weak = 0;
  std::size_t weak_named = 0;
  for (const BlindScore& score : scores) {
    if (score.weak) {
      ++weak;
      weak_named += score.right ? 1 : 0;
      continue;
    }
    const bool known = score.expected_verdict == "explained";
    if (known || score.expected_verdict == "consistent") {
      ++false_flags.all;
      false_flags.right += score.verdict == "unexplained" ? 1 : 0;
    }
    if (!known) continue;
    ++extra.all;
    const bool more = std::any_of(score.named.begin(), score.named.end(), [&](const std::string& name) {
      return std::find(score.expected.begin(), score.expected.end(), name) == score.expected.end();
    });
    extra.right += more ? 1 : 0;
    closed.push_back(score.closed);
    for (const std::string& name : score.expected) {
      Share& share = by_effect[name];
      ++share.all;
      share.right += std::find(score.named.begin(), score.named.end(), name) != score.named.end() ? 1 : 0;
    }
    for (const auto& parameter : score.parameters) {
      ++inside.all;
      inside.right += parameter.inside ? 1 : 0;
      if (parameter.truth != 0.0) {
        errors[parameter.effect + " " + parameter.name].push_back(std::abs(parameter.value / parameter.truth - 1.0));
      }
    }
  }
  const auto part = [](const Share& share) {
    return static_cast<double>(share.right) / static_cast<double>(share.all);
  };
  text += fmt::format("{:56} bar at most 5 %  {}  {}\n", "flagged as unknown though nothing unknown was there",
                      with_interval(false_flags), judged(part(false_flags), part(false_flags) <= 0.05));
  text += fmt::format("{:56} bar at most 10 %  {}  {}\n", "effects named that are not there", with_interval(extra),
                      judged(part(extra), part(extra) <= 0.10));
  const double median = quantile(closed, 0.5);
  const double tenth = quantile(closed, 0.1);
  const double least = quantile(closed, 0.0);
  text += fmt::format(
      "gap closed, held out: median {:.3f} (bar 0.97) {}, 10th percentile {:.3f} (bar 0.90) {}, least {:.3f} "
      "(bar -0.02) {}\n",
      median, judged(median, median >= 0.97), tenth, judged(tenth, tenth >= 0.90), least,
      judged(least, least >= -0.02));
  text += fmt::format("parameters inside their 95 % interval: bar 88 %  {}  {}\n", with_interval(inside),
                      judged(part(inside), part(inside) >= 0.88));
  text += fmt::format("weaker than half of the noise floor: {} cases, {} of them found\n", weak, weak_named);
  text += detection_curve(scores);
  text += "\nfound, where it was hidden (among others or alone), and median error of its parameters:\n";
  for (const auto& [name, share] : by_effect) {
    text += fmt::format("  {:24} {} of {} ", name, share.right, share.all);
    for (const auto& [parameter, values] : errors) {
      if (!parameter.starts_with(name + " ")) continue;
      text += fmt::format("  {} {:.1f} %", parameter.substr(name.size() + 1), 100.0 * quantile(values, 0.5));
    }
    text += "\n";
  }
  text += "\nnot right:\n";
  for (const BlindScore& score : scores) {
    if (score.right) continue;
    text += fmt::format("  {} {:12} {}: expected {} {}, found {} {} (held out {:.4g} N, floor {:.4g} N){}\n", score.id,
                        score.set, score.weak ? "weak " : "", score.expected_verdict,
                        fmt::join(score.expected, " and "), score.verdict, fmt::join(score.named, " and "),
                        score.after_N, score.floor_N, score.data_blamed ? ", data blamed" : "");
  }
  return {text, all_met};
}

std::string blind_json(const std::vector<BlindScore>& scores) {
  nlohmann::ordered_json root{{"schema", "touchstone-blind-score/1"}, {"cases", nlohmann::ordered_json::array()}};
  const auto number = [](double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
  };
  for (const BlindScore& score : scores) {
    nlohmann::ordered_json entry{{"id", score.id},
                                 {"set", score.set},
                                 {"expected_verdict", score.expected_verdict},
                                 {"verdict", score.verdict},
                                 {"expected", score.expected},
                                 {"named", score.named},
                                 {"right", score.right},
                                 {"weak", score.weak},
                                 {"before_N", number(score.before_N)},
                                 {"floor_N", number(score.floor_N)},
                                 {"after_N", number(score.after_N)},
                                 {"closed", number(score.closed)},
                                 {"parameters", nlohmann::ordered_json::array()}};
    if (score.told_apart) entry["told_apart"] = *score.told_apart;
    for (const auto& p : score.parameters) {
      entry["parameters"].push_back(
          {{"effect", p.effect}, {"name", p.name}, {"truth", p.truth}, {"value", p.value}, {"inside", p.inside}});
    }
    root["cases"].push_back(std::move(entry));
  }
  return root.dump(1) + "\n";
}

}  // namespace touchstone::apps
