#include "harness/discrepancy/law_search.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "harness/base/in_parallel.h"
#include "harness/discrepancy/goodness.h"
#include "harness/discrepancy/law_regression.h"
#include "harness/discrepancy/law_waves.h"
#include "harness/discrepancy/misfit.h"
#include "harness/discrepancy/model_edit.h"
#include "harness/discrepancy/structure_detector.h"

namespace touchstone::discrepancy {
using rendering::DeclaredEffect;
using rendering::Model;
using rendering::NamedParameters;
using rendering::Prediction;

namespace {

constexpr std::size_t most_pieces = 3;
constexpr std::size_t most_refined = 5;
// Of the best one's gain in deviance by which a term with fewer parameters may fall behind.
constexpr double indistinguishable = 0.05;

constexpr const char* law_search_step = "a law for the residual";

using Report = std::function<void(const std::string&)>;

// How the parameters of a term enter a fit from an entry: sizes in steps of what they are.
std::vector<FreeParameter> free_of(const LawTerm& term, const NamedParameters& entry) {
  std::vector<FreeParameter> free;
  for (const rendering::ParameterDeclaration& parameter : term.effect.parameters) {
    if (parameter.minimum > 0.0) {
      free.push_back(log_parameter(entry.name, parameter.name, parameter.minimum, parameter.maximum));
      continue;
    }
    double scale = 0.1 * std::abs(parameter.initial);
    if (std::ranges::find(term.linear, parameter.name) == term.linear.end()) {
      // Of a plane or a wave: its parts go together.
      double square = 0.0;
      for (const auto& [name, value] : entry.parameters) {
        const auto& other = declaration(term.effect, name);
        if (other.unit == parameter.unit && std::ranges::find(term.linear, name) == term.linear.end())
          square += value * value;
      }
      scale = square > 0.0 ? 0.1 * std::sqrt(square) : 1e-3 * parameter.maximum;
    }
    free.push_back(linear_parameter(entry.name, parameter.name, scale, parameter.minimum, parameter.maximum));
  }
  return free;
}

struct Refined {
  const LawTerm* term = nullptr;
  std::shared_ptr<const DeclaredEffect> law;
  double gain = 0.0;
  SearchState state;
  double deviance = 0.0;
  double rms_N = 0.0;
};

class LawSearch {
 public:
  LawSearch(const SearchState& state, const Report& report) : state_(state), report_(report) {
    const Prediction now = state.data->learning.predictor->predict(state.current.model);
    scales_ = measure_view_scales(state.data->learning.recording->motion, now);
  }

  // Whether a piece was added.
  bool add() {
    const std::vector<LawTerm> terms = law_terms(scales_, peaks());
    std::vector<LawStart> starts;
    std::vector<std::shared_ptr<const DeclaredEffect>> laws;
    for (const LawTerm& term : terms) {
      laws.push_back(std::make_shared<const DeclaredEffect>(term.effect));
      if (find_entry(state_.current.model, term.effect.name) != nullptr) continue;
      for (const auto& constants : term.constants) starts.push_back(law_start(term, laws.back(), constants));
    }
    std::vector<RegressedLaw> all = regress_laws(state_, starts);
    const double bar = law_bar(all, *state_.settings);
    std::sort(all.begin(), all.end(), [](const RegressedLaw& a, const RegressedLaw& b) { return a.gain > b.gain; });
    std::vector<const RegressedLaw*> best_of_terms;
    for (const RegressedLaw& one : all) {
      if (!(one.gain > bar) || best_of_terms.size() >= most_refined) break;
      const LawStart& start = starts[one.start];
      const bool known = std::ranges::any_of(
          best_of_terms, [&](const RegressedLaw* other) { return starts[other->start].term == start.term; });
      if (!known && state_.budget->allows(start.entry.name)) best_of_terms.push_back(&one);
    }
    std::vector<Refined> refined = begin(starts, best_of_terms);
    finish(refined);
    const Refined* const best = preferred(refined);
    if (best == nullptr) return false;
    pieces_.push_back({best->law, side_of(*best->term), best->term->carriers, best->gain, bar});
    report_(fmt::format("  a law: {}, validation RMS {:.4g} N", best->term->effect.summary, best->rms_N));
    state_ = best->state;
    return true;
  }

  // Effects of the library that the law makes needless.
  void drop_needless() {
    std::vector<std::string> names;
    for (const auto* entries : {&state_.current.model.effects, &state_.current.model.instrument}) {
      for (const NamedParameters& entry : *entries) {
        if (entry.law == nullptr || !entry.law->empirical) names.push_back(entry.name);
      }
    }
    for (const std::string& name : names) {
      if (find_entry(state_.start, name) != nullptr) continue;
      SearchState without = state_;
      without.parameters = without_owner(state_.parameters, name);
      without.current.model = without_entry(state_.current.model, name);
      without.renew_noise(without.current.model);
      without.refit();
      const double here = state_.validation_deviance(state_.current.model);
      if (!(without.validation_deviance(without.current.model) - here < state_.settings->minimum_gain)) continue;
      state_ = without;
    }
  }

  [[nodiscard]] bool missing() const {
    const Goodness goodness =
        judge_goodness(state_.data->train, state_.data->validation, state_.current.model, state_.data->window_s);
    return goodness.chi_squared >= goodness.threshold;
  }

  [[nodiscard]] double validation_deviance() const { return state_.validation_deviance(state_.current.model); }
  [[nodiscard]] const SearchState& state() const { return state_; }
  [[nodiscard]] const std::vector<LawPiece>& pieces() const { return pieces_; }

 private:
  [[nodiscard]] WavePeaks peaks() const {
    const FitData& blocks = state_.train;
    const recording::Recording& recording = *state_.data->train.recording;
    const Prediction now = blocks.predictor->predict(state_.current.model);
    const auto means = block_means(blocks.blocks, now.f_W_N);
    const auto places = block_means(blocks.blocks, recording.motion.p_W_m);
    LeftOver left;
    for (std::size_t b = 0; b < blocks.blocks.size(); ++b) {
      const ResidualBlock& block = blocks.blocks[b];
      left.t_s.push_back(0.5 * (recording.motion.t_s[block.begin] + recording.motion.t_s[block.end - 1]));
      left.p_W_m.push_back(places[b]);
      left.f_W_N.push_back(blocks.measured_N[b] - means[b]);
    }
    return wave_peaks(left);
  }

  [[nodiscard]] std::vector<Refined> begin(const std::vector<LawStart>& starts,
                                           const std::vector<const RegressedLaw*>& regressed) const {
    std::vector<std::optional<Refined>> tried(regressed.size());
    const auto one = [&](std::size_t i) { tried[i] = begin(starts[regressed[i]->start], *regressed[i]); };
    in_parallel(tried.size(), one, 1);
    return those_that_are(tried);
  }

  [[nodiscard]] static std::vector<Refined> those_that_are(std::vector<std::optional<Refined>>& tried) {
    std::vector<Refined> usable;
    for (auto& one : tried) {
      if (one) usable.push_back(std::move(*one));
    }
    return usable;
  }

  [[nodiscard]] std::optional<Refined> begin(const LawStart& start, const RegressedLaw& regressed) const {
    NamedParameters entry = start.entry;
    for (std::size_t i = 0; i < regressed.sizes.size(); ++i) {
      const std::string& name = start.term->linear[i];
      const rendering::ParameterDeclaration& bounds = declaration(start.term->effect, name);
      entry.parameters[name] = std::clamp(regressed.sizes[i], 0.99 * bounds.minimum, 0.99 * bounds.maximum);
    }
    Refined refined{start.term, start.entry.law, regressed.gain, state_};
    SearchState& next = refined.state;
    next.parameters = joined(state_.parameters, free_of(*start.term, entry));
    next.current.model = with_entry(state_.current.model, side_of(*start.term), entry);
    next.renew_noise(next.current.model);
    if (!refit(refined)) return std::nullopt;
    return refined;
  }

  static bool refit(Refined& refined) {
    SearchState& next = refined.state;
    JointFit fit =
        fit_jointly(next.train, Model(next.current.model), next.compared(), next.settings->iterations, false);
    if (!fit.ok) return false;
    next.current = std::move(fit);
    next.renew_noise(next.current.model);
    refined.rms_N = next.validation_rms_N(next.current.model);
    return true;
  }

  // -2 ln likelihood on the validation blocks of each, and of the model without any of them, which is returned: all
  // under the largest noise that any of them makes of a block, and what each leaves. What is declared of a mesh is a
  // bound: that a stiffer model makes more of it is no mark against it.
  double judge(std::vector<Refined>& refined) const {
    FitData train = state_.declared_train;
    FitData validation = state_.declared_validation;
    for (const Refined& one : refined) {
      widen_noise(train, one.state.declared_train);
      widen_noise(validation, one.state.declared_validation);
    }
    const auto deviance_of = [&](const Model& model) {
      FitData judged = validation;
      add_misfit(judged, estimate_misfit(train, model));
      return deviance(judged, model);
    };
    for (Refined& one : refined) one.deviance = deviance_of(one.state.current.model);
    return deviance_of(state_.current.model);
  }

  // Again, weighed by what the law leaves: of those that have come to half of what the best has gained.
  void finish(std::vector<Refined>& refined) const {
    constexpr double half = 0.5;
    const double before = judge(refined);
    double most = 0.0;
    for (const Refined& one : refined) most = std::max(most, before - one.deviance);
    std::erase_if(refined, [&](const Refined& one) { return before - one.deviance < half * most; });
    std::vector<std::optional<Refined>> finished(refined.size());
    const auto again = [&](std::size_t i) {
      if (refit(refined[i])) finished[i] = std::move(refined[i]);
    };
    in_parallel(finished.size(), again, 1);
    refined = those_that_are(finished);
  }

  // The best that matters; one of fewer parameters that does nearly as well is preferred.
  [[nodiscard]] const Refined* preferred(std::vector<Refined>& refined) const {
    const double before = judge(refined);
    const auto square = [](double value) { return value * value; };
    const double here = square(state_.validation_rms_N(state_.current.model));
    const double noise = square(expected_noise_N(state_.data->validation, state_.current.model));
    const Refined* best = nullptr;
    for (const Refined& one : refined) {
      const bool matters = here - square(one.rms_N) > least_law_share * std::max(0.0, here - noise) &&
                           before - one.deviance > state_.settings->minimum_gain;
      report_(fmt::format("    {}: gain {:.0f}, deviance {:.0f} less, validation RMS {:.4g} N{}", one.law->name,
                          one.gain, before - one.deviance, one.rms_N, matters ? "" : ", too little"));
      if (matters && (best == nullptr || one.deviance < best->deviance)) best = &one;
    }
    if (best == nullptr) return nullptr;
    const Refined* simplest = best;
    for (const Refined& one : refined) {
      const bool near = one.deviance - best->deviance < indistinguishable * (before - best->deviance);
      if (near && one.term->effect.parameters.size() < simplest->term->effect.parameters.size()) simplest = &one;
    }
    return simplest;
  }

  SearchState state_;
  const Report& report_;
  ViewScales scales_;
  std::vector<LawPiece> pieces_;
};

// On the smoothed trajectory: between neighbouring samples a tracker's noise is faster than a hand.
std::vector<SeenRange> ranges(const Evidence& learning, const Model& model) {
  const MotionColumns& motion = learning.noise->smoothed_motion();
  const Prediction now = learning.noise->likely_predictor().predict(model);
  std::vector<SeenRange> all{{"time", "s"},  {"x", "m"},    {"y", "m"},      {"z", "m"},
                             {"depth", "m"}, {"load", "N"}, {"speed", "m/s"}};
  for (SeenRange& range : all) {
    range.low = std::numeric_limits<double>::infinity();
    range.high = -range.low;
  }
  for (std::size_t i = 0; i < motion.size(); ++i) {
    if (!learning.part.contains(motion.t_s[i], motion.t_s.front())) continue;
    const Vec3 step = i > 0 ? Vec3(motion.p_W_m[i] - motion.p_W_m[i - 1]) : Vec3(Vec3::Zero());
    const double dt_s = i > 0 ? motion.t_s[i] - motion.t_s[i - 1] : 1.0;
    const std::array values{motion.t_s[i],  motion.p_W_m[i].x(), motion.p_W_m[i].y(), motion.p_W_m[i].z(),
                            now.depth_m[i], now.normal_N[i],     step.norm() / dt_s};
    for (std::size_t k = 0; k < all.size(); ++k) {
      all[k].low = std::min(all[k].low, values.at(k));
      all[k].high = std::max(all[k].high, values.at(k));
    }
  }
  return all;
}

}  // namespace

bool calls_for_law(const SearchState& found) {
  if (!found.budget->allows(law_search_step)) return false;
  const SearchData& data = *found.data;
  const Model& model = found.current.model;
  const Goodness goodness = judge_goodness(data.train, data.validation, model, data.window_s);
  if (goodness.chi_squared > goodness.law_threshold) return true;
  if (!(goodness.chi_squared > goodness.structured_threshold)) return false;
  const DetectorSide train{data.train.recording, &goodness.train, data.train.noise};
  const DetectorSide validation{data.validation.recording, &goodness.holdout, data.validation.noise};
  return detect_structure(train, validation, model, {}).found();
}

UnknownLaw search_law(const SearchState& found, const Model& base, const Report& report) {
  if (!found.budget->allows(law_search_step)) return {};
  report(law_search_step);
  std::vector<LawSearch> tried;
  tried.reserve(2);
  tried.emplace_back(found, report);
  const bool anything = found.current.model.effects.size() + found.current.model.instrument.size() >
                        base.effects.size() + base.instrument.size();
  if (anything) {
    SearchState bare = found;
    bare.parameters = {base_stiffness(found.start)};
    bare.current.model = base;
    bare.renew_noise(base);
    bare.refit();
    tried.emplace_back(bare, report);
  }
  const LawSearch* best = nullptr;
  for (LawSearch& one : tried) {
    for (std::size_t piece = 0; piece < most_pieces && (piece == 0 || one.missing()); ++piece) {
      if (!one.add()) break;
    }
    if (one.pieces().empty()) continue;
    one.drop_needless();
    // By the Bayesian information criterion (Schwarz 1978, Ann. Statist. 6:461): validation blocks lie between those
    // that were fitted, so that a field with many coefficients predicts them, and not another path over the object.
    const auto cost = [](const LawSearch& of) {
      const double samples = 3.0 * static_cast<double>(of.state().validation.blocks.size());
      return of.validation_deviance() + std::log(samples) * static_cast<double>(of.state().parameters.size());
    };
    if (best == nullptr || cost(one) < cost(*best)) best = &one;
  }
  UnknownLaw law;
  if (best == nullptr) return law;
  law.pieces = best->pieces();
  law.model = best->state().current.model;
  // The values from all that may be learnt from.
  FitData weights = fit_data(found.data->learning, law.model, found.data->window_s);
  add_misfit(weights, estimate_misfit(weights, law.model));
  const JointFit fit =
      fit_jointly(weights, Model(law.model), best->state().compared(), 2 * found.settings->iterations, false);
  if (fit.ok) law.model = fit.model;
  for (const auto* entries : {&found.current.model.effects, &found.current.model.instrument}) {
    for (const NamedParameters& entry : *entries) {
      if (find_entry(law.model, entry.name) == nullptr) law.needless.push_back(entry.name);
    }
  }
  for (LawPiece& piece : law.pieces) {
    DeclaredEffect effect = *piece.effect;
    NamedParameters& entry = *find_entry(law.model, effect.name);
    for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
      const double value = entry.parameters.at(effect.parameters[i].name);
      effect.parameters[i].initial = value;
      effect.starts[i] = {value};
    }
    piece.effect = std::make_shared<const DeclaredEffect>(std::move(effect));
    entry.law = piece.effect;
  }
  law.seen = ranges(found.data->learning, law.model);
  return law;
}

}  // namespace touchstone::discrepancy
