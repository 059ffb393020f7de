// The tool as an accelerometer: its weight and inertia, from the motion, against what the sensor felt of them.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "harness/acquisition/clock_parts.h"
#include "harness/acquisition/smoothing.h"
#include "harness/stats/quantile.h"

namespace touchstone::acquisition {
namespace {

constexpr double cutoff_Hz = 5.0;  // above it the second derivative of a tracker's noise is larger than a hand's motion
constexpr double reach_in_sigmas = 4.0;  // of the smoothing kernel
constexpr double stretch_s = 1.0;        // several correlation times of the smoothed noise
constexpr double free_sigmas = 4.0;      // a larger misfit is contact

// Value and slope at `when` of values smoothed by a Gaussian: the local line (Fan and Gijbels 1996, section 2.3).
template <class Value>
struct Smooth {
  Value value, slope;
  bool usable = false;
};

template <class Value>
Smooth<Value> smooth(const std::vector<double>& t, const std::vector<Value>& values, double when, double sigma,
                     double gap) {
  const double reach = reach_in_sigmas * sigma;
  const auto first =
                 static_cast<std::size_t>(std::distance(t.begin(), std::lower_bound(t.begin(), t.end(), when - reach))),
             last =
                 static_cast<std::size_t>(std::distance(t.begin(), std::upper_bound(t.begin(), t.end(), when + reach)));
  Smooth<Value> result;
  // Both ends reached, and no gap: else the two streams would be smoothed differently.
  if (first == 0 || last == t.size() || last - first < 4) return result;
  double s0 = 0, s1 = 0, s2 = 0;
  Value y0 = Value::Zero(), y1 = Value::Zero();
  for (std::size_t i = first; i < last; ++i) {
    if (i > first && t[i] - t[i - 1] > gap) return result;
    const double u = (t[i] - when) / sigma, w = std::exp(-0.5 * u * u);
    s0 += w, s1 += w * u, s2 += w * u * u;
    y0 += w * values[i], y1 += w * u * values[i];
  }
  const double determinant = s0 * s2 - s1 * s1;
  result.value = (s2 * y0 - s1 * y1) / determinant;
  result.slope = (s0 * y1 - s1 * y0) / (determinant * sigma);
  result.usable = true;
  return result;
}

struct Expected {
  double t_motion_s;
  Vec3 inertia_N;
  Vec3 force_N;  // weight and inertia of the tool as the motion has them, in the sensor's frame, bias not in it
};

std::vector<Expected> expected_forces(const ClockStreams& s) {
  const double mass = s.tool.mass_kg, sigma = gaussian_sigma_s(cutoff_Hz), interval = sample_interval_s(s.t_motion_s);
  std::vector<Vec3> center, weight;
  for (std::size_t i = 0; i < s.t_motion_s.size(); ++i) {
    center.push_back(s.tip_T_m[i] + s.q_TS[i] * (s.tool.center_S_m - s.tip_S_m));
    weight.push_back(s.q_TS[i].conjugate() * (mass * s.gravity_T_m_per_s2));
  }
  std::vector<Expected> result;
  for (std::size_t i = 1; i + 1 < s.t_motion_s.size(); ++i) {
    const double t = s.t_motion_s[i];
    const auto at = [&](double when) { return smooth(s.t_motion_s, center, when, sigma, 3 * interval); };
    const auto before = at(t - interval), now = at(t), after = at(t + interval);
    const auto pull = smooth(s.t_motion_s, weight, t, sigma, 3 * interval);
    if (!before.usable || !now.usable || !after.usable || !pull.usable) continue;
    const Vec3 a = (before.value - 2 * now.value + after.value) / (interval * interval);
    const Vec3 inertia = -mass * (s.q_TS[i].conjugate() * a);
    result.push_back({t, inertia, pull.value + inertia});
  }
  return result;
}

struct Sample {
  double t_motion_s;
  Vec3 inertia_N, expected_N, felt_N, felt_slope_N_per_s;
};

// What the quietest tenth of the misfits says of their standard deviation per component: contact is one-sided and can
// fill most of a session. A tenth of chi's values with three degrees of freedom lie below 0.764.
double quiet_sigma(std::vector<double> sizes) { return stats::lower_quantile(std::move(sizes), 0.1) / 0.764; }

constexpr std::size_t fewest_samples = 100;
constexpr double least_inertia =
    0.5;  // of what the mass and the motion make; the tracker's noise takes a part of it off

}  // namespace

double free_motion_offset(const ClockStreams& s, double coarse_offset_s) {
  constexpr double step_s = 0.004, reach_s = coarse_error_s;
  if (!(s.tool.mass_kg > 0.0)) return coarse_offset_s;
  const auto expected = expected_forces(s);
  const double sigma = gaussian_sigma_s(cutoff_Hz), gap = 10 * sample_interval_s(s.t_force_s);
  // The smoothed force on a grid, so that every shift is a look-up.
  std::vector<Smooth<Vec3>> felt;
  for (double t = s.t_force_s.front(); t < s.t_force_s.back(); t += step_s)
    felt.push_back(smooth(s.t_force_s, s.force_S_N, t, sigma, gap));
  const auto misfits = [&](double offset) {
    std::vector<double> sizes;
    for (const Expected& e : expected) {
      const double place = (e.t_motion_s + offset - s.t_force_s.front()) / step_s;
      const auto k = static_cast<std::size_t>(std::max(0.0, place));
      if (place < 0.0 || k + 1 >= felt.size() || !felt[k].usable || !felt[k + 1].usable) continue;
      const double share = place - static_cast<double>(k);
      const Vec3 f = (1 - share) * felt[k].value + share * felt[k + 1].value;
      sizes.push_back((e.force_N + s.tool.bias.f_N - f).norm());
    }
    return sizes;
  };
  // Misfits beyond a bar count as the bar: that is contact.
  const auto at_start = misfits(coarse_offset_s);
  if (at_start.size() < fewest_samples) return coarse_offset_s;
  const double bar = free_sigmas * quiet_sigma(at_start);
  double least = std::numeric_limits<double>::infinity(), best = coarse_offset_s;
  for (double shift = -reach_s; shift <= reach_s; shift += step_s) {
    double cost = 0.0;
    const auto sizes = misfits(coarse_offset_s + shift);
    for (const double size : sizes) cost += std::min(size * size, bar * bar) / static_cast<double>(sizes.size());
    if (cost < least) least = cost, best = coarse_offset_s + shift;
  }
  return best;
}

std::vector<ClockAlignment::Event> free_motion_events(const ClockStreams& s, const ClockAlignment& near) {
  std::vector<ClockAlignment::Event> events;
  if (!(s.tool.mass_kg > 0.0)) return events;
  const double sigma = gaussian_sigma_s(cutoff_Hz), gap = 10 * sample_interval_s(s.t_force_s);
  std::vector<Sample> samples;
  for (const Expected& e : expected_forces(s)) {
    const auto felt = smooth(s.t_force_s, s.force_S_N, near.to_force_clock(e.t_motion_s), sigma, gap);
    if (felt.usable) samples.push_back({e.t_motion_s, e.inertia_N, e.force_N, felt.value, felt.slope});
  }
  if (samples.size() < fewest_samples) return events;
  // expected = bias + scale * felt + shift * felt's slope. The force is the clean one of the two signals, so it stands
  // on the right (errors in a regressor would pull the shift to zero).
  Eigen::Matrix<double, 5, 1> fit;
  fit << -s.tool.bias.f_N, 1.0, 0.0;
  const auto misfit = [&](const Sample& x) -> Vec3 {
    return x.expected_N - fit.head<3>() - fit[3] * x.felt_N - fit[4] * x.felt_slope_N_per_s;
  };
  std::vector<const Sample*> free;
  for (int pass = 0; pass < 4; ++pass) {
    std::vector<double> sizes;
    for (const Sample& x : samples) sizes.push_back(misfit(x).norm());
    const double bar = free_sigmas * quiet_sigma(std::move(sizes));
    free.clear();
    Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
    Eigen::Matrix<double, 5, 1> right = Eigen::Matrix<double, 5, 1>::Zero();
    for (const Sample& x : samples) {
      if (!(misfit(x).norm() < bar)) continue;
      free.push_back(&x);
      for (int k = 0; k < 3; ++k) {
        Eigen::Matrix<double, 5, 1> row = Eigen::Matrix<double, 5, 1>::Zero();
        row[k] = 1.0, row[3] = x.felt_N[k], row[4] = x.felt_slope_N_per_s[k];
        normal += row * row.transpose();
        right += row * x.expected_N[k];
      }
    }
    const Eigen::LDLT<Eigen::Matrix<double, 5, 5>> solver(normal);
    if (free.size() < fewest_samples || solver.info() != Eigen::Success) return events;
    fit = solver.solve(right);
    if (!fit.allFinite()) return events;
  }
  const double shift = fit[4];
  // The force must hold the tool's inertia, as that of every real tool does: else it was compensated already, or the
  // mass is wrong, and what is left to go by is a slow turn against the weight.
  double felt_inertia = 0.0, inertia = 0.0;
  for (const Sample* x : free) {
    felt_inertia += x->inertia_N.dot(x->inertia_N - misfit(*x));
    inertia += x->inertia_N.squaredNorm();
  }
  if (!(felt_inertia > least_inertia * inertia)) return events;
  for (std::size_t first = 0, last = 0; first < free.size(); first = last) {
    double information = 0.0, moment = 0.0, when = 0.0;
    while (last < free.size() && free[last]->t_motion_s < free[first]->t_motion_s + stretch_s) {
      const Sample& x = *free[last++];
      const double weight_of = x.felt_slope_N_per_s.squaredNorm();
      information += weight_of;
      moment += x.felt_slope_N_per_s.dot(misfit(x));
      when += weight_of * x.t_motion_s;
    }
    if (!(information > 0.0) || last - first < 10) continue;
    const double t = when / information;
    events.push_back(
        {near.to_force_clock(t) + shift + moment / information, t, 1.0 / std::sqrt(information), 0.0, true});
  }
  return events;
}

}  // namespace touchstone::acquisition
