#include "servo/device_fit.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "harness/base/error.h"
#include "harness/base/least_squares.h"
#include "servo/axis_motion.h"

namespace touchstone::servo {
namespace {

constexpr std::size_t fewest = 50, most = 200'000;
constexpr double uneven = 0.1;  // of the period
constexpr double most_late_periods = 50.0;
constexpr double normal95 = 1.96;

// The recording along one line.
struct Line {
  std::vector<double> x_m, f_N;
  double period_s = 0.0;
  double moved_m = 0.0, force_N = 0.0;  // root mean squares
};

// What is sought: the logarithm of the mass, then viscous friction, Coulomb friction, latency, first position and
// velocity, each as a share of a scale of the recording.
enum : int { log_mass_index, viscous_index, dry_index, late_index, start_index, speed_index, unknown_count };
using Unknowns = Eigen::Matrix<double, unknown_count, 1>;

Line line_of(const recording::Recording& recording) {
  const auto& p = recording.motion.p_W_m;
  const auto refuse = [&](const std::string& why) { throw BadData(recording.source + ": " + why); };
  if (recording.f_W_N.empty()) refuse("no force: the commanded force on the device was expected (fx_N, fy_N, fz_N)");
  if (p.size() < fewest || p.size() > most)
    refuse(fmt::format("{} samples: {} to {} were expected", p.size(), fewest, most));
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
    if (std::abs(steps_s[i] - line.period_s) > uneven * line.period_s) {
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

AxisParameters device_of(const Scales& scales, const Unknowns& u) {
  AxisParameters own;
  own.mass_kg = std::exp(u[log_mass_index]);
  own.damping_N_s_per_m = u[viscous_index] * scales.damping_N_s_per_m;
  own.friction_N = u[dry_index] * scales.friction_N;
  return own;
}

// The motion that the recording's forces give a device: `sample` is called at each sample, before a new force acts, and
// `acting` as soon as a force acts, with the index and the share of the period for which it does.
template <class Sample, class Acting>
void move(const Line& line, const Scales& scales, const Unknowns& u, const Sample& sample, const Acting& acting) {
  const auto late = static_cast<std::int64_t>(
      std::llround(u[late_index] * scales.latency_s / line.period_s * static_cast<double>(period_quanta)));
  const std::int64_t part = late % period_quanta;
  const AxisTransitions transitions(device_of(scales, u), line.period_s, {part, period_quanta - part});
  AxisMotion axis(transitions);
  axis.start_at(u[start_index] * scales.start_m, u[speed_index] * scales.speed_m_per_s);
  const std::int64_t whole = late / period_quanta;
  const auto commanded = [&](std::int64_t k) {
    return line.f_N[static_cast<std::size_t>(std::max<std::int64_t>(k, 0))];
  };
  for (std::size_t k = 0; k < line.x_m.size(); ++k) {
    sample(k, axis);
    const std::int64_t now = static_cast<std::int64_t>(k) - whole;
    const double share = static_cast<double>(part) / static_cast<double>(period_quanta);
    if (part > 0) {
      axis.command(commanded(now - 1));
      acting(k, axis, share);
      axis.advance(part);
    }
    axis.command(commanded(now));
    acting(k, axis, 1.0 - share);
    axis.advance(period_quanta - part);
  }
}

// What the unknowns predict less what was recorded.
Eigen::VectorXd residuals(const Line& line, const Scales& scales, const Unknowns& u) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(line.x_m.size()));
  move(
      line, scales, u,
      [&](std::size_t k, const AxisMotion& axis) {
        out[static_cast<Eigen::Index>(k)] = axis.deviation_m() - line.x_m[k];
      },
      [](std::size_t, const AxisMotion&, double) {});
  return out;
}

// Mean squares of inertia, viscous friction, dry friction and latency, in N^2: the four parts of the commanded force.
std::array<double, 4> parts_of(const Line& line, const Scales& scales, const Unknowns& u) {
  const AxisParameters own = device_of(scales, u);
  std::array<double, 4> sums{};
  move(
      line, scales, u, [](std::size_t, const AxisMotion&) {},
      [&](std::size_t k, const AxisMotion& axis, double share) {
        const double inertia_N = own.mass_kg * axis.acceleration_m_per_s2();
        const double viscous_N = own.damping_N_s_per_m * axis.velocity_m_per_s();
        const double dry_N = axis.actuator_N() - inertia_N - viscous_N;
        const std::array parts_N{inertia_N, viscous_N, dry_N, line.f_N[k] - axis.actuator_N()};
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += share * parts_N[i] * parts_N[i];
      });
  return sums;
}

// The encoder's step along the axis of the object's frame that moves most: the smallest change, if all others are
// multiples of it.
double resolution_of(const recording::Recording& recording) {
  constexpr double of_a_step = 0.02;
  const auto& p = recording.motion.p_W_m;
  Box3 box;
  for (const Vec3& at : p) box.extend(at);
  int axis = 0;
  box.sizes().maxCoeff(&axis);
  std::vector<double> changes_m;
  for (std::size_t i = 1; i < p.size(); ++i) {
    const double change_m = std::abs(p[i][axis] - p[i - 1][axis]);
    if (change_m > 0.0) changes_m.push_back(change_m);
  }
  if (changes_m.empty()) return 0.0;
  const double step_m = *std::ranges::min_element(changes_m);
  const bool all = std::ranges::all_of(changes_m, [&](double change_m) {
    const double steps = change_m / step_m;
    return std::abs(steps - std::round(steps)) < of_a_step;
  });
  return all ? step_m : 0.0;
}

Unknowns within_bounds(Unknowns u) {
  for (const int i : {viscous_index, dry_index, late_index}) u[i] = std::max(u[i], 0.0);
  u[late_index] = std::min(u[late_index], most_late_periods);
  return u;
}

Eigen::MatrixXd slopes(const Line& line, const Scales& scales, const Unknowns& u) {
  constexpr double difference_step = 1e-5;
  Eigen::MatrixXd out(static_cast<Eigen::Index>(line.x_m.size()), static_cast<Eigen::Index>(unknown_count));
  for (int i = 0; i < unknown_count; ++i) {
    Unknowns above = u, below = u;
    above[i] += difference_step;
    below = within_bounds(below - difference_step * Unknowns::Unit(i));
    out.col(i) = (residuals(line, scales, above) - residuals(line, scales, below)) / (above[i] - below[i]);
  }
  return out;
}

// Some masses of five decades, with the friction and latency that suit each best: the local minima are far apart.
std::vector<Unknowns> beginnings(const Line& line, const Scales& scales) {
  constexpr std::size_t kept = 5;
  std::vector<std::pair<double, Unknowns>> of_masses;
  const std::size_t few = std::min<std::size_t>(5, line.x_m.size() - 1);
  for (double mass_kg = 1e-3; mass_kg < 100.0; mass_kg *= 1.25) {
    std::pair<double, Unknowns> best{std::numeric_limits<double>::infinity(), Unknowns::Zero()};
    for (const double viscous : {0.02, 0.2}) {
      for (const double late : {0.0, 2.5}) {
        Unknowns u = Unknowns::Zero();
        u[log_mass_index] = std::log(mass_kg);
        u[viscous_index] = viscous;
        u[late_index] = late;
        u[start_index] = line.x_m.front() / scales.start_m;
        u[speed_index] =
            (line.x_m[few] - line.x_m[0]) / (static_cast<double>(few) * line.period_s) / scales.speed_m_per_s;
        const double sum = residuals(line, scales, u).squaredNorm();
        if (sum < best.first) best = {sum, u};
      }
    }
    if (std::isfinite(best.first)) of_masses.push_back(best);
  }
  std::ranges::sort(of_masses, {}, &std::pair<double, Unknowns>::first);
  std::vector<Unknowns> out;
  for (std::size_t i = 0; i < std::min(kept, of_masses.size()); ++i) out.push_back(of_masses[i].second);
  return out;
}

std::pair<double, Unknowns> fit_from(const Line& line, const Scales& scales, Unknowns u) {
  double sum = residuals(line, scales, u).squaredNorm();
  double damping = 1e-3;
  constexpr int most_steps = 60;
  constexpr double smallest = 1e-10;  // relative gain that ends it
  for (int step = 0; step < most_steps; ++step) {
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
    if (gained < smallest) break;
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

void explain(DeviceFit& out, const recording::Recording& recording, const std::array<double, 4>& parts) {
  constexpr double something_else = 0.1;
  out.resolution_m = resolution_of(recording);
  const double steps_m2 = std::pow(out.resolution_m, 2) / 12.0;
  out.unexplained = std::sqrt(std::max(0.0, std::pow(out.residual_m, 2) - steps_m2)) / out.moved_m;
  const std::array figures{&out.mass_kg, &out.damping_N_s_per_m, &out.friction_N, &out.latency_s};
  const std::array<std::string_view, 4> names{"inertia", "viscous friction", "dry friction", "latency"};
  const double whole = std::reduce(parts.begin(), parts.end());
  for (std::size_t i = 0; i < figures.size(); ++i) {
    if (out.unexplained > something_else) figures[i]->determined = false;
    DeviceEffect effect{names[i], Named::cannot_tell, whole > 0.0 ? parts[i] / whole : 0.0};
    if (figures[i]->determined) effect.named = figures[i]->negligible ? Named::negligible : Named::present;
    out.effects.push_back(effect);
  }
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
      LeastSquares(slope.transpose() * slope).solve(Eigen::MatrixXd::Identity(unknown_count, unknown_count));

  DeviceFit out;
  out.period_s = line.period_s;
  out.residual_m = std::sqrt(left.squaredNorm() / samples);
  out.moved_m = line.moved_m;
  out.samples = line.x_m.size();
  constexpr double negligible_share = 0.01;
  const auto figure = [&](int i, double scale) {
    FittedFigure own;
    own.value = u[i] * scale;
    own.error95 = normal95 * std::sqrt(std::max(0.0, variance * inverse(i, i))) * scale;
    own.negligible = own.value + own.error95 < negligible_share * scale;
    own.determined = own.negligible || own.error95 < own.value;
    return own;
  };
  out.mass_kg = figure(log_mass_index, 1.0);
  out.mass_kg.value = std::exp(u[log_mass_index]);
  out.mass_kg.error95 *= out.mass_kg.value;
  out.mass_kg.negligible = false;
  out.mass_kg.determined = out.mass_kg.error95 < 0.5 * out.mass_kg.value;
  out.damping_N_s_per_m = figure(viscous_index, scales.damping_N_s_per_m);
  out.friction_N = figure(dry_index, scales.friction_N);
  out.latency_s = figure(late_index, scales.latency_s);
  explain(out, recording, parts_of(line, scales, u));
  return out;
}

}  // namespace touchstone::servo
