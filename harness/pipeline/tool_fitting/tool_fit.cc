#include "harness/pipeline/tool_fitting/tool_fit.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/base/error.h"
#include "harness/pipeline/tool_fitting/tool_effects.h"
#include "harness/stats/distributions.h"
#include "harness/stats/sandwich.h"
#include "harness/tool/tool_path.h"

namespace touchstone::pipeline {
namespace {

using tool::Coupling;

// Of all effects together.
constexpr int kMostParameters = 16;
using Values = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostParameters, 1>;
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostParameters, kMostParameters>;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMostParameters>;

// Where the parameters of each effect stand among all: those that what is shown is linear in, then those of the
// coupling.
struct Layout {
  struct Placed {
    const ToolEffectTraits* effect;
    int first;
  };
  std::vector<Placed> effects;
  int linear = 0;
  int all = 0;

  Layout() {
    for (const ToolEffectTraits& effect : tool_effects()) {
      effects.push_back({&effect, all});
      all += effect.count;
      if (effect.columns != nullptr) linear = all;
    }
  }

  [[nodiscard]] Coupling scaled(const Coupling& declared, const Values& v) const {
    Coupling coupling = declared;
    for (const auto& [effect, first] : effects) {
      if (effect->change != nullptr) effect->change(v[first], coupling);
    }
    return coupling;
  }
  // What is shown for one unit more of each parameter that it is linear in.
  [[nodiscard]] Jacobian linear_columns(const Wrench& w_T) const {
    Jacobian j = Jacobian::Zero(6, linear);
    for (const auto& [effect, first] : effects) {
      if (effect->columns != nullptr) j.middleCols(first, effect->count) = effect->columns(w_T);
    }
    return j;
  }
  // In the sensor's axes: what it shows of this wrench with these values.
  [[nodiscard]] Vec6 shown(const Wrench& wrench_W, const Quat& q_WT, const Values& v) const {
    const Wrench w_T = rotated(q_WT.conjugate(), wrench_W);
    Vec6 out;
    out << w_T.f_N, w_T.torque_Nm;
    return out + linear_columns(w_T) * v.head(linear);
  }
};

constexpr std::size_t kFewestSamples = 400;
constexpr int kBlocks = 40;
constexpr double kDetermined = 0.3;  // of the prior's width

std::vector<Wrench> rendered(const recording::Recording& measured, const MakeTool& make, const Coupling& coupling) {
  const auto renderer = make(coupling);
  renderer->reset();
  std::vector<Wrench> wrenches;
  wrenches.reserve(measured.size());
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const tool::ToolResult result =
        tool::step_or_throw(*renderer, {measured.motion.t_s[i], {measured.motion.p_W_m[i], measured.motion.q_WS[i]}});
    wrenches.push_back({result.f_W_N, result.torque_W_Nm});
  }
  return wrenches;
}

Vec6 measured_T(const recording::Recording& measured, std::size_t i) {
  const Quat to_T = measured.motion.q_WS[i].conjugate();
  Vec6 out;
  out << to_T * measured.f_W_N[i], to_T * measured.torque_W_Nm[i];
  return out;
}

struct Blocks {
  double first_s, length_s;
  [[nodiscard]] int of(double t_s) const { return std::min(static_cast<int>((t_s - first_s) / length_s), kBlocks - 1); }
  // Every other one is for the fit.
  [[nodiscard]] static bool fitted(int block) { return block % 2 == 0; }
};

// One linearisation: the sums of the normal equations, and the gradient of each block.
struct Step {
  explicit Step(int parameters)
      : hessian(Square::Zero(parameters, parameters)),
        gradient(Values::Zero(parameters)),
        of_blocks(Eigen::MatrixXd::Zero(kBlocks / 2, parameters)) {}

  Square hessian;
  Values gradient;
  Eigen::MatrixXd of_blocks;
  ToolErrors spread;  // RMS of what is left, an axis
};

struct Noise {
  double force_N, torque_Nm;

  // One over the deviation of each of the six.
  [[nodiscard]] Vec6 weight() const {
    Vec6 out;
    out << Vec3::Constant(1.0 / force_N), Vec3::Constant(1.0 / torque_Nm);
    return out;
  }
};

class Fitter {
 public:
  Fitter(const recording::Recording& measured, const MakeTool& make, const Coupling& declared)
      : measured_(measured), make_(make), declared_(declared) {
    const auto& t_s = measured.motion.t_s;
    blocks_ = {t_s.front(), (t_s.back() - t_s.front()) / kBlocks};
    ToolRecordingScales scales;
    for (std::size_t i = 0; i < measured.size(); ++i) {
      scales.force_N = std::max(scales.force_N, measured.f_W_N[i].norm());
      scales.torque_Nm = std::max(scales.torque_Nm, measured.torque_W_Nm[i].norm());
    }
    for (const auto& [effect, first] : layout_.effects)
      width_.segment(first, effect->count).setConstant(effect->plausible(scales));
  }

  ToolFit run() {
    ToolFit fit;
    fit.declared = fit.coupling = declared_;
    fit.declared_W = rendered(measured_, make_, declared_);
    if (std::ranges::none_of(fit.declared_W, [](const Wrench& w) { return w.f_N != Vec3::Zero(); })) {
      throw BadData(
          fmt::format("{}: the renderer never touches along this path; are tool, object and path in one "
                      "frame and unit?",
                      measured_.source));
    }
    const Square all = solve();
    judge(all, fit);
    // What is not named stays as declared; the others are fitted again without it.
    for (std::size_t e = 0; e < layout_.effects.size(); ++e) {
      const auto& [effect, first] = layout_.effects[e];
      for (int k = 0; k < effect->count; ++k) free_[at(first + k)] = fit.effects[e].named;
    }
    solve();
    fit.coupling = layout_.scaled(declared_, values_);
    const std::vector<Wrench> fitted = rendered(measured_, make_, fit.coupling);
    fit.before = errors(fit.declared_W, Values::Zero(layout_.all));
    fit.after = errors(fitted, values_);
    for (std::size_t i = 0; i < fitted.size(); ++i) {
      const Vec6 s = layout_.shown(fitted[i], measured_.motion.q_WS[i], values_);
      fit.fitted_W.push_back({measured_.motion.q_WS[i] * s.head<3>(), measured_.motion.q_WS[i] * s.tail<3>()});
    }
    return fit;
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  // The values at which the sum of squares is least, and the covariance there.
  Square solve() {
    values_.setZero(layout_.all);
    Noise noise{1.0, 1.0};
    constexpr int kMostRounds = 15;
    constexpr double kLongest = 0.5;  // of a stiffness' logarithm in one round
    constexpr double kStill = 1e-5;   // of the priors' widths
    Step step(layout_.all);
    for (int round = 0; round < kMostRounds; ++round) {
      step = linearised(noise);
      noise = {std::max(step.spread.force_N, 1e-9), std::max(step.spread.torque_Nm, 1e-12)};
      if (round == 0) continue;  // the first tells the weights
      const Values by = solved(step);
      const double longest = by.tail(layout_.all - layout_.linear).cwiseAbs().maxCoeff();
      // A contact that jumps makes the slope wrong: a shorter step then.
      const double here = loss(values_, noise);
      double share = std::min(1.0, kLongest / std::max(longest, kLongest));
      while (share > 0.05 && !(loss(values_ + share * by, noise) < here)) share *= 0.5;
      if (share <= 0.05) break;
      values_ += share * by;
      if ((share * by.cwiseQuotient(width_)).cwiseAbs().maxCoeff() < kStill) break;
    }
    polish(noise);
    return covariance(linearised(noise));
  }

  // Where a tool jams or a contact changes, slopes mislead and Gauss and Newton's method stops early: the two
  // stiffnesses are searched once more by steps along each that halve (Hooke and Jeeves 1961), the linear values
  // solved exactly for each pair (variable projection: Golub and Pereyra 1973).
  void polish(const Noise& noise) {
    constexpr double kFirst = 0.08, kLast = 1e-4;  // of a logarithm
    values_ = with_linear(values_, noise);
    double best = loss(values_, noise);
    for (double width = kFirst; width > kLast; width *= 0.5) {
      for (int k = layout_.linear; k < layout_.all; ++k) {
        if (!free_[at(k)]) continue;
        for (const double by : {width, -width}) {
          Values tried = values_;
          tried[k] += by;
          tried = with_linear(tried, noise);
          const double there = loss(tried, noise);
          if (!(there < best)) continue;
          best = there;
          values_ = tried;
          break;
        }
      }
    }
  }

  // Of the parameters that are free; the column of one that is not is nought.
  Jacobian free_columns(const Wrench& wrench_W, const Quat& q_WT) const {
    Jacobian j = layout_.linear_columns(rotated(q_WT.conjugate(), wrench_W));
    for (int k = 0; k < layout_.linear; ++k) {
      if (!free_[at(k)]) j.col(k).setZero();
    }
    return j;
  }

  // With the linear values that fit best at these stiffnesses.
  Values with_linear(Values values, const Noise& noise) const {
    const std::vector<Wrench> wrenches = rendered(measured_, make_, layout_.scaled(declared_, values));
    const int linear = layout_.linear;
    Square hessian = Square::Zero(linear, linear);
    Values gradient = Values::Zero(linear);
    const Vec6 weight = noise.weight();
    for (std::size_t i = 0; i < wrenches.size(); ++i) {
      if (!Blocks::fitted(blocks_.of(measured_.motion.t_s[i]))) continue;
      const Quat& q = measured_.motion.q_WS[i];
      const Jacobian j = weight.asDiagonal() * free_columns(wrenches[i], q);
      const Vec6 left = measured_T(measured_, i) - layout_.shown(wrenches[i], q, Values::Zero(layout_.all));
      hessian.noalias() += j.transpose() * j;
      gradient.noalias() += j.transpose() * weight.cwiseProduct(left);
    }
    for (int k = 0; k < linear; ++k) hessian(k, k) += free_[at(k)] ? 1.0 / (width_[k] * width_[k]) : 1.0;
    values.head(linear) = hessian.ldlt().solve(gradient);
    return values;
  }

  // What is minimised, at these weights.
  double loss(const Values& values, const Noise& noise) const {
    const std::vector<Wrench> wrenches = rendered(measured_, make_, layout_.scaled(declared_, values));
    double sum = 0.0;
    for (std::size_t i = 0; i < wrenches.size(); ++i) {
      if (!Blocks::fitted(blocks_.of(measured_.motion.t_s[i]))) continue;
      const Vec6 left = measured_T(measured_, i) - layout_.shown(wrenches[i], measured_.motion.q_WS[i], values);
      sum += left.head<3>().squaredNorm() / (noise.force_N * noise.force_N) +
             left.tail<3>().squaredNorm() / (noise.torque_Nm * noise.torque_Nm);
    }
    return sum + values.cwiseQuotient(width_).squaredNorm();
  }

  Values solved(const Step& step) const { return step.hessian.ldlt().solve(step.gradient); }

  // The normal equations of Gauss and Newton's method about values_: residual r = measured - layout_.shown(v), J = d
  // shown / dv,
  //   (sum J' W J + P) dv = sum J' W r - P v,
  // W the weights squared, P the prior's precision. The stiffnesses' columns are differences
  // forward, of 1 % of the stiffness.
  Step linearised(const Noise& noise) {
    constexpr double kDifference = 0.01;
    const std::vector<Wrench> here = rendered(measured_, make_, layout_.scaled(declared_, values_));
    const int linear = layout_.linear;
    std::vector<std::vector<Wrench>> beside(at(layout_.all));
    for (int k = linear; k < layout_.all; ++k) {
      if (!free_[at(k)]) continue;
      Values v = values_;
      v[k] += kDifference;
      beside[at(k)] = rendered(measured_, make_, layout_.scaled(declared_, v));
    }
    Step step(layout_.all);
    const Vec6 weight = noise.weight();
    std::size_t count = 0;
    for (std::size_t i = 0; i < here.size(); ++i) {
      const int block = blocks_.of(measured_.motion.t_s[i]);
      if (!Blocks::fitted(block)) continue;
      const Quat& q = measured_.motion.q_WS[i];
      const Vec6 now = layout_.shown(here[i], q, values_);
      const Vec6 left = measured_T(measured_, i) - now;
      step.spread.force_N += left.head<3>().squaredNorm();
      step.spread.torque_Nm += left.tail<3>().squaredNorm();
      ++count;
      Jacobian j = Jacobian::Zero(6, layout_.all);
      j.leftCols(linear) = free_columns(here[i], q);
      for (int k = linear; k < layout_.all; ++k) {
        if (free_[at(k)]) j.col(k) = (layout_.shown(beside[at(k)][i], q, values_) - now) / kDifference;
      }
      j = weight.asDiagonal() * j;
      const Values g = j.transpose() * weight.cwiseProduct(left);
      step.hessian.noalias() += j.transpose() * j;
      step.gradient += g;
      step.of_blocks.row(block / 2) += g.transpose();
    }
    step.spread.force_N = std::sqrt(step.spread.force_N / (3.0 * double(count)));
    step.spread.torque_Nm = std::sqrt(step.spread.torque_Nm / (3.0 * double(count)));
    // The prior; a value that is not free is held at nought by it alone.
    for (int k = 0; k < layout_.all; ++k) {
      const double tight = free_[at(k)] ? 1.0 / (width_[k] * width_[k]) : 1.0;
      step.hessian(k, k) += tight;
      step.gradient[k] -= tight * values_[k];
    }
    return step;
  }

  // The larger of the sandwich and of what independent samples would have, value by value.
  Square covariance(const Step& step) const {
    const Square inverse = step.hessian.inverse();
    const double blocks = kBlocks / 2.0;
    const Eigen::RowVectorXd middle = step.of_blocks.colwise().mean();
    const Square robust =
        stats::sandwich_covariance(inverse, step.of_blocks.rowwise() - middle) * (blocks / (blocks - 1.0));
    Values grow(layout_.all);
    for (int k = 0; k < layout_.all; ++k) grow[k] = std::sqrt(std::max(1.0, inverse(k, k) / robust(k, k)));
    return grow.asDiagonal() * robust * grow.asDiagonal();
  }

  void judge(const Square& covariance, ToolFit& fit) const {
    constexpr double kAlpha = 0.05;
    const double blocks = kBlocks / 2.0;
    const Coupling at_fit = layout_.scaled(declared_, values_);
    for (const auto& [known, first] : layout_.effects) {
      ToolEffect effect{known->name, known->what, known->unit, {}, {}, {}, 1.0, false};
      const int count = known->count;
      const Eigen::VectorXd values = values_.segment(first, count);
      const Eigen::MatrixXd own = covariance.block(first, first, count, count);
      const double squared = values.dot(own.ldlt().solve(values));
      const double f = squared * (blocks - count) / (count * (blocks - 1.0));
      effect.p = std::isfinite(f) ? stats::f_tail(f, count, blocks - count) : 1.0;
      bool any = false;
      for (int k = 0; k < count; ++k) {
        const double error = std::sqrt(own(k, k));
        const double of_coupling = known->value != nullptr ? known->value(at_fit) : 0.0;
        effect.values.push_back(known->value != nullptr ? of_coupling : values[k]);
        effect.standard_errors.push_back(known->value != nullptr ? of_coupling * error : error);
        effect.determined.push_back(error < kDetermined * width_[first + k]);
        any = any || effect.determined.back();
      }
      effect.named = any && effect.p < kAlpha / double(layout_.effects.size());
      fit.effects.push_back(std::move(effect));
    }
  }

  ToolErrors errors(const std::vector<Wrench>& wrenches, const Values& values) const {
    ToolErrors sum;
    std::size_t count = 0;
    for (std::size_t i = 0; i < wrenches.size(); ++i) {
      if (Blocks::fitted(blocks_.of(measured_.motion.t_s[i]))) continue;
      const Vec6 left = measured_T(measured_, i) - layout_.shown(wrenches[i], measured_.motion.q_WS[i], values);
      sum.force_N += left.head<3>().squaredNorm();
      sum.torque_Nm += left.tail<3>().squaredNorm();
      ++count;
    }
    return {std::sqrt(sum.force_N / double(count)), std::sqrt(sum.torque_Nm / double(count))};
  }

  const recording::Recording& measured_;
  const MakeTool& make_;
  Coupling declared_;
  Blocks blocks_{};
  Layout layout_;
  Values width_ = Values::Ones(layout_.all);
  Values values_ = Values::Zero(layout_.all);
  std::vector<bool> free_ = std::vector<bool>(at(layout_.all), true);
};

void require_wrench_and_pose(const recording::Recording& measured) {
  if (measured.motion.q_WS.empty()) {
    throw BadData(fmt::format("{}: no orientation: the columns qw, qx, qy and qz were expected", measured.source));
  }
  if (measured.torque_W_Nm.empty()) {
    throw BadData(fmt::format("{}: no torque: the columns tx_Nm, ty_Nm and tz_Nm were expected", measured.source));
  }
  if (measured.size() < kFewestSamples) {
    throw BadData(fmt::format("{}: {} samples; at least {} are needed to fit and to judge on other parts",
                              measured.source, measured.size(), kFewestSamples));
  }
  const auto zero = [](const Eigen::Vector3d& v) { return v.isZero(0.0); };
  if (std::ranges::all_of(measured.f_W_N, zero))
    throw BadData(fmt::format("{}: every force is zero: was it measured?", measured.source));
  if (std::ranges::all_of(measured.torque_W_Nm, zero))
    throw BadData(fmt::format("{}: every torque is zero: was it measured?", measured.source));
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (std::size_t i = 0; i < parts.size(); ++i)
    text += (i == 0 ? "" : i + 1 == parts.size() ? " and " : ", ") + parts[i];
  return text;
}

}  // namespace

ToolFit fit_tool(const recording::Recording& measured, const MakeTool& make, const Coupling& declared) {
  require_wrench_and_pose(measured);
  ToolFit fit = Fitter(measured, make, declared).run();
  if (fit.after.force_N > fit.before.force_N || fit.after.torque_Nm > fit.before.torque_Nm) {
    fit.remarks.emplace_back("on the blocks that the fit has not seen an error grew: do not use these values");
  }
  double largest_N = 0.0;
  for (const Vec3& f : measured.f_W_N) largest_N = std::max(largest_N, f.norm());
  constexpr double kTouching = 0.2;  // of the largest force: more than biases and noise of a sensor that is in use
  if (measured.f_W_N.front().norm() > kTouching * largest_N) {
    fit.remarks.emplace_back(
        "the recording begins in contact: a proxy that begins inside the object may stay on a wrong "
        "side of it; begin above the object");
  }
  for (const ToolEffect& effect : fit.effects) {
    for (std::size_t k = 0; k < effect.values.size(); ++k) {
      if (effect.determined[k]) continue;
      const std::string axis = effect.values.size() == 3 ? fmt::format(" along {}", "xyz"[k]) : "";
      fit.remarks.push_back(fmt::format(
          "{}{} is not determined by this motion: turn the tool and press from more sides", effect.name, axis));
    }
  }
  return fit;
}

std::string tool_fit_text(const ToolFit& fit) {
  std::vector<std::string> names;
  for (const ToolEffect& effect : fit.effects) {
    if (effect.named) names.push_back(effect.name);
  }
  std::string text =
      names.empty() ? "nothing of the instrument stands out" : fmt::format("{} explain the difference", joined(names));
  if (names.size() == 1) text = names[0] + " explains the difference";
  text += fmt::format(
      ": on the blocks that the fit has not seen the force error goes from {:.3g} to {:.3g} N RMS, the "
      "torque error from {:.3g} to {:.3g} mNm\n",
      fit.before.force_N, fit.after.force_N, 1e3 * fit.before.torque_Nm, 1e3 * fit.after.torque_Nm);
  for (const ToolEffect& effect : fit.effects) {
    text += fmt::format("  {} {:<21}", effect.named ? "*" : " ", effect.name);
    for (std::size_t k = 0; k < effect.values.size(); ++k)
      text += fmt::format(" {:.4g} +- {:.2g}", effect.values[k], effect.standard_errors[k]);
    text += fmt::format(" {} (p {:.2g})\n", effect.unit, effect.p);
  }
  for (const std::string& remark : fit.remarks) text += "  " + remark + "\n";
  return text;
}

std::string tool_fit_json(const ToolFit& fit) {
  nlohmann::ordered_json json{
      {"schema", "touchstone-tool-fit/1"},
      {"declared_stiffness_N_per_m", fit.declared.stiffness_N_per_m},
      {"declared_rotational_stiffness_Nm_per_rad", fit.declared.rotational_stiffness_Nm_per_rad},
      {"stiffness_N_per_m", fit.coupling.stiffness_N_per_m},
      {"rotational_stiffness_Nm_per_rad", fit.coupling.rotational_stiffness_Nm_per_rad},
      {"force_rms_before_N", fit.before.force_N},
      {"force_rms_after_N", fit.after.force_N},
      {"torque_rms_before_Nm", fit.before.torque_Nm},
      {"torque_rms_after_Nm", fit.after.torque_Nm},
      {"effects", nlohmann::ordered_json::array()},
      {"remarks", fit.remarks}};
  for (const ToolEffect& effect : fit.effects) {
    json["effects"].push_back({{"name", effect.name},
                               {"unit", effect.unit},
                               {"values", effect.values},
                               {"standard_errors", effect.standard_errors},
                               {"determined", effect.determined},
                               {"p", effect.p},
                               {"named", effect.named}});
  }
  return json.dump(2) + "\n";
}

}  // namespace touchstone::pipeline
