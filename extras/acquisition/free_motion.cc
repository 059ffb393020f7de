// The tool as an accelerometer: its weight and inertia, from the motion, against what the sensor felt of them.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "clock_parts.h"
#include "harness/base/least_squares.h"
#include "harness/stats/quantile.h"
#include "smoothing.h"

namespace touchstone::acquisition {
namespace {

constexpr double cutoff_Hz = 5.0;  // above it the second derivative of a tracker's noise is larger than a hand's motion
constexpr double kernel_reach = 4.0;   // of the smoothing kernel
constexpr double cluster_s = 0.25;     // several correlation times of the smoothed noise
constexpr double free_sigmas = 4.0;    // a larger misfit is contact
constexpr double contact_guard = 1.5;  // beyond what is seen of a contact, in standard deviations of the kernel
constexpr double gap_frames = 1.8;     // a frame that is missing: the kernel over what is left is not the same kernel
constexpr std::size_t fewest_samples = 100, fewest_in_cluster = 5;
constexpr double least_inertia =
    0.5;  // of what the mass and the motion make; the tracker's noise takes a part of it off

// Value and slope at `when` of values smoothed by a Gaussian: the local line (Fan and Gijbels 1996, section 2.3).
template <class Value>
struct Smooth {
  Value value, slope;
  bool usable = false;
};

template <class Value>
Smooth<Value> smooth(const std::vector<double>& t, const std::vector<Value>& values, double when, double sigma,
                     double gap) {
  const double reach = kernel_reach * sigma;
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

// Weight and inertia of the tool as the motion has them, smoothed, in the sensor's frame; bias not in it.
struct Expected {
  double t_motion_s;
  Vec3 inertia_N;
  Vec3 force_N;
};

// Both sides must pass one kernel, in the frame in which the sensor feels: a tool that turns while it speeds up would
// else leave a difference as large as a shift of 0.3 ms. The motion has its frame's force only after two derivatives.
// So the kernel, a Gaussian, is split: a narrow one for the derivatives in the tracker's frame, then, in the sensor's,
// what is left of its variance. The second difference over steps of h is a kernel of variance h^2 / 6 itself.
std::vector<Expected> expected_forces(const ClockStreams& s) {
  const double mass = s.tool.mass_kg, sigma = gaussian_sigma_s(cutoff_Hz), interval = sample_interval_s(s.t_motion_s);
  const double gap = gap_frames * interval;
  // Not narrower than the samples carry.
  const double narrow = std::min(std::max(0.5 * sigma, 0.8 * interval), 0.95 * sigma), h = 0.5 * narrow,
               before_difference = std::sqrt(narrow * narrow - h * h / 6.0),
               after_turning = std::sqrt(sigma * sigma - narrow * narrow);
  std::vector<Vec3> center, weight, inertia;
  std::vector<double> t_inertia;
  for (std::size_t i = 0; i < s.t_motion_s.size(); ++i) {
    center.push_back(s.tip_T_m[i] + s.q_TS[i] * (s.tool.center_S_m - s.tip_S_m));
    weight.push_back(s.q_TS[i].conjugate() * (mass * s.gravity_T_m_per_s2));
  }
  for (std::size_t i = 0; i < s.t_motion_s.size(); ++i) {
    const double t = s.t_motion_s[i];
    const auto at = [&](double when) { return smooth(s.t_motion_s, center, when, before_difference, gap); };
    const auto before = at(t - h), now = at(t), after = at(t + h);
    if (!before.usable || !now.usable || !after.usable) continue;
    const Vec3 a = (before.value - 2 * now.value + after.value) / (h * h);
    t_inertia.push_back(t);
    inertia.push_back(-mass * (s.q_TS[i].conjugate() * a));
  }
  std::vector<Expected> result;
  for (const double t : t_inertia) {
    const auto pull = smooth(s.t_motion_s, weight, t, sigma, gap),
               push = smooth(t_inertia, inertia, t, after_turning, gap);
    if (pull.usable && push.usable) result.push_back({t, push.value, pull.value + push.value});
  }
  return result;
}

// What the quietest tenth of the misfits says of their standard deviation per component: contact is one-sided and can
// fill most of a session. A tenth of chi's values with three degrees of freedom lie below 0.764.
double quiet_sigma(std::vector<double> sizes) { return stats::lower_quantile(std::move(sizes), 0.1) / 0.764; }

struct Sample {
  double t_motion_s;
  Vec3 inertia_N, expected_N, felt_N, felt_slope_N_per_s;
};

// expected = bias + drift + scale * felt + (offset + skew * time) * felt's slope. The force is the clean one of the two
// signals, so it stands on the right: errors in a regressor would pull the shift to zero. A bias that drifts by 20 mN
// over a session is worth a shift of 1 ms at either end: it has its own columns.
constexpr Eigen::Index bias_at = own_clock_terms, drift_at = bias_at + 3, scale_at = drift_at + 3,
                       parameters = scale_at + 1;
using Row = Eigen::Matrix<double, 1, parameters>;

Row row_of(const Sample& x, int component, double reference_s) {
  Row row = Row::Zero();
  const double time = (x.t_motion_s - reference_s) / clock_time_unit_s;
  row[0] = x.felt_slope_N_per_s[component];
  row[1] = time * x.felt_slope_N_per_s[component];
  row[bias_at + component] = 1.0;
  row[drift_at + component] = time;
  row[scale_at] = x.felt_N[component];
  return row;
}

// The samples without contact, and the fit to them.
struct FreeSamples {
  std::vector<const Sample*> free;
  Eigen::Matrix<double, parameters, 1> fit;
};

Vec3 misfit_of(const Sample& x, const Eigen::Matrix<double, parameters, 1>& fit, double reference_s) {
  Vec3 misfit;
  for (int k = 0; k < 3; ++k) misfit[k] = x.expected_N[k] - row_of(x, k, reference_s).dot(fit);
  return misfit;
}

// Contact reaches as far as the kernel: beside a short one, the smoothed force falls as exp(-u^2 / 2) does, u in the
// kernel's standard deviations. It is seen as contact out to u0, where it is 4 sigma, sigma being a sample's noise;
// over a guard of g beyond, it falls by exp(-u0 g - g^2 / 2). What is left pushes the same way at every edge of every
// contact, so that it must be small not beside sigma but beside what the mean over n edges is known to: a tenth of
// sigma / sqrt(n). Eight taps and four strokes have n = 24 edges and stand 100 to 250 sigma high, hence u0 = 2.8, and g
// = 1.5 leaves 4 exp(-5.3) = 0.02 sigma. (g = 1 leaves 0.15 sigma: over simulated sessions the offset was 0.07 ms early
// on average, a third of its scatter.)
std::vector<const Sample*> without_contact(const std::vector<Sample>& samples, const std::vector<double>& sizes,
                                           double bar) {
  const double guard = contact_guard * gaussian_sigma_s(cutoff_Hz);
  std::vector<const Sample*> free;
  double last_contact = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0, next = 0; i < samples.size(); ++i) {
    const double t = samples[i].t_motion_s;
    if (!(sizes[i] < bar)) last_contact = t;
    next = std::max(next, i);
    while (next < samples.size() && sizes[next] < bar && samples[next].t_motion_s < t + guard) ++next;
    const bool soon = next < samples.size() && !(sizes[next] < bar) && samples[next].t_motion_s < t + guard;
    if (t - last_contact > guard && !soon) free.push_back(&samples[i]);
  }
  return free;
}

// The middle of what the first or the last samples differ by from the tool.
Vec3 level_of(const std::vector<Sample>& samples, bool first) {
  const std::size_t n = std::min<std::size_t>(samples.size(), fewest_samples / 2);
  Vec3 level;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> values;
    for (std::size_t i = 0; i < n; ++i) {
      const Sample& x = samples[first ? i : samples.size() - 1 - i];
      values.push_back(x.expected_N[k] - x.felt_N[k]);
    }
    level[k] = stats::upper_median(std::move(values));
  }
  return level;
}

// Empty where there is too little free motion.
FreeSamples fit_free(const std::vector<Sample>& samples, const Vec3& bias_N, double reference_s) {
  FreeSamples result;
  // The bias may have moved since the static poses: begin with that one or with the level of either end of the session,
  // where a hand is in the air, whichever leaves more samples quiet.
  Eigen::Matrix<double, parameters, 1> start;
  double quietest = std::numeric_limits<double>::infinity();
  for (const Vec3& bias : {Vec3(-bias_N), level_of(samples, true), level_of(samples, false)}) {
    start.setZero();
    start.segment<3>(bias_at) = bias;
    start[scale_at] = 1.0;
    std::vector<double> sizes;
    for (const Sample& x : samples) sizes.push_back(misfit_of(x, start, reference_s).norm());
    const double quiet = stats::lower_quantile(std::move(sizes), 0.3);
    if (quiet < quietest) quietest = quiet, result.fit = start;
  }
  for (int pass = 0; pass < 4; ++pass) {
    std::vector<double> sizes;
    for (const Sample& x : samples) sizes.push_back(misfit_of(x, result.fit, reference_s).norm());
    result.free = without_contact(samples, sizes, free_sigmas * quiet_sigma(sizes));
    if (result.free.size() < fewest_samples) return {};
    Eigen::Matrix<double, parameters, parameters> normal = Eigen::Matrix<double, parameters, parameters>::Zero();
    Eigen::Matrix<double, parameters, 1> right = Eigen::Matrix<double, parameters, 1>::Zero();
    for (const Sample* x : result.free) {
      for (int k = 0; k < 3; ++k) {
        const Row row = row_of(*x, k, reference_s);
        normal += row.transpose() * row;
        right += row.transpose() * x->expected_N[k];
      }
    }
    result.fit = solve_symmetric(normal, right);
    if (!result.fit.allFinite()) return {};
  }
  return result;
}

}  // namespace

FreeMotion::FreeMotion(const ClockStreams& streams) : streams_(streams) {
  if (!(streams.tool.mass_kg > 0.0)) return;
  for (const Expected& e : expected_forces(streams)) {
    t_motion_s_.push_back(e.t_motion_s);
    inertia_N_.push_back(e.inertia_N);
    force_N_.push_back(e.force_N);
  }
}

double FreeMotion::offset_near(double coarse_offset_s) const {
  constexpr double step_s = 0.004, reach_s = coarse_error_s;
  const ClockStreams& s = streams_;
  const double sigma = gaussian_sigma_s(cutoff_Hz), gap = 10 * sample_interval_s(s.t_force_s);
  if (t_motion_s_.size() < fewest_samples) return coarse_offset_s;
  // The smoothed force on a grid, so that every shift is a look-up.
  std::vector<Smooth<Vec3>> felt;
  for (double t = s.t_force_s.front(); t < s.t_force_s.back(); t += step_s)
    felt.push_back(smooth(s.t_force_s, s.force_S_N, t, sigma, gap));
  const auto misfits = [&](double offset) {
    std::vector<double> sizes;
    for (std::size_t i = 0; i < t_motion_s_.size(); ++i) {
      const double place = (t_motion_s_[i] + offset - s.t_force_s.front()) / step_s;
      const auto k = static_cast<std::size_t>(std::max(0.0, place));
      if (place < 0.0 || k + 1 >= felt.size() || !felt[k].usable || !felt[k + 1].usable) continue;
      const double share = place - static_cast<double>(k);
      const Vec3 f = (1 - share) * felt[k].value + share * felt[k + 1].value;
      sizes.push_back((force_N_[i] + s.tool.bias.f_N - f).norm());
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

std::vector<ClockCluster> FreeMotion::clusters(const ClockAlignment& near) const {
  const ClockStreams& s = streams_;
  const double sigma = gaussian_sigma_s(cutoff_Hz), gap = 10 * sample_interval_s(s.t_force_s);
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < t_motion_s_.size(); ++i) {
    const auto felt = smooth(s.t_force_s, s.force_S_N, near.to_force_clock(t_motion_s_[i]), sigma, gap);
    if (felt.usable) samples.push_back({t_motion_s_[i], inertia_N_[i], force_N_[i], felt.value, felt.slope});
  }
  if (samples.size() < fewest_samples) return {};
  const auto [free, fit] = fit_free(samples, s.tool.bias.f_N, near.reference_s);
  // The force must hold the tool's inertia, as that of every real tool does: else it was compensated already, or the
  // mass is wrong, and what is left to go by is a slow turn against the weight.
  double felt_inertia = 0.0, inertia = 0.0;
  for (const Sample* x : free) {
    felt_inertia += x->inertia_N.dot(x->inertia_N - misfit_of(*x, fit, near.reference_s));
    inertia += x->inertia_N.squaredNorm();
  }
  if (!(felt_inertia > least_inertia * inertia)) return {};
  std::vector<ClockCluster> clusters;
  for (std::size_t first = 0, last = 0; first < free.size(); first = last) {
    ClockCluster c;
    c.equations = {Eigen::MatrixXd::Zero(parameters, parameters), Eigen::VectorXd::Zero(parameters)};
    double information = 0.0, moment = 0.0, when = 0.0;
    for (; last < free.size() && free[last]->t_motion_s < free[first]->t_motion_s + cluster_s; ++last) {
      const Sample& x = *free[last];
      for (int k = 0; k < 3; ++k) {
        const Row row = row_of(x, k, near.reference_s);
        c.equations.normal += row.transpose() * row;
        c.equations.right += row.transpose() * x.expected_N[k];
      }
      const double weight = x.felt_slope_N_per_s.squaredNorm();
      information += weight;
      moment += x.felt_slope_N_per_s.dot(misfit_of(x, fit, near.reference_s));
      when += weight * x.t_motion_s;
    }
    if (!(information > 0.0) || last - first < fewest_in_cluster) continue;
    const double t = when / information;
    // The scale of the felt force turns a shift into this coefficient; it is 1 within a calibration's error.
    const double shift = fit[0] + fit[1] * (t - near.reference_s) / clock_time_unit_s + moment / information;
    c.event = {near.to_force_clock(t) + shift, t, 1.0 / std::sqrt(information), moment / information, true};
    c.duration_s = static_cast<double>(last - first) * sample_interval_s(s.t_motion_s);
    clusters.push_back(std::move(c));
  }
  return clusters;
}

}  // namespace touchstone::acquisition
