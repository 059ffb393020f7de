#include "lab/motion_experiments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "harness/base/least_squares.h"
#include "lab/analysis.h"

namespace touchstone::hil {
namespace {

// Position, velocity and acceleration at `t_s` from the parabola through the ticks of +-30 ms: an encoder's counts
// average out, a hand's motion does not.
struct Motion {
  double v = 0.0, a = 0.0;
  bool known = false;
};
Motion motion_at(const std::vector<ServoTick>& ticks, double t_s) {
  constexpr double half_s = 0.03;
  const auto before = [](const ServoTick& tick, double t) { return tick.t_s < t; };
  const auto from = std::lower_bound(ticks.begin(), ticks.end(), t_s - half_s, before),
             to = std::lower_bound(from, ticks.end(), t_s + half_s, before);
  const auto n = to - from;
  if (n < 20 || from->t_s > t_s - 0.8 * half_s || std::prev(to)->t_s < t_s + 0.8 * half_s) return {};
  Eigen::MatrixXd basis(n, 3);
  Eigen::VectorXd x(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double s = ((from + i)->t_s - t_s) / half_s;
    basis.row(i) << 1.0, s, s * s;
    x[i] = (from + i)->p_W_m.x() - from->p_W_m.x();
  }
  const Eigen::Vector3d c = LeastSquares(basis).solve(x);
  return {c[1] / half_s, 2.0 * c[2] / (half_s * half_s), true};
}

}  // namespace

Finding friction_by_hand(Bench& bench, const LabLimits& limits, double seconds, double slowest_m_per_s) {
  if (bench.sensor == nullptr)
    throw UsageError("friction: needs a force sensor between hand and handle; connect one in the hardware map");
  bench.tell(
      fmt::format("move the handle slowly to and fro along x by 2 to 4 cm, about once in two seconds, holding it "
                  "by the force sensor only, for {:.0f} s",
                  seconds));
  const auto run = run_servo_at_zero(bench, seconds);
  if (run.trip != Trip::none)
    throw DeviceError(DeviceStatus::failed, fmt::format("friction: cut short: {}", to_string(run.trip)),
                      "run it again");
  std::vector<double> v, a, f;
  // A sample every 5 ms is plenty, and spares time.
  double next = 0.0;
  int reversals = 0, direction = 0;
  double low = 0.0, high = 0.0;
  for (const auto& s : run.wrenches) {
    if (s.t_s < next) continue;
    next = s.t_s + 5e-3;
    const auto m = motion_at(run.ticks, s.t_s);
    if (!m.known || std::abs(m.v) < slowest_m_per_s) continue;
    const int now = m.v > 0 ? 1 : -1;
    reversals += direction != 0 && now != direction;
    direction = now;
    v.push_back(m.v), a.push_back(m.a), f.push_back(s.wrench.f_N.x());
  }
  for (const auto& tick : run.ticks)
    low = std::min(low, tick.p_W_m.x() - run.ticks[0].p_W_m.x()),
    high = std::max(high, tick.p_W_m.x() - run.ticks[0].p_W_m.x());
  if (v.size() < 200 || reversals < 4 || high - low < 0.01) {
    throw DeviceError(DeviceStatus::failed,
                      fmt::format("friction: the handle moved {:.3g} mm with {} reversals while {} samples came",
                                  1e3 * (high - low), reversals, v.size()),
                      "move it to and fro by at least 10 mm, with at least 4 reversals");
  }
  const auto n = static_cast<Eigen::Index>(v.size());
  const double v_scale = *std::max_element(v.begin(), v.end()),
               a_scale = std::max(1e-9, *std::max_element(a.begin(), a.end()));
  Eigen::MatrixXd basis(n, 4);
  Eigen::VectorXd force(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    basis.row(i) << (v[k] > 0 ? 1.0 : -1.0), v[k] / v_scale, a[k] / a_scale, 1.0;
    force[i] = f[k];
  }
  const LeastSquares qr(basis);
  if (qr.rank() < 4)
    throw DeviceError(DeviceStatus::failed, "friction: the motion was too even to tell its parts apart",
                      "vary the speed");
  const Eigen::Vector4d c = qr.solve(force);
  const double residual = (basis * c - force).norm() / std::sqrt(static_cast<double>(n));
  Finding finding;
  finding.test = "friction";
  finding.measurements = {{"friction_coulomb_N", c[0]},     {"friction_viscous_N_s_per_m", c[1] / v_scale},
                          {"felt_mass_kg", c[2] / a_scale}, {"friction_residual_N", residual},
                          {"travel_m", high - low},         {"reversals", static_cast<double>(reversals)}};
  // Friction below zero would push the hand along: a sensor mounted the wrong way round.
  finding.limits = {{"friction_coulomb_N", -3.0 * residual, limits.friction_N}};
  Curve fitted_up{"fitted, +x", {}, {}, false}, fitted_down{"fitted, -x", {}, {}, false};
  const auto [slowest, fastest] = std::minmax_element(v.begin(), v.end());
  for (int i = 0; i <= 10; ++i) {
    const double up = slowest_m_per_s + 0.1 * i * (*fastest - slowest_m_per_s),
                 down = -slowest_m_per_s + 0.1 * i * (*slowest + slowest_m_per_s);
    fitted_up.x.push_back(up), fitted_up.y.push_back(c[0] + c[1] * up / v_scale + c[3]);
    fitted_down.x.push_back(down), fitted_down.y.push_back(-c[0] + c[1] * down / v_scale + c[3]);
  }
  std::vector<double> without_inertia;
  without_inertia.reserve(f.size());
  for (std::size_t i = 0; i < f.size(); ++i) without_inertia.push_back(f[i] - c[2] * a[i] / a_scale);
  finding.runs = {run};
  finding.pictures = {{"Friction when moved by hand",
                       "velocity [m/s]",
                       "force of the hand less inertia [N]",
                       {{"measured", v, without_inertia, true}, fitted_up, fitted_down}}};
  return finding;
}

Finding servo_regularity(Bench& bench, const LabLimits& limits, double seconds, bool hold_limits) {
  constexpr double period_s = 1e-3, bin_s = 50e-6;
  const auto run = run_servo_at_zero(bench, seconds, 1.0 / period_s);
  std::vector<double> t;
  for (const auto& tick : run.ticks) t.push_back(tick.t_s);
  if (t.size() < 3)
    throw DeviceError(DeviceStatus::failed,
                      fmt::format("servo-jitter: the loop gave {} ticks, and 3 are needed", t.size()),
                      "is the device still there?");
  const auto j = servo_jitter(t, period_s, bin_s, 40);
  const auto counted = std::accumulate(j.histogram.begin(), j.histogram.end(), std::uint64_t{0});
  Finding finding;
  finding.test = "servo-jitter";
  finding.measurements = {{"period_mean_s", j.mean_s},
                          {"late_p99_s", j.p99_late_s},
                          {"late_worst_s", j.worst_late_s},
                          {"missed", static_cast<double>(j.missed)},
                          {"periods_not_counted", static_cast<double>(t.size() - 1) - static_cast<double>(counted)}};
  finding.limits = {{"periods_not_counted", 0.0, 0.0}, {"period_mean_s", 0.99 * period_s}};
  if (hold_limits) finding.limits.push_back({"late_p99_s", 0.0, limits.late_p99_s});
  Curve histogram{"periods", {}, {}, false};
  for (std::size_t i = 0; i < j.histogram.size(); ++i) {
    histogram.x.push_back(1e3 * bin_s * (static_cast<double>(i) + 0.5));
    histogram.y.push_back(static_cast<double>(j.histogram[i]));
  }
  finding.runs = {run};
  finding.pictures = {
      {"Lateness of the servo loop", "lateness [ms], the last is all beyond", "periods [1]", {histogram}}};
  return finding;
}

}  // namespace touchstone::hil
