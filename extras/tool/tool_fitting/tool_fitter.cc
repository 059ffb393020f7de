#include "tool_fitting/tool_fitter.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "harness/stats/distributions.h"
#include "harness/stats/sandwich.h"
#include "harness/tool/tool_path.h"

namespace touchstone::tool_fitting {

using tool::Coupling;

namespace {

constexpr double determined_below = 0.3;  // of the prior's width

Eigen::Matrix<double, 6, 1> weight_of(const ToolErrors& noise) {
  Eigen::Matrix<double, 6, 1> out;
  out << Vec3::Constant(1.0 / noise.force_N), Vec3::Constant(1.0 / noise.torque_Nm);
  return out;
}

ToolErrors not_nought(const ToolErrors& noise) {
  return {std::max(noise.force_N, 1e-9), std::max(noise.torque_Nm, 1e-12)};
}

}  // namespace

struct ToolFitter::Step {
  explicit Step(int parameters)
      : hessian(ToolSquare::Zero(parameters, parameters)),
        gradient(ToolValues::Zero(parameters)),
        of_blocks(Eigen::MatrixXd::Zero(jackknife_blocks / 2, parameters)) {}

  ToolSquare hessian;
  ToolValues gradient;
  Eigen::MatrixXd of_blocks;
  ToolErrors spread;  // RMS of the residual, an axis
};

ToolFitter::ToolFitter(const recording::Recording& measured, const MakeTool& make, const Coupling& declared,
                       const ToolFitter* same_motion)
    : measured_(measured), make_(make), declared_(declared) {
  if (same_motion != nullptr) renderings_ = same_motion->renderings_;
  ToolRecordingScales scales;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    scales.force_N = std::max(scales.force_N, measured.f_W_N[i].norm());
    scales.torque_Nm = std::max(scales.torque_Nm, measured.torque_W_Nm[i].norm());
    const Quat to_T = measured.motion.q_WS[i].conjugate();
    measured_T_.emplace_back();
    measured_T_.back() << to_T * measured.f_W_N[i], to_T * measured.torque_W_Nm[i];
  }
  for (const ToolEffectTraits& effect : tool_effects()) {
    placed_.push_back({&effect, all_});
    all_ += effect.count;
    if (effect.columns != nullptr) linear_ = all_;
  }
  width_.setOnes(all_);
  for (const auto& [effect, first] : placed_) {
    for (int k = 0; k < effect->count; ++k) width_[first + k] = effect->plausible(scales, k);
  }
  values_.setZero(all_);
}

int ToolFitter::block_of(std::size_t i) const {
  const auto& t_s = measured_.motion.t_s;
  return std::min(static_cast<int>((t_s[i] - t_s.front()) / (t_s.back() - t_s.front()) * jackknife_blocks),
                  jackknife_blocks - 1);
}

ToolFitter::Part ToolFitter::part_of(int block) {
  if (block % 2 == 0) return Part::fitted;
  return block % 4 == 1 ? Part::choosing : Part::reporting;
}

std::size_t ToolFitter::samples(Part part) const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < measured_.size(); ++i) count += part_of(block_of(i)) == part ? 1U : 0U;
  return count;
}

const std::vector<Wrench>& ToolFitter::rendered(const Coupling& coupling) {
  const auto same = [&](const auto& kept) {
    return kept.first.stiffness_N_per_m == coupling.stiffness_N_per_m &&
           kept.first.rotational_stiffness_Nm_per_rad == coupling.rotational_stiffness_Nm_per_rad;
  };
  const auto kept = std::ranges::find_if(renderings_, same);
  if (kept != renderings_.end()) return kept->second;
  // Searches come back to the declared coupling (which stays) and to the last few.
  constexpr std::size_t most_kept = 8;
  if (renderings_.size() == most_kept) renderings_.erase(renderings_.begin() + 1);
  const auto renderer = make_(coupling);
  renderer->reset();
  std::vector<Wrench> wrenches;
  wrenches.reserve(measured_.size());
  for (std::size_t i = 0; i < measured_.size(); ++i) {
    const tool::ToolResult result = tool::step_or_throw(
        *renderer, {measured_.motion.t_s[i], {measured_.motion.p_W_m[i], measured_.motion.q_WS[i]}});
    wrenches.push_back({result.f_W_N, result.torque_W_Nm});
  }
  renderings_.emplace_back(coupling, std::move(wrenches));
  return renderings_.back().second;
}

Coupling ToolFitter::coupling_of(const ToolValues& values) const {
  Coupling coupling = declared_;
  for (const auto& [effect, first] : placed_) {
    if (effect->change != nullptr && values[first] != 0.0) effect->change(values[first], coupling);
  }
  return coupling;
}

Coupling ToolFitter::coupling(const ToolSolution& solution) const { return coupling_of(solution.values); }

// What is shown for one unit more of each parameter that it is linear in.
ToolFitter::Jacobian ToolFitter::linear_columns(const Wrench& wrench_W, std::size_t i) const {
  const Quat& q_WT = measured_.motion.q_WS[i];
  const Wrench w_T = rotated(q_WT.conjugate(), wrench_W);
  const Vec3 gravity_T = gravity_in_tool(q_WT);
  Jacobian j = Jacobian::Zero(6, linear_);
  for (const auto& [effect, first] : placed_) {
    if (effect->columns != nullptr) j.middleCols(first, effect->count) = effect->columns(w_T, gravity_T);
  }
  return j;
}

// In the sensor's axes: what it shows of this wrench with these values.
ToolFitter::Vec6 ToolFitter::shown(const Wrench& wrench_W, std::size_t i, const ToolValues& values) const {
  const Wrench w_T = rotated(measured_.motion.q_WS[i].conjugate(), wrench_W);
  Vec6 out;
  out << w_T.f_N, w_T.torque_Nm;
  return out + linear_columns(wrench_W, i) * values.head(linear_);
}

// Of the parameters that are free; the column of one that is not is nought.
ToolFitter::Jacobian ToolFitter::free_columns(const Wrench& wrench_W, std::size_t i) const {
  Jacobian j = linear_columns(wrench_W, i);
  for (int k = 0; k < linear_; ++k) {
    if (!free_[at(k)]) j.col(k).setZero();
  }
  return j;
}

bool ToolFitter::any_stiffness_free() const {
  return std::ranges::any_of(free_.begin() + linear_, free_.end(), [](bool free) { return free; });
}

// The values at which the sum of squares is least, and the covariance there.
ToolSolution ToolFitter::solve(const ToolEffectSet& effects, Effort effort, const ToolSolution* start) {
  free_.assign(at(all_), false);
  for (std::size_t e = 0; e < placed_.size(); ++e) {
    for (int k = 0; k < placed_[e].effect->count; ++k) free_[at(placed_[e].first + k)] = effects[e];
  }
  values_.setZero(all_);
  for (int k = 0; start != nullptr && k < all_; ++k) {
    if (free_[at(k)]) values_[k] = start->values[k];
  }
  ToolErrors noise{1.0, 1.0};
  const int most_rounds = effort == Effort::thorough ? 15 : 6;
  constexpr double longest_step = 0.5;  // of a stiffness' logarithm in one round
  constexpr double still = 1e-5;        // of the priors' widths
  for (int round = 0; round < most_rounds; ++round) {
    const Step step = linearised(noise);
    noise = not_nought(step.spread);
    if (round == 0) continue;  // the first tells the weights
    const ToolValues by = step.hessian.ldlt().solve(step.gradient);
    const double longest = by.tail(all_ - linear_).cwiseAbs().maxCoeff();
    // A contact that jumps makes the slope wrong: a shorter step then.
    const double here = loss(values_, noise);
    double share = std::min(1.0, longest_step / std::max(longest, longest_step));
    while (share > 0.05 && !(loss(values_ + share * by, noise) < here)) share *= 0.5;
    if (share <= 0.05) break;
    values_ += share * by;
    if ((share * by.cwiseQuotient(width_)).cwiseAbs().maxCoeff() < still) break;
  }
  if (effort == Effort::thorough) {
    constexpr double first_step = 0.08;  // of a logarithm
    polish(noise, first_step);
  }
  const Step last = linearised(noise);
  return {effects, values_, covariance(last), not_nought(last.spread)};
}

// Where a tool jams or a contact changes, slopes mislead and Gauss and Newton's method stops early: the two
// stiffnesses are searched once more by steps along each that halve (Hooke and Jeeves 1961), the linear values
// solved exactly for each pair (variable projection: Golub and Pereyra 1973).
void ToolFitter::polish(const ToolErrors& noise, double first) {
  constexpr double last_step = 1e-4;  // of a logarithm
  values_ = with_linear(values_, noise);
  if (!any_stiffness_free()) return;
  double best = loss(values_, noise);
  for (double width = first; width > last_step; width *= 0.5) {
    for (int k = linear_; k < all_; ++k) {
      if (!free_[at(k)]) continue;
      for (const double by : {width, -width}) {
        ToolValues tried = values_;
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

// With the linear values that fit best at these stiffnesses.
ToolValues ToolFitter::with_linear(ToolValues values, const ToolErrors& noise) {
  const std::vector<Wrench>& wrenches = rendered(coupling_of(values));
  ToolSquare hessian = ToolSquare::Zero(linear_, linear_);
  ToolValues gradient = ToolValues::Zero(linear_);
  const Vec6 weight = weight_of(noise);
  const ToolValues none = ToolValues::Zero(all_);
  for (std::size_t i = 0; i < wrenches.size(); ++i) {
    if (!fitted(i)) continue;
    const Jacobian j = weight.asDiagonal() * free_columns(wrenches[i], i);
    const Vec6 left = measured_T_[i] - shown(wrenches[i], i, none);
    hessian.noalias() += j.transpose() * j;
    gradient.noalias() += j.transpose() * weight.cwiseProduct(left);
  }
  for (int k = 0; k < linear_; ++k) hessian(k, k) += free_[at(k)] ? 1.0 / (width_[k] * width_[k]) : 1.0;
  values.head(linear_) = hessian.ldlt().solve(gradient);
  return values;
}

// What is minimised, at these weights.
double ToolFitter::loss(const ToolValues& values, const ToolErrors& noise) {
  const std::vector<Wrench>& wrenches = rendered(coupling_of(values));
  const Vec6 weight = weight_of(noise);
  double sum = 0.0;
  for (std::size_t i = 0; i < wrenches.size(); ++i) {
    if (fitted(i)) sum += weight.cwiseProduct(measured_T_[i] - shown(wrenches[i], i, values)).squaredNorm();
  }
  return sum + values.cwiseQuotient(width_).squaredNorm();
}

// The normal equations of Gauss and Newton's method about values_: residual r = measured - shown(v), J = d shown / dv,
//   (sum J' W J + P) dv = sum J' W r - P v,
// W the weights squared, P the prior's precision. The stiffnesses' columns are differences forward, of 1 % of the
// stiffness.
ToolFitter::Step ToolFitter::linearised(const ToolErrors& noise) {
  constexpr double difference = 0.01;
  std::vector<std::vector<Wrench>> beside(at(all_));
  for (int k = linear_; k < all_; ++k) {
    if (!free_[at(k)]) continue;
    ToolValues v = values_;
    v[k] += difference;
    beside[at(k)] = rendered(coupling_of(v));
  }
  const std::vector<Wrench>& here = rendered(coupling_of(values_));
  Step step(all_);
  const Vec6 weight = weight_of(noise);
  std::size_t count = 0;
  for (std::size_t i = 0; i < here.size(); ++i) {
    if (!fitted(i)) continue;
    const Vec6 now = shown(here[i], i, values_);
    const Vec6 left = measured_T_[i] - now;
    step.spread.force_N += left.head<3>().squaredNorm();
    step.spread.torque_Nm += left.tail<3>().squaredNorm();
    ++count;
    Jacobian j = Jacobian::Zero(6, all_);
    j.leftCols(linear_) = free_columns(here[i], i);
    for (int k = linear_; k < all_; ++k) {
      if (free_[at(k)]) j.col(k) = (shown(beside[at(k)][i], i, values_) - now) / difference;
    }
    j = weight.asDiagonal() * j;
    const ToolValues g = j.transpose() * weight.cwiseProduct(left);
    step.hessian.noalias() += j.transpose() * j;
    step.gradient += g;
    step.of_blocks.row(block_of(i) / 2) += g.transpose();
  }
  step.spread.force_N = std::sqrt(step.spread.force_N / (3.0 * double(count)));
  step.spread.torque_Nm = std::sqrt(step.spread.torque_Nm / (3.0 * double(count)));
  // The prior; a value that is not free is held at nought by it alone.
  for (int k = 0; k < all_; ++k) {
    const double tight = free_[at(k)] ? 1.0 / (width_[k] * width_[k]) : 1.0;
    step.hessian(k, k) += tight;
    step.gradient[k] -= tight * values_[k];
  }
  return step;
}

// The larger of the sandwich and of what independent samples would have, value by value.
ToolSquare ToolFitter::covariance(const Step& step) const {
  const ToolSquare inverse = step.hessian.inverse();
  const double blocks = jackknife_blocks / 2.0;
  const Eigen::RowVectorXd middle = step.of_blocks.colwise().mean();
  const ToolSquare robust =
      stats::sandwich_covariance(inverse, step.of_blocks.rowwise() - middle) * (blocks / (blocks - 1.0));
  ToolValues grow = ToolValues::Ones(all_);
  for (int k = 0; k < all_; ++k) {
    if (free_[at(k)]) grow[k] = std::sqrt(std::max(1.0, inverse(k, k) / robust(k, k)));
  }
  return grow.asDiagonal() * robust * grow.asDiagonal();
}

double ToolFitter::p_of(const ToolSolution& solution, std::size_t e) const {
  const auto& [effect, first] = placed_[e];
  const double blocks = jackknife_blocks / 2.0;
  const int count = effect->count;
  const Eigen::VectorXd values = solution.values.segment(first, count);
  const Eigen::MatrixXd own = solution.covariance.block(first, first, count, count);
  const double f = values.dot(own.ldlt().solve(values)) * (blocks - count) / (count * (blocks - 1.0));
  return std::isfinite(f) ? stats::f_tail(f, count, blocks - count) : 1.0;
}

std::vector<bool> ToolFitter::determined(const ToolSolution& solution, std::size_t e) const {
  const auto& [effect, first] = placed_[e];
  std::vector<bool> out;
  for (int k = first; k < first + effect->count; ++k)
    out.push_back(std::sqrt(solution.covariance(k, k)) < determined_below * width_[k]);
  return out;
}

ToolFitter::Reported ToolFitter::reported(const ToolSolution& solution, std::size_t e) const {
  const auto& [effect, first] = placed_[e];
  Reported out;
  for (int k = first; k < first + effect->count; ++k) {
    const double error = std::sqrt(solution.covariance(k, k));
    const double of_coupling = effect->value != nullptr ? effect->value(coupling(solution)) : 0.0;
    out.values.push_back(effect->value != nullptr ? of_coupling : solution.values[k]);
    out.standard_errors.push_back(effect->value != nullptr ? of_coupling * error : error);
  }
  return out;
}

std::vector<Wrench> ToolFitter::shown_W(const ToolSolution& solution) {
  const std::vector<Wrench>& wrenches = rendered(coupling(solution));
  std::vector<Wrench> out;
  for (std::size_t i = 0; i < wrenches.size(); ++i) {
    const Vec6 s = shown(wrenches[i], i, solution.values);
    out.push_back({measured_.motion.q_WS[i] * s.head<3>(), measured_.motion.q_WS[i] * s.tail<3>()});
  }
  return out;
}

ToolErrors ToolFitter::errors(const ToolSolution& solution, Part part) {
  const std::vector<Wrench>& wrenches = rendered(coupling(solution));
  ToolErrors sum;
  std::size_t count = 0;
  for (std::size_t i = 0; i < wrenches.size(); ++i) {
    if (part_of(block_of(i)) != part) continue;
    const Vec6 left = measured_T_[i] - shown(wrenches[i], i, solution.values);
    sum.force_N += left.head<3>().squaredNorm();
    sum.torque_Nm += left.tail<3>().squaredNorm();
    ++count;
  }
  return {std::sqrt(sum.force_N / double(count)), std::sqrt(sum.torque_Nm / double(count))};
}

std::vector<double> ToolFitter::log_likelihoods(const ToolSolution& solution, Part part) {
  const std::vector<Wrench>& wrenches = rendered(coupling(solution));
  const Vec6 weight = weight_of(solution.noise);
  const double of_noise = weight.array().log().sum() - 3.0 * std::log(2.0 * std::numbers::pi);
  std::vector<double> of_block(jackknife_blocks, 0.0);
  for (std::size_t i = 0; i < wrenches.size(); ++i) {
    const int block = block_of(i);
    if (part_of(block) != part) continue;
    const Vec6 left = measured_T_[i] - shown(wrenches[i], i, solution.values);
    of_block[at(block)] += of_noise - 0.5 * weight.cwiseProduct(left).squaredNorm();
  }
  std::vector<double> out;
  for (int block = 0; block < jackknife_blocks; ++block) {
    if (part_of(block) == part) out.push_back(of_block[at(block)]);
  }
  return out;
}

ToolErrors ToolFitter::sample_noise() const {
  ToolErrors sum;
  if (measured_T_.size() < 3) return sum;
  for (std::size_t i = 1; i + 1 < measured_T_.size(); ++i) {
    const Vec6 second = measured_T_[i + 1] - 2.0 * measured_T_[i] + measured_T_[i - 1];
    sum.force_N += second.head<3>().squaredNorm();
    sum.torque_Nm += second.tail<3>().squaredNorm();
  }
  const double count = 18.0 * double(measured_T_.size() - 2);  // 6 a sample and axis
  return {std::sqrt(sum.force_N / count), std::sqrt(sum.torque_Nm / count)};
}

}  // namespace touchstone::tool_fitting
