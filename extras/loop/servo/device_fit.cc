#include "servo/device_fit.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "harness/base/error.h"
#include "harness/base/least_squares.h"
#include "servo/axis_motion.h"

namespace touchstone::servo {
namespace {

constexpr std::size_t kFewest = 50, kMost = 200'000;
constexpr double kUneven = 0.1;  // of the period
constexpr double kMostLatePeriods = 50.0;
constexpr double kNormal95 = 1.96;

// The recording along one line.
struct Line {
  std::vector<double> x_m, f_N;
  double period_s = 0.0;
  double moved_m = 0.0, force_N = 0.0;  // root mean squares
};

// What is sought: the logarithm of the mass, then viscous friction, Coulomb friction, latency, first position and
// velocity, each as a share of a scale of the recording.
enum : int { kLogMass, kViscous, kDry, kLate, kStart, kSpeed, kUnknowns };
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;

Line line_of(const recording::Recording& recording) {
  const auto& p = recording.motion.p_W_m;
  const auto refuse = [&](const std::string& why) { throw BadData(recording.source + ": " + why); };
  if (recording.f_W_N.empty()) refuse("no force: the commanded force on the device was expected (fx_N, fy_N, fz_N)");
  if (p.size() < kFewest || p.size() > kMost)
    refuse(fmt::format("{} samples: {} to {} were expected", p.size(), kFewest, kMost));
  Vec3 mean = Vec3::Zero();
  for (const Vec3& at : p) mean += at / static_cast<double>(p.size());
  Mat3 spread = Mat3::Zero();
  for (const Vec3& at : p) spread += (at - mean) * (at - mean).transpose() / static_cast<double>(p.size());
  const Vec3 along = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().col(2);

  Line line;
  std::vector<double> steps_s;
  const auto& t_s = recording.motion.t_s;
  for (std::size_t i = 1; i < t_s.size(); ++i) steps_s.push_back(t_s[i] - t_s[i - 1]);
  line.period_s = (t_s.back() - t_s.front()) / static_cast<double>(steps_s.size());
  for (std::size_t i = 0; i < steps_s.size(); ++i) {
    if (std::abs(steps_s[i] - line.period_s) > kUneven * line.period_s) {
      refuse(
          fmt::format("sample {} comes {} s after the one before, the others every {} s: one a period of the servo "
                      "was expected",
                      i + 1, steps_s[i], line.period_s));
    }
  }
  for (std::size_t i = 0; i < p.size(); ++i) {
    line.x_m.push_back((p[i] - mean).dot(along));
    line.f_N.push_back(recording.f_W_N[i].dot(along));
    line.moved_m += std::pow(line.x_m.back(), 2);
    line.force_N += std::pow(line.f_N.back(), 2);
  }
  line.moved_m = std::sqrt(line.moved_m / static_cast<double>(p.size()));
  line.force_N = std::sqrt(line.force_N / static_cast<double>(p.size()));
  if (!(line.moved_m > 0.0)) refuse("the device does not move");
  if (!(line.force_N > 0.0)) refuse("no force is commanded");
  return line;
}

// The scales of the unknowns: a force of the recording's size, at the speed of its motion over some periods.
struct Scales {
  double damping_N_s_per_m, friction_N, latency_s, start_m, speed_m_per_s;
};

Scales scales_of(const Line& line) {
  double speed = 0.0;
  for (std::size_t i = 1; i < line.x_m.size(); ++i) speed += std::pow(line.x_m[i] - line.x_m[i - 1], 2);
  speed = std::sqrt(speed / static_cast<double>(line.x_m.size() - 1)) / line.period_s;
  return {line.force_N / speed, line.force_N, line.period_s, line.moved_m, speed};
}

// What the unknowns predict less what was recorded.
Eigen::VectorXd residuals(const Line& line, const Scales& scales, const Unknowns& u) {
  AxisParameters own;
  own.mass_kg = std::exp(u[kLogMass]);
  own.damping_N_s_per_m = u[kViscous] * scales.damping_N_s_per_m;
  own.friction_N = u[kDry] * scales.friction_N;
  const auto late = static_cast<std::int64_t>(
      std::llround(u[kLate] * scales.latency_s / line.period_s * static_cast<double>(kPeriodQuanta)));
  const std::int64_t part = late % kPeriodQuanta;
  const AxisTransitions transitions(own, line.period_s, {part, kPeriodQuanta - part});
  AxisMotion axis(transitions);
  axis.start_at(u[kStart] * scales.start_m, u[kSpeed] * scales.speed_m_per_s);
  const std::int64_t whole = late / kPeriodQuanta;
  const auto commanded = [&](std::int64_t k) {
    return line.f_N[static_cast<std::size_t>(std::max<std::int64_t>(k, 0))];
  };
  Eigen::VectorXd out(static_cast<Eigen::Index>(line.x_m.size()));
  for (std::size_t k = 0; k < line.x_m.size(); ++k) {
    out[static_cast<Eigen::Index>(k)] = axis.deviation_m() - line.x_m[k];
    const std::int64_t now = static_cast<std::int64_t>(k) - whole;
    axis.command(commanded(now - 1));
    axis.advance(part);
    axis.command(commanded(now));
    axis.advance(kPeriodQuanta - part);
  }
  return out;
}

Unknowns within_bounds(Unknowns u) {
  for (const int i : {kViscous, kDry, kLate}) u[i] = std::max(u[i], 0.0);
  u[kLate] = std::min(u[kLate], kMostLatePeriods);
  return u;
}

Eigen::MatrixXd slopes(const Line& line, const Scales& scales, const Unknowns& u) {
  constexpr double kStep = 1e-5;
  Eigen::MatrixXd out(static_cast<Eigen::Index>(line.x_m.size()), static_cast<Eigen::Index>(kUnknowns));
  for (int i = 0; i < kUnknowns; ++i) {
    Unknowns above = u, below = u;
    above[i] += kStep;
    below = within_bounds(below - kStep * Unknowns::Unit(i));
    out.col(i) = (residuals(line, scales, above) - residuals(line, scales, below)) / (above[i] - below[i]);
  }
  return out;
}

// Some masses of five decades, with the friction and latency that suit each best: the local minima are far apart.
std::vector<Unknowns> beginnings(const Line& line, const Scales& scales) {
  constexpr std::size_t kKept = 5;
  std::vector<std::pair<double, Unknowns>> of_masses;
  const std::size_t few = std::min<std::size_t>(5, line.x_m.size() - 1);
  for (double mass_kg = 1e-3; mass_kg < 100.0; mass_kg *= 1.25) {
    std::pair<double, Unknowns> best{std::numeric_limits<double>::infinity(), Unknowns::Zero()};
    for (const double viscous : {0.02, 0.2}) {
      for (const double late : {0.0, 2.5}) {
        Unknowns u = Unknowns::Zero();
        u[kLogMass] = std::log(mass_kg);
        u[kViscous] = viscous;
        u[kLate] = late;
        u[kStart] = line.x_m.front() / scales.start_m;
        u[kSpeed] = (line.x_m[few] - line.x_m[0]) / (static_cast<double>(few) * line.period_s) / scales.speed_m_per_s;
        const double sum = residuals(line, scales, u).squaredNorm();
        if (sum < best.first) best = {sum, u};
      }
    }
    if (std::isfinite(best.first)) of_masses.push_back(best);
  }
  std::ranges::sort(of_masses, {}, &std::pair<double, Unknowns>::first);
  std::vector<Unknowns> out;
  for (std::size_t i = 0; i < std::min(kKept, of_masses.size()); ++i) out.push_back(of_masses[i].second);
  return out;
}

std::pair<double, Unknowns> fit_from(const Line& line, const Scales& scales, Unknowns u) {
  double sum = residuals(line, scales, u).squaredNorm();
  double damping = 1e-3;
  constexpr int kMostSteps = 60;
  constexpr double kSmallest = 1e-10;  // relative gain that ends it
  for (int step = 0; step < kMostSteps; ++step) {
    const Eigen::VectorXd now = residuals(line, scales, u);
    const Eigen::MatrixXd slope = slopes(line, scales, u);
    Eigen::MatrixXd normal = slope.transpose() * slope;
    const Eigen::VectorXd down = -slope.transpose() * now;
    double gained = 0.0;
    for (; damping < 1e12 && gained <= 0.0; damping *= 4.0) {
      Eigen::MatrixXd damped = normal;
      damped.diagonal() *= 1.0 + damping;
      const Unknowns next = within_bounds(u + solve_symmetric(damped, down));
      const double there = residuals(line, scales, next).squaredNorm();
      if (!(there < sum)) continue;
      gained = 1.0 - there / sum;
      u = next;
      sum = there;
    }
    damping *= 0.02;
    if (gained < kSmallest) break;
  }
  return {sum, u};
}

Unknowns fit(const Line& line, const Scales& scales) {
  std::pair<double, Unknowns> best{std::numeric_limits<double>::infinity(), Unknowns::Zero()};
  for (const Unknowns& u : beginnings(line, scales)) {
    if (auto found = fit_from(line, scales, u); found.first < best.first) best = std::move(found);
  }
  if (!std::isfinite(best.first)) throw BadData("no mass from 1 g to 100 kg moves like the recorded device");
  return best.second;
}

}  // namespace

DeviceFit fit_device(const recording::Recording& recording) {
  const Line line = line_of(recording);
  const Scales scales = scales_of(line);
  const Unknowns u = fit(line, scales);
  const Eigen::VectorXd left = residuals(line, scales, u);
  const Eigen::MatrixXd slope = slopes(line, scales, u);
  const auto samples = static_cast<double>(line.x_m.size());
  // Neighbouring residuals resemble each other: as many count as their correlation leaves (Bartlett 1946).
  double next = 0.0;
  for (Eigen::Index i = 1; i < left.size(); ++i) next += left[i] * left[i - 1];
  const double correlation = left.squaredNorm() > 0.0 ? std::clamp(next / left.squaredNorm(), 0.0, 0.99) : 0.0;
  const double variance = left.squaredNorm() / samples * (1.0 + correlation) / (1.0 - correlation);
  const Eigen::MatrixXd inverse =
      LeastSquares(slope.transpose() * slope).solve(Eigen::MatrixXd::Identity(kUnknowns, kUnknowns));

  DeviceFit out;
  out.period_s = line.period_s;
  out.residual_m = std::sqrt(left.squaredNorm() / samples);
  out.moved_m = line.moved_m;
  out.samples = line.x_m.size();
  // A figure of zero is known if its interval is within a hundredth of the scale: of the force, of its speed, a period.
  constexpr double kNegligible = 0.01;
  const auto figure = [&](int i, double scale) {
    FittedFigure own;
    own.value = u[i] * scale;
    own.error95 = kNormal95 * std::sqrt(std::max(0.0, variance * inverse(i, i))) * scale;
    own.determined = own.error95 < own.value || own.error95 < kNegligible * scale;
    return own;
  };
  out.mass_kg = figure(kLogMass, 1.0);
  out.mass_kg.value = std::exp(u[kLogMass]);
  out.mass_kg.error95 *= out.mass_kg.value;
  out.mass_kg.determined = out.mass_kg.error95 < 0.5 * out.mass_kg.value;
  out.damping_N_s_per_m = figure(kViscous, scales.damping_N_s_per_m);
  out.friction_N = figure(kDry, scales.friction_N);
  out.latency_s = figure(kLate, scales.latency_s);
  return out;
}

}  // namespace touchstone::servo
