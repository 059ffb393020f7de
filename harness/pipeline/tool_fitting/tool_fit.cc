#include "harness/pipeline/tool_fitting/tool_fit.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/base/error.h"
#include "harness/stats/distributions.h"
#include "harness/stats/sandwich.h"
#include "harness/tool/tool_path.h"

namespace touchstone::pipeline {
namespace {

using tool::Coupling;

// Parameters: force bias (0 to 2), torque bias (3 to 5), lever arm (6 to 8), logarithms of both stiffnesses over the
// declared ones (9, 10).
constexpr int kParameters = 11;
constexpr int kLinear = 9;  // of these, the first: what is shown is linear in them
using Values = Eigen::Matrix<double, kParameters, 1>;
using Square = Eigen::Matrix<double, kParameters, kParameters>;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Jacobian = Eigen::Matrix<double, 6, kParameters>;
using LinearColumns = Eigen::Matrix<double, 6, kLinear>;

struct EffectOfFit {
  const char* name;
  const char* what;
  const char* unit;
  int first;
  int count;
  double plausible;  // width of the prior: what an instrument could have
};
// The biases' width is relative to the largest load; a lever arm is of the size of a hand, and a stiffness that is off
// by more than a factor e was not declared for this tool.
constexpr std::array<EffectOfFit, 5> kEffects{{
    {"force-bias", "force that the sensor shows at no load", "N", 0, 3, 1.0},
    {"torque-bias", "torque that the sensor shows at no load", "Nm", 3, 3, 1.0},
    {"lever-arm", "way from the declared handle to the point that the torque is about", "m", 6, 3, 0.1},
    {"stiffness", "stiffness between handle and contact", "N/m", 9, 1, 1.0},
    {"rotational-stiffness", "rotational stiffness between handle and contact", "Nm/rad", 10, 1, 1.0},
}};
constexpr std::size_t kFewestSamples = 400;
constexpr int kBlocks = 40;
constexpr double kDetermined = 0.3;  // of the prior's width

Coupling scaled(const Coupling& declared, const Values& v) {
  return {declared.stiffness_N_per_m * std::exp(v[9]), declared.rotational_stiffness_Nm_per_rad * std::exp(v[10])};
}

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

// In the sensor's axes: what it shows of this wrench with these biases and lever arm.
Vec6 shown(const Wrench& wrench_W, const Quat& q_WT, const Values& v) {
  const Quat to_T = q_WT.conjugate();
  const Vec3 f = to_T * wrench_W.f_N;
  Vec6 out;
  out << f + v.segment<3>(0), to_T * wrench_W.torque_Nm - v.segment<3>(6).cross(f) + v.segment<3>(3);
  return out;
}

Vec6 measured_T(const recording::Recording& measured, std::size_t i) {
  const Quat to_T = measured.motion.q_WS[i].conjugate();
  Vec6 out;
  out << to_T * measured.f_W_N[i], to_T * measured.torque_W_Nm[i];
  return out;
}

Mat3 cross_matrix(const Vec3& a) {
  Mat3 m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

struct Blocks {
  double first_s, length_s;
  [[nodiscard]] int of(double t_s) const { return std::min(static_cast<int>((t_s - first_s) / length_s), kBlocks - 1); }
  // Every other one is for the fit.
  [[nodiscard]] static bool fitted(int block) { return block % 2 == 0; }
};

// One linearisation: the sums of the normal equations, and the gradient of each block.
struct Step {
  Square hessian = Square::Zero();
  Values gradient = Values::Zero();
  Eigen::MatrixXd of_blocks = Eigen::MatrixXd::Zero(kBlocks / 2, kParameters);
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
    double force = 0.0;
    double torque = 0.0;
    for (std::size_t i = 0; i < measured.size(); ++i) {
      force = std::max(force, measured.f_W_N[i].norm());
      torque = std::max(torque, measured.torque_W_Nm[i].norm());
    }
    for (const EffectOfFit& effect : kEffects) {
      const double scale = effect.first == 0 ? force : effect.first == 3 ? torque : 1.0;
      width_.segment(effect.first, effect.count).setConstant(effect.plausible * scale);
    }
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
    free_.fill(false);
    for (std::size_t e = 0; e < kEffects.size(); ++e) {
      for (int k = 0; k < kEffects[e].count; ++k) free_[at(kEffects[e].first + k)] = fit.effects[e].named;
    }
    solve();
    fit.coupling = scaled(declared_, values_);
    const std::vector<Wrench> fitted = rendered(measured_, make_, fit.coupling);
    fit.before = errors(fit.declared_W, Values::Zero());
    fit.after = errors(fitted, values_);
    for (std::size_t i = 0; i < fitted.size(); ++i) {
      const Vec6 s = shown(fitted[i], measured_.motion.q_WS[i], values_);
      fit.fitted_W.push_back({measured_.motion.q_WS[i] * s.head<3>(), measured_.motion.q_WS[i] * s.tail<3>()});
    }
    return fit;
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  // The values at which the sum of squares is least, and the covariance there.
  Square solve() {
    values_.setZero();
    Noise noise{1.0, 1.0};
    constexpr int kMostRounds = 15;
    constexpr double kLongest = 0.5;  // of a stiffness' logarithm in one round
    constexpr double kStill = 1e-5;   // of the priors' widths
    Step step;
    for (int round = 0; round < kMostRounds; ++round) {
      step = linearised(noise);
      noise = {std::max(step.spread.force_N, 1e-9), std::max(step.spread.torque_Nm, 1e-12)};
      if (round == 0) continue;  // the first tells the weights
      const Values by = solved(step);
      const double longest = by.tail<2>().cwiseAbs().maxCoeff();
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
  // stiffnesses are searched once more by steps along each that halve (Hooke and Jeeves 1961), the linear values solved
  // exactly for each pair (variable projection: Golub and Pereyra 1973).
  void polish(const Noise& noise) {
    constexpr double kFirst = 0.08, kLast = 1e-4;  // of a logarithm
    values_ = with_linear(values_, noise);
    double best = loss(values_, noise);
    for (double width = kFirst; width > kLast; width *= 0.5) {
      for (int k = kLinear; k < kParameters; ++k) {
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

  // What is shown for one unit more of each bias and of the lever arm r: the torque is that about r, so that it changes
  // by -r x f = f x r. A column that is not free is nought.
  LinearColumns linear_columns(const Wrench& wrench_W, const Quat& q_WT) const {
    LinearColumns j = LinearColumns::Zero();
    j.block<3, 3>(0, 0).setIdentity();
    j.block<3, 3>(3, 3).setIdentity();
    j.block<3, 3>(3, 6) = cross_matrix(q_WT.conjugate() * wrench_W.f_N);
    for (int k = 0; k < kLinear; ++k) {
      if (!free_[at(k)]) j.col(k).setZero();
    }
    return j;
  }

  // With the biases and the lever arm that fit best at these stiffnesses.
  Values with_linear(Values values, const Noise& noise) const {
    const std::vector<Wrench> wrenches = rendered(measured_, make_, scaled(declared_, values));
    Eigen::Matrix<double, kLinear, kLinear> hessian = Eigen::Matrix<double, kLinear, kLinear>::Zero();
    Eigen::Matrix<double, kLinear, 1> gradient = Eigen::Matrix<double, kLinear, 1>::Zero();
    const Vec6 weight = noise.weight();
    for (std::size_t i = 0; i < wrenches.size(); ++i) {
      if (!Blocks::fitted(blocks_.of(measured_.motion.t_s[i]))) continue;
      const Quat& q = measured_.motion.q_WS[i];
      const LinearColumns j = weight.asDiagonal() * linear_columns(wrenches[i], q);
      const Vec6 left = measured_T(measured_, i) - shown(wrenches[i], q, Values::Zero());
      hessian.noalias() += j.transpose() * j;
      gradient.noalias() += j.transpose() * weight.cwiseProduct(left);
    }
    for (int k = 0; k < kLinear; ++k) hessian(k, k) += free_[at(k)] ? 1.0 / (width_[k] * width_[k]) : 1.0;
    values.head<kLinear>() = hessian.ldlt().solve(gradient);
    return values;
  }

  // What is minimised, at these weights.
  double loss(const Values& values, const Noise& noise) const {
    const std::vector<Wrench> wrenches = rendered(measured_, make_, scaled(declared_, values));
    double sum = 0.0;
    for (std::size_t i = 0; i < wrenches.size(); ++i) {
      if (!Blocks::fitted(blocks_.of(measured_.motion.t_s[i]))) continue;
      const Vec6 left = measured_T(measured_, i) - shown(wrenches[i], measured_.motion.q_WS[i], values);
      sum += left.head<3>().squaredNorm() / (noise.force_N * noise.force_N) +
             left.tail<3>().squaredNorm() / (noise.torque_Nm * noise.torque_Nm);
    }
    return sum + values.cwiseQuotient(width_).squaredNorm();
  }

  Values solved(const Step& step) const { return step.hessian.ldlt().solve(step.gradient); }

  // The normal equations of Gauss and Newton's method about values_: residual r = measured - shown(v), J = d shown /
  // dv,
  //   (sum J' W J + P) dv = sum J' W r - P v,
  // W the weights squared, P the prior's precision. The stiffnesses' columns are differences
  // forward, of 1 % of the stiffness.
  Step linearised(const Noise& noise) {
    constexpr double kDifference = 0.01;
    const std::vector<Wrench> here = rendered(measured_, make_, scaled(declared_, values_));
    std::array<std::vector<Wrench>, 2> beside;
    for (int k = 0; k < 2; ++k) {
      if (!free_[at(kLinear + k)]) continue;
      Values v = values_;
      v[kLinear + k] += kDifference;
      beside[at(k)] = rendered(measured_, make_, scaled(declared_, v));
    }
    Step step;
    const Vec6 weight = noise.weight();
    std::size_t count = 0;
    for (std::size_t i = 0; i < here.size(); ++i) {
      const int block = blocks_.of(measured_.motion.t_s[i]);
      if (!Blocks::fitted(block)) continue;
      const Quat& q = measured_.motion.q_WS[i];
      const Vec6 now = shown(here[i], q, values_);
      const Vec6 left = measured_T(measured_, i) - now;
      step.spread.force_N += left.head<3>().squaredNorm();
      step.spread.torque_Nm += left.tail<3>().squaredNorm();
      ++count;
      Jacobian j = Jacobian::Zero();
      j.leftCols<kLinear>() = linear_columns(here[i], q);
      for (int k = 0; k < 2; ++k) {
        if (free_[at(kLinear + k)]) j.col(kLinear + k) = (shown(beside[at(k)][i], q, values_) - now) / kDifference;
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
    for (int k = 0; k < kParameters; ++k) {
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
    Values grow;
    for (int k = 0; k < kParameters; ++k) grow[k] = std::sqrt(std::max(1.0, inverse(k, k) / robust(k, k)));
    return grow.asDiagonal() * robust * grow.asDiagonal();
  }

  void judge(const Square& covariance, ToolFit& fit) const {
    constexpr double kAlpha = 0.05;
    const double blocks = kBlocks / 2.0;
    const Coupling at_fit = scaled(declared_, values_);
    for (const EffectOfFit& known : kEffects) {
      ToolEffect effect{known.name, known.what, known.unit, {}, {}, {}, 1.0, false};
      const Eigen::VectorXd values = values_.segment(known.first, known.count);
      const Eigen::MatrixXd own = covariance.block(known.first, known.first, known.count, known.count);
      const double squared = values.dot(own.ldlt().solve(values));
      const double f = squared * (blocks - known.count) / (known.count * (blocks - 1.0));
      effect.p = std::isfinite(f) ? stats::f_tail(f, known.count, blocks - known.count) : 1.0;
      bool any = false;
      for (int k = 0; k < known.count; ++k) {
        const double error = std::sqrt(own(k, k));
        const double of_stiffness = known.first == 9    ? at_fit.stiffness_N_per_m
                                    : known.first == 10 ? at_fit.rotational_stiffness_Nm_per_rad
                                                        : 0.0;
        effect.values.push_back(known.first >= 9 ? of_stiffness : values[k]);
        effect.standard_errors.push_back(known.first >= 9 ? of_stiffness * error : error);
        effect.determined.push_back(error < kDetermined * width_[known.first + k]);
        any = any || effect.determined.back();
      }
      effect.named = any && effect.p < kAlpha / double(kEffects.size());
      fit.effects.push_back(std::move(effect));
    }
  }

  ToolErrors errors(const std::vector<Wrench>& wrenches, const Values& values) const {
    ToolErrors sum;
    std::size_t count = 0;
    for (std::size_t i = 0; i < wrenches.size(); ++i) {
      if (Blocks::fitted(blocks_.of(measured_.motion.t_s[i]))) continue;
      const Vec6 left = measured_T(measured_, i) - shown(wrenches[i], measured_.motion.q_WS[i], values);
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
  Values width_ = Values::Ones();
  Values values_ = Values::Zero();
  std::array<bool, kParameters> free_ = [] {
    std::array<bool, kParameters> all{};
    all.fill(true);
    return all;
  }();
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
