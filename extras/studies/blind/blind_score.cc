#include "blind/blind_score.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "harness/base/error.h"
#include "harness/base/json_reader.h"
#include "harness/discrepancy/candidate_starts.h"
#include "harness/discrepancy/findings_verdict.h"
#include "harness/discrepancy/instrument_description.h"
#include "harness/discrepancy/joint_fit.h"
#include "harness/pipeline/discrepancy/inputs.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/model.h"
#include "harness/rendering/predictor.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_file.h"
#include "renderers/catalogue.h"
#include "renderers/model_predictor.h"

namespace touchstone::blind {
using discrepancy::FindingsVerdict;
using recording::Recording;

namespace {

using nlohmann::json;

double rms_N(const Recording& recording, const rendering::Prediction& prediction) {
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
double refitted_floor_N(const BlindScore& score, rendering::Model truth, const Recording& train,
                        const std::shared_ptr<const surface::Surface>& surface, rendering::Predictor& holdout_predictor,
                        const Recording& holdout, const discrepancy::InstrumentDescription& instrument) {
  const auto predictor = renderers::make_model_predictor(surface, train.motion);
  const rendering::Prediction nominal = predictor->predict(truth);
  const double stiffness = truth.parameters.at("stiffness_N_per_m");
  const double floor_N = 6.0 * instrument.force_noise_N + instrument.force_step_N.maxCoeff();
  const rendering::RecordingScales scales =
      discrepancy::measure_scales(train, nominal, floor_N, stiffness, instrument.position_noise_m);
  std::vector<discrepancy::FreeParameter> parameters{
      discrepancy::log_base_parameter("stiffness_N_per_m", 0.1 * stiffness, 10.0 * stiffness)};
  for (const rendering::Candidate& candidate : pipeline::all_candidates(renderers::built_in_catalogue())) {
    rendering::NamedParameters* const entry = discrepancy::find_entry(truth, candidate.name);
    if (entry == nullptr) continue;
    for (const auto& declared : candidate.parameters) entry->parameters.try_emplace(declared.name, declared.initial);
    const auto free = discrepancy::candidate_fit(candidate, scales, train, nominal).parameters;
    parameters.insert(parameters.end(), free.begin(), free.end());
  }
  constexpr double window_s = 1.0 / 30.0;
  discrepancy::FitData data;
  data.predictor = predictor.get();
  data.blocks = discrepancy::make_blocks(train.motion, window_s);
  data.measured_N = block_means(data.blocks, train.f_W_N);
  // All blocks weigh the same, as in the RMS that the gap is measured by.
  data.noise.assign(data.blocks.size(), {Vec3::Zero(), score.floor_N, score.floor_N, Vec3::Zero()});
  constexpr int iterations = 15;
  const discrepancy::JointFit fit = fit_jointly(data, truth, parameters, iterations, false);
  return fit.ok ? rms_N(holdout, holdout_predictor.predict(fit.model)) : score.floor_N;
}

// The floor of the true structure, and the error of the true stiffness alone.
void measure_floor(BlindScore& score, const json& answer, const std::filesystem::path& folder) {
  const Recording holdout = recording::load_recording(folder / "holdout.csv");
  const std::shared_ptr<const surface::Surface> surface =
      make_embree_surface(surface::load_mesh(folder / "mesh.obj", 1.0));
  const auto predictor = renderers::make_model_predictor(surface, holdout.motion);
  rendering::Model model = rendering::load_model(folder / "model.json");
  model.parameters["stiffness_N_per_m"] = answer.at("true_stiffness_N_per_m").get<double>();
  score.before_N = rms_N(holdout, predictor->predict(model));
  score.floor_N = std::numeric_limits<double>::quiet_NaN();
  for (const auto& effect : answer.at("effects")) {
    const auto side = effect.at("side").get<std::string>();
    if (side == "unknown") return;
    rendering::NamedParameters entry{effect.at("name").get<std::string>(), effect.at("parameters"), "/answer"};
    // Dahl's bristle turns exponentially, the renderers' linearly: the same initial slope.
    if (entry.name.ends_with("friction") && entry.name != "viscous-friction" && answer.contains("presliding_m")) {
      entry.parameters["presliding_m"] = answer.at("presliding_m").get<double>();
    }
    (side == "contact" ? model.effects : model.instrument).push_back(std::move(entry));
  }
  score.floor_N = rms_N(holdout, predictor->predict(model));
  if (answer.at("effects").empty()) return;
  const Recording train = recording::load_recording(folder / "train.csv");
  score.floor_N = std::min(score.floor_N, refitted_floor_N(score, model, train, surface, *predictor, holdout,
                                                           discrepancy::load_instrument(folder / "instrument.json")));
}

// Whether the strongest peak of the residual lies where the hidden one does.
bool names_frequency(const json& answer, const json& findings) {
  constexpr double tolerance = 0.01;
  const auto& peaks = findings.at("spectrum").at("peaks");
  if (peaks.empty()) return false;
  const double true_Hz = answer.at("effects").at(0).at("parameters").at("frequency_Hz").get<double>();
  return std::abs(peaks[0].at("frequency_Hz").get<double>() - true_Hz) <= tolerance * true_Hz;
}

bool as_sets_ask(const BlindScore& score, const json& answer, const json& findings) {
  const std::set<std::string> named(score.named.begin(), score.named.end());
  const std::set<std::string> expected(score.expected.begin(), score.expected.end());
  if (score.set == "corrupted") return named.empty() && score.data_blamed;
  if (score.expected_verdict == FindingsVerdict::consistent)
    return named.empty() && score.verdict == FindingsVerdict::consistent;
  if (score.set == "full-band")
    return score.verdict == FindingsVerdict::unexplained && names_frequency(answer, findings);
  if (score.expected_verdict == FindingsVerdict::unexplained) return score.verdict == FindingsVerdict::unexplained;
  if (score.expected_verdict == FindingsVerdict::not_identifiable) {
    if (score.verdict != FindingsVerdict::not_identifiable) return false;
    for (const auto& group : findings.at("ambiguous")) {
      const std::set<std::string> alike(group.begin(), group.end());
      if (std::includes(alike.begin(), alike.end(), expected.begin(), expected.end())) return true;
    }
    return false;
  }
  if (expected.size() == 1) return !score.named.empty() && score.named.front() == *expected.begin();
  return std::includes(named.begin(), named.end(), expected.begin(), expected.end());
}

void judge_law(BlindScore& score, const json& answer, const json& findings) {
  if (!answer.contains("follows") || !findings.contains("empirical_law")) return;
  const json& law = findings.at("empirical_law");
  score.law_closed = law.at("holdout").at("closed").get<double>();
  for (const auto& piece : law.at("pieces"))
    score.law += (score.law.empty() ? "" : " and ") + piece.at("name").get<std::string>();
  for (const auto& follows : law.at("follows")) {
    const json& right = answer.at("follows");
    score.law_follows = score.law_follows || std::find(right.begin(), right.end(), follows) != right.end();
  }
}

void compare_parameters(BlindScore& score, const json& answer, const json& findings) {
  for (const auto& truth : answer.at("effects")) {
    for (const auto& found : findings.at("effects")) {
      if (found.at("name") != truth.at("name")) continue;
      for (const auto& parameter : found.at("parameters")) {
        const auto name = parameter.at("name").get<std::string>();
        // A reference depth or force is chosen, not measured, and what holds there goes with it; angles have a period.
        if (!truth.at("parameters").contains(name) || name.starts_with("reference_") || name.ends_with("_reference") ||
            name.ends_with("direction_rad") || name == "phase_rad" || parameter.at("value").is_null() ||
            parameter.contains("undetermined")) {
          continue;
        }
        const double value = truth.at("parameters").at(name).get<double>();
        const auto& interval = parameter.at("interval95");
        score.parameters.push_back({truth.at("name").get<std::string>(), name, value,
                                    parameter.at("value").get<double>(),
                                    interval.at(0).get<double>() <= value && value <= interval.at(1).get<double>()});
      }
    }
  }
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
      score.expected_verdict = discrepancy::findings_verdict(answer.at("expected_verdict").get<std::string>());
      const auto file = results / score.id / "findings.json";
      if (!std::filesystem::exists(file)) continue;
      const json findings = load_json(file);
      score.verdict = discrepancy::findings_verdict(findings.at("verdict").get<std::string>());
      score.expected = names_of(answer.at("effects"));
      if (answer.contains("ambiguous")) score.expected = answer.at("ambiguous").at(0);
      score.named = names_of(findings.at("effects"));
      score.data_blamed = findings.contains("data_fault");
      score.after_N = findings.at("gap").at("holdout").at("after").get<double>();
      measure_floor(score, answer, cases / score.id);
      score.right = as_sets_ask(score, answer, findings);
      compare_parameters(score, answer, findings);
      judge_law(score, answer, findings);
      const auto second = again / score.id / "findings.json";
      if (score.set == "cannot-tell" && !again.empty() && std::filesystem::exists(second)) {
        const json told = load_json(second);
        const auto named = names_of(told.at("effects"));
        score.told_apart =
            discrepancy::findings_verdict(told.at("verdict").get<std::string>()) == FindingsVerdict::explained &&
            !named.empty() && named.front() == names_of(answer.at("effects")).front();
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

std::string blind_json(const std::vector<BlindScore>& scores) {
  nlohmann::ordered_json root{{"schema", "touchstone-blind-score/1"}, {"cases", nlohmann::ordered_json::array()}};
  const auto number = [](double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
  };
  for (const BlindScore& score : scores) {
    nlohmann::ordered_json entry{{"id", score.id},
                                 {"set", score.set},
                                 {"expected_verdict", to_string(score.expected_verdict)},
                                 {"verdict", to_string(score.verdict)},
                                 {"expected", score.expected},
                                 {"named", score.named},
                                 {"right", score.right},
                                 {"weak", score.weak},
                                 {"before_N", number(score.before_N)},
                                 {"floor_N", number(score.floor_N)},
                                 {"after_N", number(score.after_N)},
                                 {"closed", number(score.closed)},
                                 {"parameters", nlohmann::ordered_json::array()}};
    if (score.set == "outside")
      entry["law"] = {{"name", score.law}, {"closed", number(score.law_closed)}, {"follows", score.law_follows}};
    if (score.told_apart) entry["told_apart"] = *score.told_apart;
    for (const auto& p : score.parameters) {
      entry["parameters"].push_back(
          {{"effect", p.effect}, {"name", p.name}, {"truth", p.truth}, {"value", p.value}, {"inside", p.inside}});
    }
    root["cases"].push_back(std::move(entry));
  }
  return root.dump(1) + "\n";
}

}  // namespace touchstone::blind
