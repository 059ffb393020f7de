#include "tool_fitting/tool_search.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "harness/stats/distributions.h"

namespace touchstone::tool_fitting {
namespace {

using Effort = ToolFitter::Effort;
using Part = ToolFitter::Part;

constexpr double alpha = 0.05;

// One-sided, of the mean being above nought; 1 where it cannot be told.
double p_of_mean(const std::vector<double>& x) {
  const auto n = double(x.size());
  double mean = 0.0, squares = 0.0;
  for (const double v : x) mean += v / n;
  for (const double v : x) squares += (v - mean) * (v - mean);
  const double t = mean / std::sqrt(squares / (n - 1.0) / n);
  if (!std::isfinite(t)) return 1.0;
  const double two_sided = stats::student_p(t, n - 1.0);
  return t > 0.0 ? 0.5 * two_sided : 1.0 - 0.5 * two_sided;
}

class Search {
 public:
  explicit Search(ToolFitter& fitter) : fitter_(fitter), count_(tool_effects().size()) {}

  ToolChoice run() {
    const ToolEffectSet all(count_, true);
    const ToolSolution full = fitter_.solve(all, Effort::thorough);
    ToolEffectSet set(count_, false);
    for (std::size_t e = 0; e < count_; ++e) set[e] = stands_out(full, e);
    best_ = set == all ? full : fitter_.solve(set, Effort::thorough, &full);
    ToolEffectSet left_out(count_, false);  // taken away once: not added again, so that the search ends
    while (take_away(left_out) || add(left_out)) {
    }
    ToolChoice choice{best_, {}};
    for (std::size_t e = 0; e < count_; ++e) choice.effects.push_back(seen(e));
    return choice;
  }

 private:
  [[nodiscard]] bool stands_out(const ToolSolution& model, std::size_t e) const {
    const std::vector<bool> determined = fitter_.determined(model, e);
    return std::ranges::find(determined, true) != determined.end() && fitter_.p_of(model, e) < alpha / double(count_);
  }
  [[nodiscard]] static ToolEffectSet changed(ToolEffectSet set, std::size_t e) {
    set[e] = !set[e];
    return set;
  }

  bool take_away(ToolEffectSet& left_out) {
    std::optional<std::size_t> least;
    double least_gain = 0.0;
    for (std::size_t e = 0; e < count_; ++e) {
      if (!best_.effects[e]) continue;
      const ToolSolution less = fitter_.solve(changed(best_.effects, e), Effort::quick, &best_);
      const ToolGain gain = gain_of(fitter_, best_, less);
      if (stands_out(best_, e) && gain.p < alpha) continue;
      if (least && gain.per_sample >= least_gain) continue;
      least = e;
      least_gain = gain.per_sample;
    }
    if (!least) return false;
    left_out[*least] = true;
    best_ = fitter_.solve(changed(best_.effects, *least), Effort::thorough, &best_);
    return true;
  }

  bool add(const ToolEffectSet& left_out) {
    std::optional<std::size_t> most;
    double most_gain = 0.0;
    for (std::size_t e = 0; e < count_; ++e) {
      if (best_.effects[e] || left_out[e]) continue;
      const ToolSolution more = fitter_.solve(changed(best_.effects, e), Effort::quick, &best_);
      const ToolGain gain = gain_of(fitter_, more, best_);
      if (!stands_out(more, e) || !(gain.p < alpha)) continue;
      if (most && gain.per_sample <= most_gain) continue;
      most = e;
      most_gain = gain.per_sample;
    }
    if (!most) return false;
    best_ = fitter_.solve(changed(best_.effects, *most), Effort::thorough, &best_);
    return true;
  }

  ToolChoice::OfEffect seen(std::size_t e) {
    ToolChoice::OfEffect out;
    const ToolSolution other = fitter_.solve(changed(best_.effects, e), Effort::quick, &best_);
    if (!best_.effects[e]) {
      out.with = other;
      out.gain = gain_of(fitter_, other, best_);
      out.p = fitter_.p_of(other, e);
      return out;
    }
    out.with = best_;
    out.gain = gain_of(fitter_, best_, other);
    out.p = fitter_.p_of(best_, e);
    for (std::size_t r = 0; r < count_; ++r) {
      if (best_.effects[r]) continue;
      const ToolSolution instead = fitter_.solve(changed(changed(best_.effects, e), r), Effort::quick, &best_);
      if (stands_out(instead, r) && !(gain_of(fitter_, best_, instead).p < alpha)) out.rivals.push_back(r);
    }
    return out;
  }

  ToolFitter& fitter_;
  std::size_t count_;
  ToolSolution best_;
};

struct Reading {
  const char* name;
  const char* what;
  void (*read)(const Quat& q_WT, Vec3& f, Vec3& torque);
};
constexpr std::array readings{
    Reading{"torque-sign", "it fits far better if every torque is reversed",
            [](const Quat& /*q_WT*/, Vec3& /*f*/, Vec3& torque) { torque = -torque; }},
    Reading{"wrench-sign",
            "it fits far better if force and torque are reversed: is it the wrench of the tool on the object?",
            [](const Quat& /*q_WT*/, Vec3& f, Vec3& torque) {
              f = -f;
              torque = -torque;
            }},
    Reading{"torque-frame", "it fits far better if the torque's components are read in the tool's axes",
            [](const Quat& q_WT, Vec3& /*f*/, Vec3& torque) { torque = q_WT * torque; }},
    Reading{"wrench-frame", "it fits far better if force and torque are read in the tool's axes",
            [](const Quat& q_WT, Vec3& f, Vec3& torque) {
              f = q_WT * f;
              torque = q_WT * torque;
            }},
};

// Sensors have them whatever they measure: biases and weight.
ToolEffectSet of_every_sensor() {
  ToolEffectSet set;
  for (const ToolEffectTraits& effect : tool_effects()) set.push_back(effect.of_every_sensor);
  return set;
}

bool has_lever_arm(const ToolEffectSet& set) {
  for (std::size_t e = 0; e < set.size(); ++e) {
    if (set[e] && tool_effects()[e].columns != nullptr && !tool_effects()[e].of_every_sensor) return true;
  }
  return false;
}

std::vector<double> differences(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

}  // namespace

ToolGain gain_of(ToolFitter& fitter, const ToolSolution& model, const ToolSolution& over) {
  std::vector<double> of_block = fitter.log_likelihoods(model, Part::choosing);
  const std::vector<double> other = fitter.log_likelihoods(over, Part::choosing);
  double sum = 0.0;
  for (std::size_t b = 0; b < of_block.size(); ++b) sum += of_block[b] -= other[b];
  return {sum / double(fitter.samples(Part::choosing)), p_of_mean(of_block)};
}

ToolChoice choose_effects(ToolFitter& fitter) { return Search(fitter).run(); }

std::optional<ToolMisreading> find_misreading(const recording::Recording& measured, const MakeTool& make,
                                              const tool::Coupling& declared, ToolFitter& fitter,
                                              const ToolChoice& chosen) {
  constexpr double sure = 0.001;
  constexpr double far_better_share = 0.5;  // of the error as recorded
  const ToolSolution recorded = fitter.solve(of_every_sensor(), Effort::quick);
  const std::vector<double> recorded_likelihoods = fitter.log_likelihoods(recorded, Part::choosing);
  const ToolErrors recorded_errors = fitter.errors(recorded, Part::choosing);
  const std::vector<double> chosen_likelihoods = fitter.log_likelihoods(chosen.best, Part::choosing);
  std::optional<ToolMisreading> found;
  double most = 0.0;
  for (const Reading& reading : readings) {
    recording::Recording other = measured;
    for (std::size_t i = 0; i < other.size(); ++i)
      reading.read(other.motion.q_WS[i], other.f_W_N[i], other.torque_W_Nm[i]);
    ToolFitter other_fitter(other, make, declared, &fitter);
    const ToolSolution so = other_fitter.solve(of_every_sensor(), Effort::quick);
    const ToolErrors errors = other_fitter.errors(so, Part::choosing);
    const bool far_better = errors.force_N < far_better_share * recorded_errors.force_N ||
                            errors.torque_Nm < far_better_share * recorded_errors.torque_Nm;
    const std::vector<double> likelihoods = other_fitter.log_likelihoods(so, Part::choosing);
    if (!far_better || !(p_of_mean(differences(likelihoods, recorded_likelihoods)) < sure / double(readings.size())))
      continue;
    const ToolSolution best = choose_effects(other_fitter).best;
    const std::vector<double> best_likelihoods = other_fitter.log_likelihoods(best, Part::choosing);
    const bool worse = p_of_mean(differences(chosen_likelihoods, best_likelihoods)) < alpha;
    if (worse || has_lever_arm(best.effects)) continue;
    double sum = 0.0;
    for (const double block : best_likelihoods) sum += block;
    if (found && sum <= most) continue;
    found = {reading.name, reading.what, recorded_errors, errors};
    most = sum;
  }
  return found;
}

}  // namespace touchstone::tool_fitting
