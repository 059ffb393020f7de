#include "harness/discrepancy/law_search.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "harness/base/error.h"
#include "harness/base/in_parallel.h"
#include "harness/discrepancy/goodness.h"
#include "harness/discrepancy/law_waves.h"
#include "harness/discrepancy/misfit.h"
#include "harness/discrepancy/model_edit.h"
#include "harness/discrepancy/null_gains.h"
#include "harness/discrepancy/whitened_regression.h"

namespace touchstone::discrepancy {
namespace {

constexpr std::size_t most_pieces = 3;
constexpr std::size_t most_refined = 5;
// Of the validation squared error beyond noise that a piece must remove: what leaves more is no law of it.
constexpr double least_share = 0.25;
// Of the best one's gain in deviance by which a term with fewer parameters may fall behind.
constexpr double alike = 0.05;
constexpr double ridge = 1e-8;

using Report = std::function<void(const std::string&)>;

// A term with its constants at one start.
struct Start {
  const LawTerm* term = nullptr;
  NamedParameters entry;  // sizes zero
};

Side side_of(const LawTerm& term) { return term.effect.is_instrument() ? Side::instrument : Side::contact; }

Start start_of(const LawTerm& term, const std::shared_ptr<const DeclaredEffect>& law,
               const std::map<std::string, double>& constants) {
  Start start{&term, {law->name, constants, "/found", {}, law}};
  for (const std::string& name : term.linear) start.entry.parameters[name] = 0.0;
  return start;
}

std::vector<Vec3> difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double over) {
  std::vector<Vec3> out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = (a[i] - b[i]) / over;
  return out;
}

const ParameterDeclaration& declaration(const DeclaredEffect& effect, const std::string& name) {
  return *std::ranges::find(effect.parameters, name, &ParameterDeclaration::name);
}

// Least squares on one side, seen by its squares and products alone.
struct Squares {
  Eigen::MatrixXd responses;  // X' X
  Eigen::MatrixXd products;   // X' r, a column for the recording and one for every null world
  Eigen::VectorXd residual;   // r' r of each

  [[nodiscard]] double left(const Eigen::VectorXd& beta, Eigen::Index world) const {
    return residual[world] - 2.0 * beta.dot(products.col(world)) + beta.dot(responses * beta);
  }
};

Squares squares_of(const Eigen::MatrixXd& responses, const Eigen::MatrixXd& residuals) {
  return {responses.transpose() * responses, responses.transpose() * residuals,
          residuals.colwise().squaredNorm().transpose()};
}

Eigen::VectorXd solve(const Squares& train, Eigen::Index world) {
  const Eigen::VectorXd size = train.responses.diagonal().cwiseSqrt().cwiseMax(1e-300);
  Eigen::MatrixXd normal = size.cwiseInverse().asDiagonal() * train.responses * size.cwiseInverse().asDiagonal();
  normal.diagonal().array() += ridge;
  return size.cwiseInverse().cwiseProduct(
      normal.ldlt().solve(size.cwiseInverse().cwiseProduct(train.products.col(world))));
}

// What a start's regression says of the recording and of the null worlds.
struct Regressed {
  std::size_t start = 0;
  double train_gain = 0.0;
  double gain = 0.0;               // validation
  std::vector<double> null_gains;  // in each world
  std::vector<double> sizes;       // of the linear parameters
};

// One side's blocks, whitened: residuals and how they answer to what is free in the model.
struct SideOf {
  const Evidence* evidence;
  const FitData* blocks;
  Prediction nominal;
  Eigen::MatrixXd residuals;  // the recording's, then each null world's
  Eigen::MatrixXd nuisances;

  [[nodiscard]] Eigen::MatrixXd answer(const std::vector<std::vector<Vec3>>& series) const {
    const std::vector<Vec3> nothing(evidence->recording->size(), Vec3::Zero());
    return whiten_for_regression(*blocks, nothing, series).responses;
  }
};

class Regression {
 public:
  Regression(const SearchState& state) : state_(state) {
    sides_ = {side(state.data->train, state.train), side(state.data->validation, state.validation)};
    for (std::size_t s = 0; s < 2; ++s) {
      plain_[s] = squares_of(sides_[s].nuisances, sides_[s].residuals);
    }
  }

  std::vector<Regressed> all(const std::vector<Start>& starts) const {
    std::vector<std::optional<Regressed>> tried(starts.size());
    const auto try_one = [&](std::size_t i) {
      try {
        tried[i] = one(starts[i], i);
      } catch (const BadData&) {
        // A renderer that cannot run such an effect.
      }
    };
    in_parallel(starts.size(), try_one, 1);
    std::vector<Regressed> usable;
    for (auto& each : tried) {
      if (each) usable.push_back(std::move(*each));
    }
    return usable;
  }

 private:
  [[nodiscard]] SideOf side(const Evidence& evidence, const FitData& blocks) const {
    const Model& model = state_.current.model;
    SideOf of{&evidence, &blocks, evidence.predictor->predict(model), {}, {}};
    const auto whitened = [&](const std::vector<Vec3>& forces) {
      return whiten_for_regression(blocks, difference(forces, of.nominal.f_W_N, 1.0), {}).residual;
    };
    of.residuals.resize(static_cast<Eigen::Index>(3 * blocks.blocks.size()), 1 + NoiseModel::null_worlds);
    of.residuals.col(0) = whitened(evidence.recording->f_W_N);
    for (std::size_t world = 0; world < NoiseModel::null_worlds; ++world) {
      of.residuals.col(static_cast<Eigen::Index>(world + 1)) =
          whitened(evidence.noise->null_forces(model, of.nominal, world));
    }
    std::vector<std::vector<Vec3>> series;
    constexpr double step = 1e-3;
    for (const FreeParameter& parameter : state_.compared()) {
      Model moved = model;
      const double u = parameter.get(model);
      parameter.set(moved, u + (u + step > parameter.upper ? -step : step));
      series.push_back(
          difference(evidence.predictor->predict(moved).f_W_N, of.nominal.f_W_N, parameter.get(moved) - u));
    }
    of.nuisances = of.answer(series);
    return of;
  }

  [[nodiscard]] std::optional<Regressed> one(const Start& start, std::size_t number) const {
    std::array<Squares, 2> with;
    for (std::size_t s = 0; s < 2; ++s) {
      std::vector<std::vector<Vec3>> series;
      for (const std::string& name : start.term->linear) {
        // Small against the force, so that what cannot pull does not let go.
        constexpr double share = 1e-3;
        const double size = share * declaration(start.term->effect, name).initial;
        NamedParameters entry = start.entry;
        entry.parameters[name] = size;
        const Model model = with_entry(state_.current.model, side_of(*start.term), entry);
        series.push_back(
            difference(sides_[s].evidence->predictor->predict(model).f_W_N, sides_[s].nominal.f_W_N, size));
      }
      const Eigen::MatrixXd answers = sides_[s].answer(series);
      Eigen::MatrixXd responses(answers.rows(), sides_[s].nuisances.cols() + answers.cols());
      responses << sides_[s].nuisances, answers;
      if (!responses.allFinite()) return std::nullopt;
      with[s] = squares_of(responses, sides_[s].residuals);
    }
    Regressed regressed;
    regressed.start = number;
    for (Eigen::Index world = 0; world < plain_[0].residual.size(); ++world) {
      const Eigen::VectorXd before = solve(plain_[0], world);
      const Eigen::VectorXd after = solve(with[0], world);
      const double gain = plain_[1].left(before, world) - with[1].left(after, world);
      if (!std::isfinite(gain)) return std::nullopt;
      if (world > 0) {
        regressed.null_gains.push_back(gain);
        continue;
      }
      regressed.gain = gain;
      regressed.train_gain = plain_[0].left(before, world) - with[0].left(after, world);
      const auto sizes = after.tail(static_cast<Eigen::Index>(start.term->linear.size()));
      regressed.sizes.assign(sizes.begin(), sizes.end());
    }
    return regressed;
  }

  const SearchState& state_;
  std::array<SideOf, 2> sides_;
  std::array<Squares, 2> plain_;
};

// The most that any start gains in each world.
double bar_of(const std::vector<Regressed>& all, const SearchSettings& settings) {
  std::vector<double> most(NoiseModel::null_worlds, 0.0);
  for (const Regressed& one : all) {
    for (std::size_t world = 0; world < most.size(); ++world)
      most[world] = std::max(most[world], one.null_gains[world]);
  }
  return std::max(settings.minimum_gain, bar_above(most, settings.null_deviations));
}

// How the parameters of a term enter a fit from an entry: sizes in steps of what they are.
std::vector<FreeParameter> free_of(const LawTerm& term, const NamedParameters& entry) {
  std::vector<FreeParameter> free;
  for (const ParameterDeclaration& parameter : term.effect.parameters) {
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
    std::vector<Start> starts;
    std::vector<std::shared_ptr<const DeclaredEffect>> laws;
    for (const LawTerm& term : terms) {
      laws.push_back(std::make_shared<const DeclaredEffect>(term.effect));
      if (find_entry(state_.current.model, term.effect.name) != nullptr) continue;
      for (const auto& constants : term.constants) starts.push_back(start_of(term, laws.back(), constants));
    }
    std::vector<Regressed> all = Regression(state_).all(starts);
    const double bar = bar_of(all, *state_.settings);
    std::sort(all.begin(), all.end(), [](const Regressed& a, const Regressed& b) { return a.gain > b.gain; });
    std::vector<Refined> refined;
    for (const Regressed& one : all) {
      if (!(one.gain > bar) || refined.size() >= most_refined) break;
      const Start& start = starts[one.start];
      const bool known = std::ranges::any_of(refined, [&](const Refined& other) { return other.term == start.term; });
      if (known || !state_.budget->allows(start.entry.name)) continue;
      if (auto better = refine(start, one)) refined.push_back(std::move(*better));
    }
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

  [[nodiscard]] double deviance() const { return state_.validation_deviance(state_.current.model); }
  [[nodiscard]] const SearchState& state() const { return state_; }
  [[nodiscard]] const std::vector<LawPiece>& pieces() const { return pieces_; }

 private:
  [[nodiscard]] WavePeaks peaks() const {
    const FitData& blocks = state_.train;
    const Recording& recording = *state_.data->train.recording;
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

  [[nodiscard]] std::optional<Refined> refine(const Start& start, const Regressed& regressed) const {
    NamedParameters entry = start.entry;
    for (std::size_t i = 0; i < regressed.sizes.size(); ++i) {
      const std::string& name = start.term->linear[i];
      const ParameterDeclaration& bounds = declaration(start.term->effect, name);
      entry.parameters[name] = std::clamp(regressed.sizes[i], 0.99 * bounds.minimum, 0.99 * bounds.maximum);
    }
    Refined refined{start.term, start.entry.law, regressed.gain, state_};
    SearchState& next = refined.state;
    next.parameters = joined(state_.parameters, free_of(*start.term, entry));
    next.current.model = with_entry(state_.current.model, side_of(*start.term), entry);
    next.renew_noise(next.current.model);
    // Weights by what the law leaves, and again.
    for (int pass = 0; pass < 2; ++pass) {
      JointFit fit =
          fit_jointly(next.train, Model(next.current.model), next.compared(), next.settings->iterations, false);
      if (!fit.ok) return std::nullopt;
      next.current = std::move(fit);
      next.renew_noise(next.current.model);
    }
    refined.deviance = next.validation_deviance(next.current.model);
    refined.rms_N = next.validation_rms_N(next.current.model);
    return refined;
  }

  // The best that matters; one of fewer parameters that does nearly as well is preferred.
  [[nodiscard]] const Refined* preferred(const std::vector<Refined>& refined) const {
    const double before = state_.validation_deviance(state_.current.model);
    const auto square = [](double value) { return value * value; };
    const double here = square(state_.validation_rms_N(state_.current.model));
    const double noise = square(expected_noise_N(state_.data->validation, state_.current.model));
    const Refined* best = nullptr;
    for (const Refined& one : refined) {
      const bool matters = here - square(one.rms_N) > least_share * std::max(0.0, here - noise) &&
                           before - one.deviance > state_.settings->minimum_gain;
      report_(fmt::format("    {}: gain {:.0f}, deviance {:.0f} less, validation RMS {:.4g} N{}", one.law->name,
                          one.gain, before - one.deviance, one.rms_N, matters ? "" : ", too little"));
      if (matters && (best == nullptr || one.deviance < best->deviance)) best = &one;
    }
    if (best == nullptr) return nullptr;
    const Refined* simplest = best;
    for (const Refined& one : refined) {
      const bool near = one.deviance - best->deviance < alike * (before - best->deviance);
      if (near && one.term->effect.parameters.size() < simplest->term->effect.parameters.size()) simplest = &one;
    }
    return simplest;
  }

  SearchState state_;
  const Report& report_;
  ViewScales scales_;
  std::vector<LawPiece> pieces_;
};

// Along the likely motion: between neighbouring samples a tracker's noise is faster than a hand.
std::vector<SeenRange> ranges(const Evidence& learning, const Model& model) {
  const MotionColumns& motion = learning.noise->likely_motion();
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

UnknownLaw search_law(const SearchState& found, const Model& base, const Report& report) {
  constexpr const char* what = "a law for what is left";
  if (!found.budget->allows(what)) return {};
  report(what);
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
    // Of two that do as well the one with fewer effects.
    const auto count = [](const LawSearch& of) {
      return of.state().current.model.effects.size() + of.state().current.model.instrument.size();
    };
    const auto cost = [&](const LawSearch& of) {
      return of.deviance() + found.settings->minimum_gain * static_cast<double>(count(of));
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
