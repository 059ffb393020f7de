// The shift between the clocks at each tap: heights of the tracker against what the force says of them.
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

constexpr int coarse_steps_per_frame = 8;
constexpr double search_frames = 1.5;   // skew over a session, and single taps' scatter
constexpr int scan_steps = 30;          // to either side, then refined
constexpr double clear_speed = 4.0;     // sigmas by which the tip must come down before a tap
constexpr double halfway_s = 0.05;      // after a tap the tip must be higher by then; a slow hand starts from rest
constexpr double fewest_for_habit = 4;  // taps, for a variance over them
constexpr double good_fit = 2.5;        // times the tracker's noise: a tap that fits worse was something else

// A tap on the force's clock with the flight that the force predicts beside it.
struct TapModel {
  double onset_s, release_s, from_s, to_s;
  std::vector<ForceTap::Flight> flights;
  // At the force's samples from from_s to to_s: the force while touching, the double integral of -force / m in flight.
  std::vector<double> t_s, force_N, flight_m;
};

TapModel model_of(const ForceTap& tap, const std::vector<double>& t, const std::vector<double>& force, double mass_kg,
                  double approach_s) {
  TapModel m{tap.onset_s, tap.release_s, tap.onset_s - approach_s, tap.release_s + approach_s, tap.flights, {}, {}, {}};
  const auto at = [&](double when) {
    return static_cast<std::size_t>(std::distance(t.begin(), std::lower_bound(t.begin(), t.end(), when)));
  };
  const std::size_t first = at(m.from_s - 0.05), last = std::min(t.size(), at(m.to_s + 0.05));
  m.t_s.assign(t.begin() + static_cast<std::ptrdiff_t>(first), t.begin() + static_cast<std::ptrdiff_t>(last));
  m.force_N.assign(m.t_s.size(), 0.0);
  m.flight_m.assign(m.t_s.size(), 0.0);
  for (std::size_t i = first; i < last; ++i) {
    const bool flies = std::any_of(tap.flights.begin(), tap.flights.end(),
                                   [&](const ForceTap::Flight& f) { return t[i] > f.from_s && t[i] < f.to_s; });
    if (t[i] >= tap.onset_s && t[i] <= tap.release_s && !flies) m.force_N[i - first] = force[i];
  }
  if (mass_kg > 0.0) {
    double speed = 0.0, height = 0.0;
    for (std::size_t i = at(tap.release_s); i < last && i > first; ++i) {
      const double dt = t[i] - std::max(t[i - 1], tap.release_s);
      height += speed * dt - 0.5 * force[i] / mass_kg * dt * dt;
      speed -= force[i] / mass_kg * dt;
      m.flight_m[i - first] = height;
    }
    speed = height = 0.0;
    for (std::size_t i = at(tap.onset_s); i-- > first;) {
      const double dt = std::min(t[i + 1], tap.onset_s) - t[i];
      height += speed * dt - 0.5 * force[i] / mass_kg * dt * dt;
      speed -= force[i] / mass_kg * dt;
      m.flight_m[i - first] = height;
    }
    // Between two contacts: from the level to the level.
    for (const ForceTap::Flight& flight : tap.flights) {
      speed = height = 0.0;
      const std::size_t begin = at(flight.from_s), end = std::min(at(flight.to_s), last);
      for (std::size_t i = begin; i < end && i > first; ++i) {
        const double dt = t[i] - std::max(t[i - 1], flight.from_s);
        height += speed * dt - 0.5 * force[i] / mass_kg * dt * dt;
        speed -= force[i] / mass_kg * dt;
        m.flight_m[i - first] = height;
      }
      for (std::size_t i = begin; i < end && i > first; ++i)
        m.flight_m[i - first] -= height * (t[i] - flight.from_s) / (flight.to_s - flight.from_s);
    }
  }
  return m;
}

double value_at(const std::vector<double>& t, const std::vector<double>& values, double when) {
  const auto after = static_cast<std::size_t>(std::distance(t.begin(), std::upper_bound(t.begin(), t.end(), when)));
  if (after == 0 || after == t.size()) return 0.0;
  const double share = (when - t[after - 1]) / (t[after] - t[after - 1]);
  return values[after - 1] + share * (values[after] - values[after - 1]);
}

// The heights around a tap with everything projected out that belongs to this tap alone: the level, and speed and
// constant acceleration of either flight.
struct Projected {
  Eigen::VectorXd height, force;  // the rest of the heights, and of the force that compliance multiplies
  Eigen::VectorXd shift;          // and of the height's derivative by the offset
  // Of approach and leaving [m/s^2], and their variance where the heights' is one.
  double acceleration[2] = {0.0, 0.0}, acceleration_variance[2] = {0.0, 0.0};
  Eigen::Index freedom = 0;
  double spread_m2 = 0.0;  // of the heights about their mean
  bool usable = false;
  bool taps = false;  // clearly down before, and up after
};

// The tracker's noise along the normal, from third differences: a hand moves smoothly from frame to frame. White noise
// of one has the root of 1 + 9 + 9 + 1 there.
double tracker_noise(const std::vector<double>& height) {
  std::vector<double> thirds;
  for (std::size_t i = 3; i < height.size(); ++i)
    thirds.push_back(std::abs(height[i] - 3 * height[i - 1] + 3 * height[i - 2] - height[i - 3]));
  if (thirds.empty()) return 0.0;
  return stats::normal_sigma_per_median * stats::upper_median(std::move(thirds)) / std::sqrt(20.0);
}

constexpr Eigen::Index own_parameters = 5;  // and one more per bounce
constexpr Eigen::Index of_acceleration[2] = {2, 4};

// How far single taps' accelerations lie from zero, in units of the tracker's noise: of approach and leaving. A free
// acceleration doubles the error of the instant of contact, so what a hand hardly does is hardly allowed (random
// effects; their variance by moments: DerSimonian and Laird, Controlled Clinical Trials 7, 1986).
struct Habit {
  double acceleration_per_noise[2] = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
};

Projected project(const TapModel& tap, const std::vector<double>& t_motion, const std::vector<double>& height,
                  double offset, double compliance, const Habit& habit = {}) {
  Projected p;
  const auto first = std::lower_bound(t_motion.begin(), t_motion.end(), tap.from_s - offset),
             last = std::upper_bound(t_motion.begin(), t_motion.end(), tap.to_s - offset);
  const auto n = static_cast<Eigen::Index>(std::distance(first, last));
  const auto columns = own_parameters + static_cast<Eigen::Index>(tap.flights.size());
  if (n < columns + 3) return p;
  // Below the samples, one row for each acceleration that says: about zero.
  const Eigen::Index rows = n + 2;
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(rows, columns);
  Eigen::VectorXd h = Eigen::VectorXd::Zero(rows), f = h, slope = h;
  for (int side = 0; side < 2; ++side) own(n + side, of_acceleration[side]) = 1.0 / habit.acceleration_per_noise[side];
  Eigen::Index before = 0, touching = 0, after = 0;
  const auto base = static_cast<std::size_t>(std::distance(t_motion.begin(), first));
  for (Eigen::Index i = 0; i < n; ++i) {
    const double u = t_motion[base + static_cast<std::size_t>(i)] + offset;
    const double down = std::max(0.0, tap.onset_s - u), up = std::max(0.0, u - tap.release_s);
    before += down > 0, after += up > 0, touching += down == 0 && up == 0;
    own.row(i).head<own_parameters>() << 1.0, down, 0.5 * down * down, up, 0.5 * up * up;
    // Constant acceleration from one contact to the next; its derivative by the time is found with the flight's.
    for (std::size_t k = 0; k < tap.flights.size(); ++k) {
      const ForceTap::Flight& flight = tap.flights[k];
      if (u > flight.from_s && u < flight.to_s)
        own(i, own_parameters + static_cast<Eigen::Index>(k)) = (u - flight.from_s) * (flight.to_s - u);
    }
    h[i] = height[base + static_cast<std::size_t>(i)] - height[base] - value_at(tap.t_s, tap.flight_m, u);
    f[i] = -value_at(tap.t_s, tap.force_N, u);
  }
  // Three samples of either flight, or speed and acceleration would be free to fit anything.
  if (before < 3 || after < 3 || touching < 1) return p;
  const LeastSquares qr(own);
  if (qr.rank() < own_parameters) return p;  // a bounce between two frames may have no sample: that is no matter
  const Eigen::VectorXd solution = qr.solve(h - compliance * f);
  for (Eigen::Index i = 0; i < n; ++i) {
    slope[i] = own(i, 1) > 0   ? -solution[1] - solution[2] * own(i, 1)
               : own(i, 3) > 0 ? solution[3] + solution[4] * own(i, 3)
                               : 0.0;
    const double u = t_motion[base + static_cast<std::size_t>(i)] + offset, step = 1e-3;
    slope[i] += (value_at(tap.t_s, tap.flight_m, u + step) - value_at(tap.t_s, tap.flight_m, u - step)) / (2 * step);
    for (std::size_t k = 0; k < tap.flights.size(); ++k) {
      const ForceTap::Flight& flight = tap.flights[k];
      if (u > flight.from_s && u < flight.to_s)
        slope[i] += solution[own_parameters + static_cast<Eigen::Index>(k)] * (flight.from_s + flight.to_s - 2 * u);
    }
  }
  p.height = h - own * qr.solve(h);
  p.force = f - own * qr.solve(f);
  p.shift = slope - own * qr.solve(slope);
  p.freedom = n +
              std::count_if(std::begin(habit.acceleration_per_noise), std::end(habit.acceleration_per_noise),
                            [](double a) { return std::isfinite(a); }) -
              qr.rank();
  p.spread_m2 = (h.head(n).array() - h.head(n).mean()).square().sum();
  p.usable = true;
  const Eigen::MatrixXd first_columns = own.leftCols<own_parameters>();
  const Eigen::MatrixXd covariance = LeastSquares(first_columns.transpose() * first_columns)
                                         .solve(Eigen::MatrixXd::Identity(own_parameters, own_parameters));
  const double noise_m = std::sqrt((p.height - compliance * p.force).squaredNorm() / static_cast<double>(p.freedom));
  for (int side = 0; side < 2; ++side) {
    p.acceleration[side] = solution[of_acceleration[side]];
    p.acceleration_variance[side] = covariance(of_acceleration[side], of_acceleration[side]);
  }
  p.taps = solution[1] > clear_speed * noise_m * std::sqrt(covariance(1, 1)) &&
           solution[3] + 0.5 * solution[4] * halfway_s > 0.0;
  return p;
}

// All taps of a session and the motion that they are looked for in.
struct TapFit {
  const std::vector<double>& t_motion_s;
  const std::vector<double>& height_m;
  std::vector<TapModel> models;
  double interval_s, noise_m, largest_misfit_m;

  static double offset_at(const TapModel& m, const ClockAlignment& line) {
    return m.onset_s - line.to_motion_clock(m.onset_s);
  }
  [[nodiscard]] Projected at(const TapModel& m, double offset_s, double compliance, const Habit& habit = {}) const {
    return project(m, t_motion_s, height_m, offset_s, compliance, habit);
  }
  static double misfit(const Projected& p, double compliance) {
    return std::sqrt((p.height - compliance * p.force).squaredNorm() / static_cast<double>(p.freedom));
  }

  // The compliance of surface, tip and tool, which all taps share: the median over the taps that fit with their own.
  [[nodiscard]] double compliance_at(const ClockAlignment& line) const {
    std::vector<double> single;
    for (const TapModel& m : models) {
      const Projected p = at(m, offset_at(m, line), 0.0);
      const double ff = p.usable ? p.force.squaredNorm() : 0.0, own = ff > 0.0 ? p.force.dot(p.height) / ff : 0.0;
      if (p.usable && p.taps && misfit(p, own) < largest_misfit_m) single.push_back(std::max(0.0, own));
    }
    return single.empty() ? 0.0 : stats::upper_median(std::move(single));
  }

  [[nodiscard]] Habit habit_at(const ClockAlignment& line, double compliance) const {
    Habit habit;
    for (int side = 0; side < 2; ++side) {
      double square = 0.0, variance = 0.0, n = 0.0;
      for (const TapModel& m : models) {
        const Projected p = at(m, offset_at(m, line), compliance);
        if (!p.usable || !p.taps || misfit(p, compliance) > largest_misfit_m) continue;
        square += std::pow(p.acceleration[side] / noise_m, 2), variance += p.acceleration_variance[side], n += 1.0;
      }
      if (n < fewest_for_habit) continue;
      // What the accelerations scatter beyond their own error, and one standard error of that scatter on top: few taps
      // must not pass for a habit.
      habit.acceleration_per_noise[side] =
          std::sqrt(std::max(0.0, square - variance) / n + std::sqrt(2.0 / n) * variance / n);
    }
    return habit;
  }

  // Where the guess's neighbourhood looks most like taps: the share of the heights' spread that down, rest and up do
  // not explain, one for what does not come down before and go up after.
  [[nodiscard]] double start_near(double guess_s, double error_s) const {
    double best = std::numeric_limits<double>::infinity(), start = guess_s;
    const double step = interval_s / coarse_steps_per_frame;
    for (double shift = -error_s; shift <= error_s; shift += step) {
      double unlike = 0.0;
      for (const TapModel& m : models) {
        const Projected p = at(m, guess_s + shift, 0.0);
        const double ff = p.usable ? p.force.squaredNorm() : 0.0,
                     c = ff > 0.0 ? std::max(0.0, p.force.dot(p.height) / ff) : 0.0;
        unlike += p.usable && p.taps && p.spread_m2 > 0.0 ? (p.height - c * p.force).squaredNorm() / p.spread_m2 : 1.0;
      }
      if (unlike < best) best = unlike, start = guess_s + shift;
    }
    return start;
  }

  // The offset within reach of `middle` at which the heights fit best; NaN if that is at the end of the reach.
  [[nodiscard]] double best_offset(const TapModel& m, double middle, double compliance, const Habit& habit) const {
    const double reach = search_frames * interval_s;
    const auto cost = [&](double offset) {
      const Projected p = at(m, offset, compliance, habit);
      return p.usable ? (p.height - compliance * p.force).squaredNorm() / static_cast<double>(p.freedom)
                      : std::numeric_limits<double>::infinity();
    };
    double least = std::numeric_limits<double>::infinity(), best = middle;
    for (int k = -scan_steps; k <= scan_steps; ++k) {
      const double offset = middle + reach * k / scan_steps;
      if (const double c = cost(offset); c < least) least = c, best = offset;
    }
    if (!std::isfinite(least) || std::abs(best - middle) > 0.99 * reach)
      return std::numeric_limits<double>::quiet_NaN();
    double step = reach / scan_steps;
    for (int refine = 0; refine < 25; ++refine, step *= 0.6) {
      for (const double offset : {best - step, best + step}) {
        if (const double c = cost(offset); c < least) least = c, best = offset;
      }
    }
    return best;
  }
};

}  // namespace

std::vector<ClockAlignment::Event> tap_events(const std::vector<double>& t_force_s,
                                              const std::vector<double>& normal_force_N,
                                              const std::vector<double>& t_motion_s,
                                              const std::vector<double>& height_m, const std::vector<ForceTap>& taps,
                                              double guess_s, double error_s, double tool_mass_kg,
                                              const TapOptions& options) {
  // Exact heights must not count infinitely, and the model is good to a fiftieth of the lift.
  const auto [lowest, highest] = std::minmax_element(height_m.begin(), height_m.end());
  const double lift = height_m.empty() ? 0.0 : *highest - *lowest;
  const double noise = std::max(tracker_noise(height_m), 1e-5 * lift), interval = sample_interval_s(t_motion_s);
  TapFit fit{t_motion_s, height_m, {}, interval, noise, std::max(good_fit * noise, 0.02 * lift)};
  fit.models.reserve(taps.size());
  for (const ForceTap& tap : taps)
    fit.models.push_back(model_of(tap, t_force_s, normal_force_N, tool_mass_kg, options.approach_s));
  ClockAlignment line;
  line.offset_s = fit.start_near(guess_s, error_s);
  std::vector<ClockAlignment::Event> events;
  // Twice: compliance and accelerations are first taken at one offset for all, then at the line through the taps.
  for (int pass = 0; pass < 2; ++pass) {
    const double compliance = fit.compliance_at(line);
    const Habit habit = fit.habit_at(line, compliance);
    events.clear();
    for (std::size_t i = 0; i < taps.size(); ++i) {
      const double at = fit.best_offset(fit.models[i], TapFit::offset_at(fit.models[i], line), compliance, habit);
      if (std::isnan(at)) continue;
      const Projected p = fit.at(fit.models[i], at, compliance, habit);
      const double information = p.shift.squaredNorm();
      if (!p.taps || !(information > 0.0) || TapFit::misfit(p, compliance) > fit.largest_misfit_m) continue;
      const double sigma =
          std::hypot(noise / std::sqrt(information), 0.5 * std::hypot(taps[i].onset_sigma_s, taps[i].release_sigma_s));
      if (sigma > interval) continue;
      const double t = taps[i].onset_s;
      events.push_back({t, t - at, sigma, 0.0, false});
    }
    if (events.size() < 2) break;
    line = line_through(events, interval);
  }
  return events;
}

}  // namespace touchstone::acquisition
