#include "free_air.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/base/error.h"
#include "harness/base/least_squares.h"
#include "harness/stats/quantile.h"
#include "smoothing.h"

namespace touchstone::acquisition {
namespace {

double rms_length(const std::vector<Vec3>& v, const Vec3& from) {
  double sum = 0.0;
  for (const Vec3& x : v) sum += (x - from).squaredNorm();
  return v.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(v.size()));
}

Vec3 mean_of(const std::vector<Vec3>& v) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& x : v) sum += x / static_cast<double>(v.size());
  return sum;
}

// What is left of `force` after the best multiple of `acceleration` and a constant, and that multiple.
struct MassFit {
  double mass_kg = 0.0, left_N = 0.0;
};
MassFit fit_mass(const std::vector<Vec3>& force, const std::vector<Vec3>& acceleration) {
  const Vec3 f_mean = mean_of(force), a_mean = mean_of(acceleration);
  double fa = 0.0, aa = 0.0, ff = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    const Vec3 f = force[i] - f_mean, a = acceleration[i] - a_mean;
    fa += f.dot(a), aa += a.squaredNorm(), ff += f.squaredNorm();
  }
  return {fa / aa, std::sqrt(std::max(0.0, ff - fa * fa / aa) / static_cast<double>(force.size()))};
}

// The middle of a set of vectors, axis by axis: a run that touches for less than half of its time does not move it.
Vec3 median_of(const std::vector<Vec3>& vectors) {
  Vec3 middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(vectors.size());
    for (const Vec3& v : vectors) values.push_back(v[axis]);
    middle[axis] = stats::upper_median(std::move(values));
  }
  return middle;
}

constexpr double contact_cutoff_Hz = 5.0;
constexpr double shortest_contact_s = 0.05;

// `left`: the smoothed force that weight and inertia do not explain, at times `at`.
void find_contacts(const std::vector<double>& at, const std::vector<Vec3>& left, double weight_N, bool inertia_known,
                   FreeAirReport& report) {
  const Vec3 bias = median_of(left);
  // The run's own bias may have moved by little. Where it moved by as much as the bar, the tool leans on something all
  // along, and its middle is no bias.
  const double bar_of_motion_N = (inertia_known ? 0.25 : 0.5) * weight_N;
  const Vec3 taken = bias.norm() < bar_of_motion_N ? bias : Vec3(Vec3::Zero());
  std::vector<double> size;
  size.reserve(left.size());
  for (const Vec3& f : left) size.push_back((f - taken).norm());
  // A normal deviation in three axes has a median length of 1.538 of one axis's deviation (chi with 3 degrees).
  report.contact_bar_N =
      std::max(bar_of_motion_N, bias.norm() < bar_of_motion_N ? 6.0 * stats::upper_median(size) / 1.538 : 0.0);
  AirContact contact;
  bool touching = false;
  for (std::size_t i = 0; i <= at.size(); ++i) {
    const bool over = i < at.size() && size[i] > report.contact_bar_N;
    if (over && !touching) contact = {at[i], at[i], 0.0};
    if (over) contact.to_s = at[i], contact.force_N = std::max(contact.force_N, size[i]);
    if (!over && touching && contact.to_s - contact.from_s >= shortest_contact_s) report.contacts.push_back(contact);
    touching = over;
  }
}

// The run where wrench, orientation and acceleration overlap: what the wrench differs by from the tool's own.
struct Errors {
  std::vector<double> t_s;
  std::vector<Vec3> f_N;  // in the sensor's frame, as all of these
  std::vector<Wrench> all;
  std::vector<Wrench> at_rest;  // turning slower than the limit
};

Errors errors_of(const FreeAirRun& run, const ToolLoad& load, const Vec3& gravity_W_m_per_s2, double rest_rad_per_s,
                 const std::string& source) {
  const double margin = sample_interval_s(run.t_orientation_s);
  const auto covered = [&](double t) {
    const bool turned = t > run.t_orientation_s.front() + margin && t < run.t_orientation_s.back() - margin;
    return turned &&
           (run.t_acceleration_s.empty() || (t > run.t_acceleration_s.front() && t < run.t_acceleration_s.back()));
  };
  Errors errors;
  std::vector<double>& t = errors.t_s;
  std::vector<Wrench> measured;
  for (std::size_t i = 0; i < run.t_wrench_s.size(); ++i) {
    if (covered(run.t_wrench_s[i])) t.push_back(run.t_wrench_s[i]), measured.push_back(run.wrench[i]);
  }
  if (t.size() < 10)
    throw BadData(
        fmt::format("{}: wrench and orientation overlap in {} samples, and 10 are needed; are the files of the same "
                    "run, and is the unit of their times right (--time-unit)?",
                    source, t.size()));
  const auto q = slerp_at(run.t_orientation_s, run.q_WS, t, source);

  std::vector<double> before = t, after = t;
  constexpr double half_window_s = 0.05;
  for (std::size_t i = 0; i < t.size(); ++i) {
    before[i] = std::max(run.t_orientation_s.front(), t[i] - half_window_s);
    after[i] = std::min(run.t_orientation_s.back(), t[i] + half_window_s);
  }
  const auto q_before = slerp_at(run.t_orientation_s, run.q_WS, before, source),
             q_after = slerp_at(run.t_orientation_s, run.q_WS, after, source);
  for (std::size_t i = 0; i < t.size(); ++i) {
    const Wrench own = tool_wrench(load, q[i], gravity_W_m_per_s2);
    const Wrench e{measured[i].f_N - own.f_N, measured[i].torque_Nm - own.torque_Nm};
    errors.f_N.push_back(e.f_N);
    errors.all.push_back(e);
    if (q_before[i].angularDistance(q_after[i]) < rest_rad_per_s * (after[i] - before[i])) errors.at_rest.push_back(e);
  }
  return errors;
}

// The acceleration of the sensor in its own frame, at the times of the accelerometer: the reading without gravity.
std::vector<Vec3> accelerations(const FreeAirRun& run, const AccelerometerMap& accelerometer,
                                const Vec3& gravity_W_m_per_s2, const std::string& source) {
  std::vector<Vec3> inertial;
  if (run.t_acceleration_s.empty()) return inertial;
  const Mat3 inverse = accelerometer.per_m_per_s2.inverse();
  const auto q = slerp_at(run.t_orientation_s, run.q_WS, run.t_acceleration_s, source);
  for (std::size_t i = 0; i < run.acceleration.size(); ++i) {
    inertial.push_back(inverse * (run.acceleration[i] - accelerometer.offset) - q[i].conjugate() * gravity_W_m_per_s2);
  }
  return inertial;
}

// The mass and the offset of the accelerometer's clock, from -20 to 20 ms, that leave the least.
void fit_mass_and_clock(const FreeAirRun& run, const std::vector<Vec3>& inertial, const std::vector<double>& at,
                        const std::vector<Vec3>& force, const std::string& source, FreeAirBand& band) {
  constexpr double offset_step_s = 0.002;
  constexpr int each_way = 10;
  double offset = -offset_step_s * each_way;
  for (int tried = -each_way; tried <= each_way; ++tried, offset += offset_step_s) {
    std::vector<double> shifted;
    shifted.reserve(at.size());
    for (const double x : at)
      shifted.push_back(std::clamp(x - offset, run.t_acceleration_s.front(), run.t_acceleration_s.back()));
    const auto fit = fit_mass(force, smooth_at(run.t_acceleration_s, inertial, shifted, band.cutoff_Hz, source).values);
    if (!(fit.left_N >= band.fitted_removed_N)) {
      band.fitted_removed_N = fit.left_N;
      band.fitted_mass_kg = fit.mass_kg;
      band.fitted_offset_s = offset;
    }
  }
}

}  // namespace

std::string contact_message(const FreeAirReport& report, const std::string& source) {
  if (report.contacts.empty()) return {};
  double touching_s = 0.0;
  const AirContact* hardest = report.contacts.data();
  for (const AirContact& contact : report.contacts) {
    touching_s += contact.to_s - contact.from_s;
    if (contact.force_N > hardest->force_N) hardest = &contact;
  }
  return fmt::format(
      "{}: contact: this run touches something, {} time{} for {:.2f} s in all; hardest from {:.2f} s to {:.2f} s with "
      "{:.3g} N (moving the tool makes up to {:.3g} N): leave these stretches out, or record anew in free air",
      source, report.contacts.size(), report.contacts.size() == 1 ? "" : "s", touching_s, hardest->from_s,
      hardest->to_s, hardest->force_N, report.contact_bar_N);
}

AccelerometerMap identify_accelerometer(const std::vector<Vec3>& readings, const std::vector<Quat>& q_WS,
                                        const Vec3& gravity_W_m_per_s2, const std::string& source) {
  const auto n = static_cast<Eigen::Index>(readings.size());
  Eigen::MatrixXd a(n, 4), b(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3 g = q_WS[static_cast<std::size_t>(i)].conjugate() * gravity_W_m_per_s2;
    a.row(i) << g.transpose(), gravity_W_m_per_s2.norm();
    b.row(i) = readings[static_cast<std::size_t>(i)].transpose();
  }
  const LeastSquares qr(a);
  if (n < 4 || qr.rank() < 4)
    throw BadData(
        fmt::format("{}: {} orientations do not determine the accelerometer's axes; at least 4 are needed whose upward "
                    "directions do not lie in one plane: hold the tool still in more",
                    source, n));
  const Eigen::MatrixXd x = qr.solve(b);
  AccelerometerMap map;
  map.per_m_per_s2 = x.topRows<3>().transpose();
  map.offset = gravity_W_m_per_s2.norm() * x.row(3).transpose();
  const Mat3 inverse = map.per_m_per_s2.inverse();
  map.residual_m_per_s2 = ((a * x - b) * inverse.transpose()).norm() / std::sqrt(3.0 * static_cast<double>(n));
  return map;
}

FreeAirReport analyse_free_air(const FreeAirRun& run, const ToolLoad& load, const AccelerometerMap& accelerometer,
                               const Vec3& gravity_W_m_per_s2, const std::vector<double>& cutoffs_Hz,
                               double rest_rad_per_s, const std::string& source) {
  const Errors errors = errors_of(run, load, gravity_W_m_per_s2, rest_rad_per_s, source);
  FreeAirReport report;
  report.raw = recording::residual_of(errors.all);
  report.at_rest = recording::residual_of(errors.at_rest);
  report.rest_fraction = static_cast<double>(errors.at_rest.size()) / static_cast<double>(errors.all.size());
  if (!errors.at_rest.empty()) {
    std::vector<Vec3> rest_force;
    for (const Wrench& e : errors.at_rest) rest_force.push_back(e.f_N);
    report.bias_shift_N = mean_of(rest_force);
  }
  const std::vector<Vec3> inertial = accelerations(run, accelerometer, gravity_W_m_per_s2, source);
  const double weight_N = load.mass_kg * gravity_W_m_per_s2.norm();
  for (const double cutoff : cutoffs_Hz) {
    // Away from the ends by the kernel's width; no more points than the band needs.
    const double sigma = gaussian_sigma_s(cutoff), from = errors.t_s.front() + 2 * sigma,
                 to = errors.t_s.back() - 2 * sigma, step = std::min(0.25 / cutoff, 0.02);
    std::vector<double> at;
    double next = from;
    while (next < to) {
      at.push_back(next);
      next += step;
    }
    if (at.size() < 10) continue;
    const auto force = smooth_at(errors.t_s, errors.f_N, at, cutoff, source).values;
    const bool judged = cutoff == contact_cutoff_Hz;
    if (judged && inertial.empty()) find_contacts(at, force, weight_N, false, report);
    FreeAirBand band;
    band.cutoff_Hz = cutoff;
    band.weight_removed_N = rms_length(force, Vec3::Zero());
    band.bias_removed_N = rms_length(force, mean_of(force));
    band.inertia_removed_N = band.fitted_mass_kg = band.fitted_offset_s = band.fitted_removed_N =
        std::numeric_limits<double>::quiet_NaN();
    if (!inertial.empty()) {
      const auto acceleration = smooth_at(run.t_acceleration_s, inertial, at, cutoff, source).values;
      std::vector<Vec3> left;
      left.reserve(force.size());
      for (std::size_t i = 0; i < force.size(); ++i) left.push_back(force[i] - load.mass_kg * acceleration[i]);
      band.inertia_removed_N = rms_length(left, mean_of(left));
      if (judged) find_contacts(at, left, weight_N, true, report);
      fit_mass_and_clock(run, inertial, at, force, source, band);
    }
    report.bands.push_back(band);
  }
  return report;
}

}  // namespace touchstone::acquisition
