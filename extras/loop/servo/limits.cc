#include "servo/limits.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

namespace touchstone::servo {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double largest_N_per_m = 1e7;
constexpr double smallest_N_per_m = 1e-3;

// The plant from the commanded force to the position, with its states x, v and, with a lag, f.
struct Plant {
  MatrixXd a;
  VectorXd b;
};

Plant plant(const AxisParameters& own) {
  const bool lags = own.actuator_time_constant_s > 0.0;
  Plant out{MatrixXd::Zero(lags ? 3 : 2, lags ? 3 : 2), VectorXd::Zero(lags ? 3 : 2)};
  out.a(0, 1) = 1.0;
  out.a(1, 0) = -own.hand_stiffness_N_per_m / own.mass_kg;
  out.a(1, 1) = -(own.damping_N_s_per_m + own.hand_damping_N_s_per_m) / own.mass_kg;
  if (lags) {
    out.a(1, 2) = 1.0 / own.mass_kg;
    out.a(2, 2) = -1.0 / own.actuator_time_constant_s;
    out.b[2] = 1.0 / own.actuator_time_constant_s;
  } else {
    out.b[1] = 1.0 / own.mass_kg;
  }
  return out;
}

// The same loop with mass and period 1, so that the numbers of the matrix are of one size, and the eigenvalues exact.
LoopParameters in_own_units(LoopParameters own) {
  const double damping = own.period_s / own.axis.mass_kg, stiffness = damping * own.period_s;
  own.axis.damping_N_s_per_m *= damping;
  own.axis.hand_damping_N_s_per_m *= damping;
  own.virtual_damping_N_s_per_m *= damping;
  own.axis.hand_stiffness_N_per_m *= stiffness;
  own.axis.actuator_time_constant_s /= own.period_s;
  own.latency_s /= own.period_s;
  own.velocity_cutoff_Hz *= own.period_s;
  own.axis.mass_kg = own.period_s = 1.0;
  return own;
}

// What a time with a constant command does: the state's transition and the command's effect.
struct Held {
  MatrixXd phi;
  VectorXd gamma;
};

Held held(const Plant& plant, double time_s) {
  const Eigen::Index n = plant.b.size();
  MatrixXd block = MatrixXd::Zero(n + 1, n + 1);
  block.topLeftCorner(n, n) = plant.a * time_s;
  block.topRightCorner(n, 1) = plant.b * time_s;
  const MatrixXd whole = block.exp();
  return {whole.topLeftCorner(n, n), whole.topRightCorner(n, 1)};
}

// One period of the closed loop, with mass and period 1. State: the plant's, the last position, the filtered velocity,
// and past commands.
MatrixXd closed_loop(const LoopParameters& own, double stiffness) {
  const Plant body = plant(own.axis);
  const Eigen::Index n = body.b.size();
  // The command of d + 1 samplings ago acts for the first part of a period, that of d samplings ago after it.
  const auto d = static_cast<Eigen::Index>(std::floor(own.latency_s + 1e-12));
  const double part = std::max(0.0, own.latency_s - static_cast<double>(d));
  const Held first = held(body, part);
  const Held then = held(body, 1.0 - part);
  const Eigen::Index size = n + 2 + d + 1;
  const Eigen::Index last = n, filtered = n + 1, past = n + 2;  // past + i: the command of i + 1 samplings ago

  // The command of this sampling as a row over the state, and the filtered velocity.
  const double share = 1.0 - std::exp(-2.0 * std::numbers::pi * own.velocity_cutoff_Hz);
  Eigen::RowVectorXd velocity = Eigen::RowVectorXd::Zero(size);
  velocity[0] = share;
  velocity[last] = -share;
  velocity[filtered] = 1.0 - share;
  Eigen::RowVectorXd command = -own.virtual_damping_N_s_per_m * velocity;
  command[0] -= stiffness;

  const auto command_ago = [&](Eigen::Index samplings) {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(size);
    if (samplings == 0) return command;
    row[past + samplings - 1] = 1.0;
    return row;
  };
  MatrixXd m = MatrixXd::Zero(size, size);
  m.topLeftCorner(n, n) = then.phi * first.phi;
  m.topRows(n) += then.phi * first.gamma * command_ago(d + 1) + then.gamma * command_ago(d);
  m(last, 0) = 1.0;
  m.row(filtered) = velocity;
  m.row(past) = command;
  for (Eigen::Index i = 1; i <= d; ++i) m(past + i, past + i - 1) = 1.0;
  return m;
}

}  // namespace

double passive_stiffness_N_per_m(double b, double virtual_b, double period_s) {
  return std::max(0.0, 2.0 * (b - std::abs(virtual_b)) / period_s);
}

double linear_stiffness_N_per_m(double b, double virtual_b, double period_s, double latency_s) {
  return (b + virtual_b) / (0.5 * period_s + latency_s);
}

double quantised_passive_stiffness_N_per_m(double b, double friction_N, double period_s, double resolution_m) {
  const double by_sampling = 2.0 * b / period_s;
  return resolution_m > 0.0 ? std::min(by_sampling, 2.0 * friction_N / resolution_m) : by_sampling;
}

Region region(double stiffness, double b, double friction_N, double period_s, double resolution_m) {
  const bool sampling_gives = stiffness * period_s > 2.0 * b;
  const bool steps_give = stiffness * resolution_m > 2.0 * friction_N;
  if (sampling_gives) return steps_give ? Region::unstable : Region::large_unstable;
  return steps_give ? Region::small_vibration : Region::passive;
}

std::string_view name_of(Region region) {
  switch (region) {
    case Region::passive:
      return "passive";
    case Region::small_vibration:
      return "small vibration";
    case Region::large_unstable:
      return "unstable when struck";
    case Region::unstable:
      return "unstable";
  }
  return "";
}

Mode dominant_mode(const LoopParameters& parameters, double stiffness_N_per_m) {
  const double unit_N_per_m = parameters.axis.mass_kg / (parameters.period_s * parameters.period_s);
  const Eigen::VectorXcd values = closed_loop(in_own_units(parameters), stiffness_N_per_m / unit_N_per_m).eigenvalues();
  Mode out;
  for (const std::complex<double>& value : values) {
    if (std::abs(value) <= out.modulus) continue;
    out.modulus = std::abs(value);
    out.frequency_Hz = std::abs(std::arg(value)) / (2.0 * std::numbers::pi * parameters.period_s);
  }
  return out;
}

std::optional<CriticalGain> critical_gain(const LoopParameters& parameters) {
  const auto stable = [&](double k) { return dominant_mode(parameters, k).modulus < 1.0; };
  double low = smallest_N_per_m;
  if (!stable(low)) return std::nullopt;
  double high = low;
  constexpr double step_factor = 1.25;
  while (stable(high)) {
    low = high;
    high *= step_factor;
    if (high > largest_N_per_m) return std::nullopt;
  }
  constexpr int halvings = 60;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (stable(middle) ? low : high) = middle;
  }
  return CriticalGain{low, dominant_mode(parameters, high).frequency_Hz};
}

double quantiser_gain(double amplitude, double step) {
  double sum = 0.0;
  for (int i = 1; (static_cast<double>(i) - 0.5) * step < amplitude; ++i) {
    const double edge = (static_cast<double>(i) - 0.5) * step / amplitude;
    sum += std::sqrt(1.0 - edge * edge);
  }
  return 4.0 * step / (std::numbers::pi * amplitude) * sum;
}

std::optional<LimitCycle> limit_cycle(const LoopParameters& parameters, double stiffness_N_per_m) {
  const double step_m = parameters.resolution_m;
  const double friction_N = parameters.axis.friction_N;
  const auto without_friction = critical_gain(parameters);
  const auto critical_at = [&](double amplitude_m) {
    if (friction_N <= 0.0) return without_friction;
    LoopParameters own = parameters;
    std::optional<CriticalGain> critical;
    double w = std::sqrt((own.axis.hand_stiffness_N_per_m + stiffness_N_per_m) / own.axis.mass_kg);
    constexpr int refinements = 4;  // the frequency hardly depends on the amplitude
    for (int i = 0; i < refinements && w > 0.0; ++i) {
      own.axis.damping_N_s_per_m =
          parameters.axis.damping_N_s_per_m + 4.0 * friction_N / (std::numbers::pi * amplitude_m * w);
      critical = critical_gain(own);
      w = critical ? 2.0 * std::numbers::pi * critical->frequency_Hz : 0.0;
    }
    return critical;
  };
  // From large amplitudes down: where the gain K N(A) comes to exceed the critical one.
  constexpr double largest = 200.0, factor = 0.9;  // in steps of the encoder
  double outer_m = largest * step_m;
  for (double a_m = outer_m; a_m > 0.5 * step_m; a_m *= factor) {
    const auto critical = critical_at(a_m);
    if (!critical) return std::nullopt;
    const bool grows = stiffness_N_per_m * quantiser_gain(a_m, step_m) > critical->stiffness_N_per_m;
    if (!grows) {
      outer_m = a_m;
      continue;
    }
    if (a_m == largest * step_m) return std::nullopt;  // it grows beyond all steps
    double inner_m = a_m;
    constexpr int halvings = 40;
    for (int i = 0; i < halvings; ++i) {
      const double middle_m = 0.5 * (inner_m + outer_m);
      const auto at = critical_at(middle_m);
      const bool still = at && stiffness_N_per_m * quantiser_gain(middle_m, step_m) > at->stiffness_N_per_m;
      (still ? inner_m : outer_m) = middle_m;
    }
    const auto settled = critical_at(outer_m);
    return LimitCycle{outer_m, settled ? settled->frequency_Hz : critical->frequency_Hz};
  }
  return std::nullopt;
}

}  // namespace touchstone::servo
