#include "number_evidence.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include "foreign_unit.h"
#include "harness/base/vec.h"
#include "harness/stats/quantile.h"

namespace touchstone::importing {
namespace {

using Series = std::vector<double>;

struct Unit {
  const char* name;
  double factor;  // to SI
};
constexpr auto lengths = std::to_array<Unit>({{"m", 1.0}, {"cm", 1e-2}, {"in", 0.0254}, {"mm", 1e-3}, {"um", 1e-6}});
constexpr auto forces = std::to_array<Unit>({{"N", 1.0}, {"gf", 9.80665e-3}, {"mN", 1e-3}, {"uN", 1e-6}});
constexpr auto torques = std::to_array<Unit>({{"N.m", 1.0}, {"N.mm", 1e-3}});

// Three columns of one quantity in SI, or the one of them that there is; empty if there is none.
struct Vectors {
  std::vector<std::string> names;
  std::vector<Vec3> values;
  bool assumed = false;  // no name states the unit
  std::size_t axes = 0;

  [[nodiscard]] std::string text() const { return fmt::format("{}", fmt::join(names, ", ")); }
  // The largest range of a component.
  [[nodiscard]] double span() const {
    Vec3 low = Vec3::Constant(INFINITY), high = -low;
    for (const Vec3& v : values) low = low.cwiseMin(v), high = high.cwiseMax(v);
    return values.empty() ? 0.0 : (high - low).maxCoeff();
  }
  [[nodiscard]] double farthest() const {
    double far = 0.0;
    for (const Vec3& v : values) far = std::max(far, v.cwiseAbs().maxCoeff());
    return far;
  }
};

Vectors vectors_of(const Imported& read, const std::set<std::string>& assumed, std::array<std::string_view, 3> starts,
                   std::string_view si) {
  Vectors out;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t c = 0; c < read.names.size(); ++c) {
      const std::string& name = read.names[c];
      if (!name.starts_with(starts[axis])) continue;
      const auto factor = foreign_unit_factor(name.substr(starts[axis].size()), si);
      if (!factor) continue;
      out.values.resize(read.columns[c].size(), Vec3::Zero());
      for (std::size_t i = 0; i < out.values.size(); ++i) {
        out.values[i][static_cast<Eigen::Index>(axis)] = *factor * read.columns[c][i];
      }
      out.names.push_back(name);
      out.assumed = out.assumed || assumed.contains(name);
      ++out.axes;
    }
  }
  return out;
}

// The quantile of the speed over windows that are long beside the noise of a tracker; zero without a clock.
double usual_high_speed(const Series& t_s, const std::vector<Vec3>& p_m) {
  constexpr double window_s = 0.05, high = 0.95;
  std::vector<double> speeds;
  for (std::size_t i = 0, k = 0; i < t_s.size() && p_m.size() == t_s.size(); ++i) {
    while (k < i && t_s[i] - t_s[k + 1] >= window_s) ++k;
    const double dt = t_s[i] - t_s[k];
    if (dt >= window_s) speeds.push_back((p_m[i] - p_m[k]).norm() / dt);
  }
  return speeds.empty() ? 0.0 : stats::quantile(speeds, high);
}

// "in mm 0.30 to ..": the units in which the figure is below its limit.
template <std::size_t n>
std::string fitting_units(const std::array<Unit, n>& units, double value, double least, double most) {
  std::string text;
  for (const Unit& unit : units) {
    const double there = value * unit.factor;
    if (unit.factor == 1.0 || !(there >= least) || !(there <= most)) continue;
    text += fmt::format("{}{:.9g} for {}", text.empty() ? "" : ", ", unit.factor, unit.name);
  }
  return text.empty() ? "no unit that is known fits: put the scale" : "put the scale: " + text;
}

void judge_positions(const Vectors& p, const Series& t_s, std::vector<NumberFinding>& out) {
  if (!p.assumed) return;
  constexpr double desktop_m = 0.5, reach_m = 2.0, farthest_m = 5.0, fastest_m_per_s = 2.0, least_m = 1e-4;
  const double span = p.span(), speed = usual_high_speed(t_s, p.values);
  std::string figures = fmt::format("in m they span {:.3g} m, as far as {:.3g} m from the origin", span, p.farthest());
  if (!t_s.empty()) figures += fmt::format(", at up to {:.3g} m/s", speed);
  const bool impossible = span > reach_m || p.farthest() > farthest_m || speed > fastest_m_per_s;
  if (!impossible && !(span > desktop_m)) {
    out.push_back({p.text(), "no unit is named; m is assumed: " + figures, false, {}});
    return;
  }
  const char* const why = impossible ? "which no hand does" : "which is beyond a desk, and in mm a small indentation";
  out.push_back(
      {p.text(),
       fmt::format("no unit is named, and {}, {}: {}", figures, why, fitting_units(lengths, span, least_m, reach_m)) +
           (impossible ? "" : ", 1 for m"),
       true, p.names});
}

void judge_forces(const Vectors& f, std::vector<NumberFinding>& out) {
  if (!f.assumed) return;
  constexpr double strongest_N = 100.0, heaviest_N = 200.0, least_N = 0.01;
  const double span = f.span(), farthest = f.farthest();
  const std::string figures = fmt::format("in N they vary by {:.3g} N and reach {:.3g} N", span, farthest);
  if (!(span > strongest_N) && !(farthest > heaviest_N)) {
    out.push_back({f.text(), "no unit is named; N is assumed: " + figures, false, {}});
    return;
  }
  out.push_back(
      {f.text(),
       fmt::format("no unit is named, and {}, more than a hand pushes a probe with or a tool weighs: {}, 1 for N",
                   figures, fitting_units(forces, span, least_N, strongest_N)),
       true, f.names});
}

void judge_torques(const Vectors& torque, const Vectors& f, std::vector<NumberFinding>& out) {
  if (!torque.assumed) return;
  constexpr double longest_lever_m = 1.0, strongest_N_m = 10.0, least_m = 1e-3;
  const double span = torque.span(), force = f.span();
  const bool lever = force > 0.0;
  const double value = lever ? span / force : span, most = lever ? longest_lever_m : strongest_N_m;
  const std::string figures =
      lever ? fmt::format("in N m they vary by {:.3g} N m where the forces vary by {:.3g} N: a lever of {:.3g} m", span,
                          force, value)
            : fmt::format("in N m they vary by {:.3g} N m", span);
  if (!(value > most)) {
    out.push_back({torque.text(), "no unit is named; N m is assumed: " + figures, false, {}});
    return;
  }
  out.push_back({torque.text(),
                 fmt::format("no unit is named, and {}: {}, 1 for N m", figures,
                             fitting_units(torques, value, lever ? least_m : 0.0, most)),
                 true, torque.names});
}

void judge_angle(const Imported& read, const std::set<std::string>& assumed, std::vector<NumberFinding>& out) {
  const auto found = std::ranges::find(read.names, std::string("q_rad"));
  if (found == read.names.end() || !assumed.contains(*found)) return;
  const auto& q = read.columns[static_cast<std::size_t>(found - read.names.begin())];
  const auto [low, high] = std::ranges::minmax(q);
  const double span = high - low;
  if (!(span > 2.0 * std::numbers::pi)) {
    out.push_back({*found, fmt::format("no unit is named; rad is assumed: it turns by {:.3g} rad", span), false, {}});
    return;
  }
  out.push_back({*found,
                 fmt::format("no unit is named, and in rad it turns by {:.3g}, more than once round: put the scale: "
                             "{:.9g} for deg, 1 for rad",
                             span, std::numbers::pi / 180.0),
                 true,
                 {*found}});
}

// Without the straight line over time: two things that merely drift go together and say nothing of each other.
void remove_trend(const Series& t_s, Series& values) {
  const auto n = static_cast<double>(values.size());
  double mean = 0.0, middle_s = 0.0, slope = 0.0, square = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) mean += values[i] / n, middle_s += t_s[i] / n;
  for (std::size_t i = 0; i < values.size(); ++i) {
    slope += (t_s[i] - middle_s) * (values[i] - mean);
    square += (t_s[i] - middle_s) * (t_s[i] - middle_s);
  }
  for (std::size_t i = 0; i < values.size(); ++i) values[i] -= mean + slope / square * (t_s[i] - middle_s);
}

double largest_from(const std::vector<Vec3>& f, const Vec3& free) {
  double most = 0.0;
  for (const Vec3& v : f) most = std::max(most, (v - free).norm());
  return most;
}

// The force of a free probe, which is the one that most samples are near: that of an end, or the median.
Vec3 free_force(const std::vector<Vec3>& f) {
  Vec3 median;
  for (const int axis : {0, 1, 2}) {
    Series values;
    for (const Vec3& v : f) values.push_back(v[axis]);
    median[axis] = stats::upper_median(values);
  }
  constexpr double near = 0.05;
  const double most = largest_from(f, median);
  Vec3 best = median;
  std::ptrdiff_t most_near = 0;
  for (const Vec3& candidate : {median, f.front(), f.back()}) {
    const auto count = std::ranges::count_if(f, [&](const Vec3& v) { return (v - candidate).norm() < near * most; });
    if (count > most_near) best = candidate, most_near = count;
  }
  return best;
}

// How the load changes with the position along the direction in which it pushes, N/m, by regression on all three
// coordinates of the samples under load; nothing where these do not explain it, or other directions explain it as well.
std::optional<double> slope_in_contact(const Series& t_s, const std::vector<Vec3>& f, const std::vector<Vec3>& p) {
  constexpr double pressed = 0.2, one_way = 0.7, explained = 0.8, along_itself = 0.7;
  constexpr std::size_t fewest = 20;
  const Vec3 free = free_force(f);
  const double most = largest_from(f, free);
  Series times;
  std::array<Series, 4> columns;  // x, y, z and the load
  Vec3 direction = Vec3::Zero();
  double all = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 load = f[i] - free;
    if (!(load.norm() > pressed * most)) continue;
    for (const int axis : {0, 1, 2}) columns[static_cast<std::size_t>(axis)].push_back(p[i][axis]);
    columns[3].push_back(load.norm());
    times.push_back(t_s[i]);
    direction += load, all += load.norm();
  }
  if (times.size() < fewest || !(direction.norm() > one_way * all)) return std::nullopt;
  direction.normalize();
  // What is left beside the trend must be more than rounding.
  constexpr double rounding = 1e-6;
  Eigen::MatrixXd a(static_cast<Eigen::Index>(times.size()), 4);
  for (std::size_t c = 0; c < 4; ++c) {
    const auto [low, high] = std::ranges::minmax(columns[c]);
    const double least = rounding * (high - low);
    remove_trend(times, columns[c]);
    const auto at = static_cast<Eigen::Index>(c);
    a.col(at) = Eigen::Map<const Eigen::VectorXd>(columns[c].data(), a.rows());
    if (a.col(at).cwiseAbs().maxCoeff() <= least) a.col(at).setZero();
  }
  const Eigen::VectorXd load = a.col(3);
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(rounding);
  const Vec3 gradient = solver.compute(a.leftCols(3)).solve(load);
  const double left = (load - a.leftCols(3) * gradient).squaredNorm(), slope = gradient.dot(direction);
  if (!(load.squaredNorm() > 0.0) || !(left < (1.0 - explained) * load.squaredNorm())) return std::nullopt;
  return std::abs(slope) > along_itself * gradient.norm() ? std::optional(slope) : std::nullopt;
}

struct Energy {
  Vec3 given_J = Vec3::Zero();  // by the object, along each axis
  double moved_J = 0.0;         // sum of |F . dp|
};

// Nothing where the forces at both ends differ, for then the object may give back what it had; nor where a bias may
// have done the work.
std::optional<Energy> energy_given(const std::vector<Vec3>& f, const std::vector<Vec3>& p) {
  constexpr double small = 0.1;
  const Vec3 free = 0.5 * (f.front() + f.back());
  if (!((f.front() - free).norm() < small * largest_from(f, free))) return std::nullopt;
  Energy energy;
  for (std::size_t i = 1; i < p.size(); ++i) {
    const Vec3 work = (0.5 * (f[i] + f[i - 1]) - free).cwiseProduct(p[i] - p[i - 1]);
    energy.given_J += work;
    energy.moved_J += std::abs(work.sum());
  }
  if (!(std::abs(free.dot(p.back() - p.front())) <= small * energy.moved_J)) return std::nullopt;
  return energy;
}

// Which change makes the object take the most energy.
std::string what_would_take_energy(const Energy& energy) {
  const double all = -energy.given_J.sum();
  double best = all;
  std::string text = "put \"force_sign\": -1 if they are forces BY the probe";
  for (const int axis : {0, 1, 2}) {
    const double flipped = energy.given_J.sum() - 2.0 * energy.given_J[axis];
    if (!(flipped < best)) continue;
    best = flipped;
    text = fmt::format(
        "the {0} axis may be mirrored: put \"scale\": -1 for {0}, or \"force_sign\": -1 if they are forces "
        "BY the probe",
        "xyz"[axis]);
  }
  return text;
}

// A recording that was begun anew in the same file, and samples that share a stamp.
void judge_clock(const Series& t_s, std::vector<NumberFinding>& out) {
  if (const auto same = std::ranges::adjacent_find(t_s); same != t_s.end()) {
    out.push_back(
        {"t_s",
         fmt::format("samples {0} and {1} have one time, {2:.6g} s: a recording has one sample at a time: put "
                     "their rate, as {{\"row_rate_Hz\": ...}}, if they came evenly",
                     same - t_s.begin() + 1, same - t_s.begin() + 2, *same),
         true,
         {}});
  }
  const auto back = std::ranges::adjacent_find(t_s, std::greater<>());
  if (back == t_s.end()) return;
  out.push_back(
      {"t_s",
       fmt::format("time goes back from {:.6g} s to {:.6g} s at sample {}: take the samples of one clock with "
                   "\"rows\": {{\"from_s\": ..., \"to_s\": ...}} or, of several segments, {{\"where\": "
                   "{{\"segment\": 0}}}}",
                   *back, *std::next(back), back - t_s.begin() + 2),
       true,
       {}});
}

void judge_passivity(const Series& t_s, const Vectors& p, const Vectors& f, std::vector<NumberFinding>& out) {
  constexpr std::size_t fewest = 20;
  if (p.values.size() < fewest || f.values.size() != p.values.size() || !(f.span() > 0.0) || !(p.span() > 0.0)) return;
  const std::string about = f.text();
  if (const auto slope = slope_in_contact(t_s, f.values, p.values)) {
    constexpr double softest_N_per_m = 20.0, hardest_N_per_m = 1e7;
    const double stiffness = std::abs(*slope);
    if (*slope > 0.0) {
      out.push_back(
          {about,
           fmt::format("the load grows by {:.3g} N/m along the way that it pushes, where an object would push "
                       "back: put \"force_sign\": -1 if they are forces BY the probe, or \"scale\": -1 for "
                       "{} if it is a depth",
                       stiffness, p.axes == 1 ? p.names.front() : "the axis that is mirrored"),
           true,
           {},
           true});
      return;
    }
    if ((p.assumed || f.assumed) && (stiffness < softest_N_per_m || stiffness > hardest_N_per_m)) {
      out.push_back({p.text() + ", " + about,
                     fmt::format("no unit is named, and in m and N the object would have {:.3g} N/m: put the scale of "
                                 "the positions (0.001 for mm) or of the forces (0.001 for mN)",
                                 stiffness),
                     true, p.assumed ? p.names : f.names});
      return;
    }
    out.push_back({about,
                   fmt::format("the load falls by {:.3g} N/m along the way that it pushes, as that ON a probe "
                               "does",
                               stiffness),
                   false,
                   {},
                   true});
    return;
  }
  const auto energy = energy_given(f.values, p.values);
  constexpr double clear = 0.3;
  if (!energy || !(std::abs(energy->given_J.sum()) > clear * energy->moved_J)) return;
  const double given = energy->given_J.sum();
  if (given < 0.0) {
    out.push_back(
        {about,
         fmt::format("the object takes {:.3g} J, as a passive one does: they are forces ON the probe", -given),
         false,
         {},
         true});
    return;
  }
  out.push_back({about,
                 fmt::format("as they stand the object gives {:.3g} J of {:.3g} J, which none does: {}", given,
                             energy->moved_J, what_would_take_energy(*energy)),
                 true,
                 {},
                 true});
}

double spread_of(const std::vector<Vec3>& values) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& v : values) mean += v / static_cast<double>(values.size());
  double square = 0.0;
  for (const Vec3& v : values) square += (v - mean).squaredNorm() / static_cast<double>(values.size());
  return std::sqrt(square);
}

// A weight keeps its direction in the object's frame: where the force is steadier after it is turned by the
// orientation, it stands in the sensor's.
void judge_frame(const Imported& read, const Vectors& f, std::vector<NumberFinding>& out) {
  const auto first = std::ranges::find(read.names, std::string("qw"));
  if (first == read.names.end() || f.axes != 3) return;
  const auto at = static_cast<std::size_t>(first - read.names.begin());
  constexpr double steadier = 0.5;
  double turned = 0.0;
  std::vector<Vec3> by_sensor;
  std::optional<Quat> start;
  for (std::size_t i = 0; i < f.values.size(); ++i) {
    const Quat q(read.columns[at][i], read.columns[at + 1][i], read.columns[at + 2][i], read.columns[at + 3][i]);
    if (!start) start = q;
    turned = std::max(turned, start->angularDistance(q));
    by_sensor.push_back(q * f.values[i]);
  }
  // Where turning the force by the orientation changes it little, either frame will do.
  double moved = 0.0, square = 0.0;
  for (std::size_t i = 0; i < by_sensor.size(); ++i) {
    moved += (by_sensor[i] - f.values[i]).squaredNorm(), square += f.values[i].squaredNorm();
  }
  constexpr double little = 0.05;
  if (!(std::sqrt(moved) > little * std::sqrt(square))) return;
  const double as_it_stands = spread_of(f.values), as_turned = spread_of(by_sensor);
  const std::string figures = fmt::format(
      "the orientation turns by {:.3g} rad; turned by it the force varies by {:.3g} "
      "N, as it stands by {:.3g} N",
      turned, as_turned, as_it_stands);
  const bool object = as_it_stands < steadier * as_turned, sensor = as_turned < steadier * as_it_stands;
  out.push_back({"force_frame",
                 object ? "the object's: " + figures
                 : sensor
                     ? figures + ", as that of a sensor's frame does: put \"force_frame\": \"sensor\", or \"object\""
                     : "no name states it, and the numbers do not tell: put \"object\", or \"sensor\" if the force is "
                       "in the frame of a sensor that turns with the probe: " +
                           figures,
                 !object,
                 {}});
}

}  // namespace

std::vector<NumberFinding> number_evidence(const Imported& read, const std::set<std::string>& unit_assumed,
                                           bool static_poses) {
  std::vector<NumberFinding> out;
  const Series t_s = read.names.front() == "t_s" ? read.columns.front() : Series{};
  const Vectors p = vectors_of(read, unit_assumed, {"x_", "y_", "z_"}, "m");
  const Vectors f = vectors_of(read, unit_assumed, {"fx_", "fy_", "fz_"}, "N");
  const Vectors torque = vectors_of(read, unit_assumed, {"tx_", "ty_", "tz_"}, "N.m");
  judge_clock(t_s, out);
  judge_positions(p, t_s, out);
  judge_forces(f, out);
  judge_torques(torque, f, out);
  judge_angle(read, unit_assumed, out);
  const bool open = std::ranges::any_of(out, &NumberFinding::contradicts);
  // In units that are not certain neither stiffness nor weight means anything.
  if (!open && !t_s.empty()) judge_passivity(t_s, p, f, out);
  if (!open && !static_poses) judge_frame(read, f, out);
  return out;
}

}  // namespace touchstone::importing
