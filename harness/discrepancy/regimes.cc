#include "harness/discrepancy/regimes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <tuple>

#include "harness/stats/quantile.h"

namespace touchstone::discrepancy {
using recording::Recording;
using rendering::Prediction;

namespace {

constexpr double onset_s = 0.05;  // "first contact" lasts this long
constexpr double smoothing_s = 0.05;
constexpr std::array speed_edges_mm_per_s{5.0, 20.0, 50.0, 100.0, 200.0};

// What the tip does at each sample, from positions smoothed over the tracker's noise.
struct Motion {
  std::vector<bool> contact;
  std::vector<double> since_onset_s;
  std::vector<double> tangential_m_per_s;
  std::vector<double> normal_m_per_s;  // positive: leaving
  std::vector<bool> reversal;
  std::vector<double> load_N;
};

// Which samples the measured force alone tells to be in contact, whatever the model says: those whose force differs
// from what the sensor shows in free air. That is what the model says, or more by a constant (a tool whose weight the
// model lacks): of the two the one that more of the model's free samples agree with.
std::vector<bool> pressed_by_force(const Recording& recording, const Prediction& after, double force_floor_N) {
  const std::size_t n = recording.size();
  std::array<std::vector<double>, 3> free_N;
  for (std::size_t i = 0; i < n; ++i) {
    if (!after.n_W[i].isZero()) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      free_N[axis].push_back(recording.f_W_N[i][a] - after.f_W_N[i][a]);
    }
  }
  Vec3 constant_W_N = Vec3::Zero();
  for (std::size_t axis = 0; axis < 3 && !free_N[axis].empty(); ++axis) {
    constant_W_N[static_cast<Eigen::Index>(axis)] = stats::upper_median(std::move(free_N[axis]));
  }
  const auto differs = [&](std::size_t i, const Vec3& free_W_N) {
    return (recording.f_W_N[i] - after.f_W_N[i] - free_W_N).norm() > force_floor_N;
  };
  std::size_t agree = 0;
  std::size_t agree_with_constant = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!after.n_W[i].isZero()) continue;
    agree += differs(i, Vec3::Zero()) ? 0 : 1;
    agree_with_constant += differs(i, constant_W_N) ? 0 : 1;
  }
  if (agree_with_constant <= agree) constant_W_N.setZero();
  std::vector<bool> pressed(n);
  for (std::size_t i = 0; i < n; ++i) pressed[i] = differs(i, constant_W_N);
  return pressed;
}

Motion describe(const Recording& recording, const Prediction& after, double force_floor_N) {
  const std::vector<bool> pressed = pressed_by_force(recording, after, force_floor_N);
  const auto& t_s = recording.motion.t_s;
  const auto& p = recording.motion.p_W_m;
  const std::size_t n = recording.size();
  Motion motion;
  motion.contact.resize(n);
  motion.since_onset_s.resize(n);
  motion.tangential_m_per_s.resize(n);
  motion.normal_m_per_s.resize(n);
  motion.reversal.resize(n);
  motion.load_N.resize(n);
  std::size_t low = 0;
  std::size_t high = 0;
  double onset = t_s.empty() ? 0.0 : t_s.front();
  std::vector<Vec3> tangential(n, Vec3::Zero());
  for (std::size_t i = 0; i < n; ++i) {
    while (t_s[low] < t_s[i] - smoothing_s) ++low;
    while (high + 1 < n && t_s[high] < t_s[i] + smoothing_s) ++high;
    motion.contact[i] = !after.n_W[i].isZero() || pressed[i];
    if (motion.contact[i] && (i == 0 || !motion.contact[i - 1])) onset = t_s[i];
    motion.since_onset_s[i] = t_s[i] - onset;
    motion.load_N[i] = recording.f_W_N[i].norm();
    if (high <= low) continue;
    const Vec3 v = (p[high] - p[low]) / (t_s[high] - t_s[low]);
    const Vec3 n_W = after.n_W[i].isZero() ? Vec3(Vec3::Zero()) : after.n_W[i];
    motion.normal_m_per_s[i] = v.dot(n_W);
    tangential[i] = v - motion.normal_m_per_s[i] * n_W;
    motion.tangential_m_per_s[i] = tangential[i].norm();
    const std::size_t earlier = low;
    motion.reversal[i] = motion.contact[i] && tangential[earlier].dot(tangential[i]) < 0.0;
  }
  return motion;
}

struct Sum {
  std::size_t samples = 0;
  double before = 0.0;
  double after = 0.0;
  std::map<long long, std::pair<double, std::size_t>> runs;  // squares and count by half second
};

class Sorter {
 public:
  void add(RegimeKind kind, const std::string& name, double t_s, double before, double after) {
    const auto key = std::pair(kind, name);
    if (!sums_.contains(key)) order_.push_back(key);
    Sum& sum = sums_[key];
    ++sum.samples;
    sum.before += before;
    sum.after += after;
    auto& run = sum.runs[static_cast<long long>(2.0 * t_s)];
    run.first += before;
    ++run.second;
  }

  [[nodiscard]] std::vector<Regime> regimes() const {
    std::map<RegimeKind, double> totals;
    for (const auto& key : order_) totals[key.first] += sums_.at(key).before;
    std::vector<Regime> all;
    for (const auto& key : order_) {
      const Sum& sum = sums_.at(key);
      const double n = static_cast<double>(sum.samples);
      Regime regime{key.second,
                    key.first,
                    sum.samples,
                    std::sqrt(sum.before / n),
                    std::sqrt(sum.after / n),
                    totals[key.first] > 0.0 ? sum.before / totals[key.first] : 0.0,
                    0.0};
      double spread = 0.0;
      for (const auto& [half_second, run] : sum.runs) {
        const double difference = run.first - static_cast<double>(run.second) * sum.before / n;
        spread += difference * difference;
      }
      // Error of the mean square over runs, carried to its root.
      if (regime.before_N > 0.0) regime.error95_N = 1.96 * std::sqrt(spread) / n / (2.0 * regime.before_N);
      all.push_back(std::move(regime));
    }
    // For a reader: kind by kind, and within each as they follow one another.
    std::stable_sort(all.begin(), all.end(), [](const Regime& a, const Regime& b) {
      const auto key = [](const Regime& r) { return std::tuple(r.kind, rank(r.name), r.name); };
      return key(a) < key(b);
    });
    return all;
  }

 private:
  static constexpr std::array phases{"free air",  "first contact", "loading", "hold",
                                     "unloading", "sliding",       "reversal"};

  template <std::size_t n>
  static std::size_t place_in(const std::array<const char*, n>& list, const std::string& name) {
    return static_cast<std::size_t>(std::find(list.begin(), list.end(), name) - list.begin());
  }

  // Phases by their list, ranges by where they begin.
  static double rank(const std::string& name) {
    const std::size_t phase = place_in(phases, name);
    if (phase < phases.size()) return static_cast<double>(phase);
    if (name.find("below") != std::string::npos) return -1.0;
    if (name.find("above") != std::string::npos) return std::numeric_limits<double>::infinity();
    const std::size_t digit = name.find_first_of("0123456789");
    return digit == std::string::npos ? 0.0 : std::strtod(name.c_str() + digit, nullptr);
  }

  std::map<std::pair<RegimeKind, std::string>, Sum> sums_;
  std::vector<std::pair<RegimeKind, std::string>> order_;
};

std::string speed_name(double speed_m_per_s) {
  const double mm_per_s = 1e3 * speed_m_per_s;
  if (mm_per_s < speed_edges_mm_per_s.front()) return "hardly sliding, below 5 mm/s";
  for (std::size_t e = 1; e < speed_edges_mm_per_s.size(); ++e) {
    if (mm_per_s < speed_edges_mm_per_s[e]) {
      return fmt::format("sliding, {:.0f}-{:.0f} mm/s", speed_edges_mm_per_s[e - 1], speed_edges_mm_per_s[e]);
    }
  }
  return fmt::format("sliding, above {:.0f} mm/s", speed_edges_mm_per_s.back());
}

std::string phase_name(const Motion& motion, std::size_t i) {
  if (!motion.contact[i]) return "free air";
  if (motion.since_onset_s[i] < onset_s) return "first contact";
  if (motion.reversal[i]) return "reversal";
  const double normal = motion.normal_m_per_s[i];
  const double still = 2e-3;
  if (std::abs(normal) < still && motion.tangential_m_per_s[i] < still) return "hold";
  if (motion.tangential_m_per_s[i] > 2.0 * std::abs(normal)) return "sliding";
  return normal < 0.0 ? "loading" : "unloading";
}

// The error's slow, middle and fast parts, by differences of running means.
void add_frequencies(Sorter& sorter, const std::vector<double>& t_s, const std::vector<Vec3>& before,
                     const std::vector<Vec3>& after) {
  const auto smooth = [&](const std::vector<Vec3>& series, double half_s) {
    std::vector<Vec3> out(series.size());
    std::size_t low = 0;
    std::size_t high = 0;
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < series.size(); ++i) {
      while (high < series.size() && t_s[high] <= t_s[i] + half_s) sum += series[high++];
      while (t_s[low] < t_s[i] - half_s) sum -= series[low++];
      out[i] = sum / static_cast<double>(high - low);
    }
    return out;
  };
  const auto slow_before = smooth(before, 0.25);
  const auto slow_after = smooth(after, 0.25);
  const auto middle_before = smooth(before, 0.04);
  const auto middle_after = smooth(after, 0.04);
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    sorter.add(RegimeKind::frequency, "below about 1 Hz", t_s[i], slow_before[i].squaredNorm(),
               slow_after[i].squaredNorm());
    sorter.add(RegimeKind::frequency, "about 1 to 6 Hz", t_s[i], (middle_before[i] - slow_before[i]).squaredNorm(),
               (middle_after[i] - slow_after[i]).squaredNorm());
    sorter.add(RegimeKind::frequency, "above about 6 Hz", t_s[i], (before[i] - middle_before[i]).squaredNorm(),
               (after[i] - middle_after[i]).squaredNorm());
  }
}

}  // namespace

const char* to_string(RegimeKind kind) {
  switch (kind) {
    case RegimeKind::phase:
      return "phase";
    case RegimeKind::direction:
      return "direction";
    case RegimeKind::sliding_speed:
      return "sliding speed";
    case RegimeKind::load:
      return "load";
    case RegimeKind::place:
      return "place";
    case RegimeKind::sensor_axis:
      return "sensor axis";
    case RegimeKind::time:
      return "time";
    case RegimeKind::frequency:
      return "frequency";
  }
  return "";
}

std::vector<Regime> sort_by_regime(const Evidence& evidence, const Prediction& before, const Prediction& after,
                                   double force_floor_N) {
  const Recording& recording = *evidence.recording;
  const Motion motion = describe(recording, after, force_floor_N);
  const auto& t_s = recording.motion.t_s;
  std::vector<double> loads;
  Box3 box;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    if (!motion.contact[i]) continue;
    loads.push_back(motion.load_N[i]);
    box.extend(recording.motion.p_W_m[i]);
  }
  std::sort(loads.begin(), loads.end());
  const auto load_at = [&](double share) {
    return loads.empty() ? 0.0 : loads[static_cast<std::size_t>(share * static_cast<double>(loads.size() - 1))];
  };
  const double light = load_at(1.0 / 3.0);
  const double heavy = load_at(2.0 / 3.0);

  Sorter sorter;
  std::vector<double> used_t_s;
  std::vector<Vec3> used_before;
  std::vector<Vec3> used_after;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    if (!evidence.part.contains(t_s[i], t_s.front())) continue;
    const Vec3 old_error = recording.f_W_N[i] - before.f_W_N[i];
    const Vec3 new_error = recording.f_W_N[i] - after.f_W_N[i];
    used_t_s.push_back(t_s[i]);
    used_before.push_back(old_error);
    used_after.push_back(new_error);
    const double b = old_error.squaredNorm();
    const double a = new_error.squaredNorm();
    sorter.add(RegimeKind::phase, phase_name(motion, i), t_s[i], b, a);
    if (motion.contact[i]) {
      sorter.add(RegimeKind::sliding_speed, speed_name(motion.tangential_m_per_s[i]), t_s[i], b, a);
      const double load = motion.load_N[i];
      sorter.add(RegimeKind::load,
                 load < light   ? fmt::format("load below {:.2g} N", light)
                 : load < heavy ? fmt::format("load {:.2g}-{:.2g} N", light, heavy)
                                : fmt::format("load above {:.2g} N", heavy),
                 t_s[i], b, a);
      const Vec3 centre = box.center();
      const Vec3& p = recording.motion.p_W_m[i];
      sorter.add(RegimeKind::place,
                 fmt::format("object's {}x, {}y", p.x() < centre.x() ? "-" : "+", p.y() < centre.y() ? "-" : "+"),
                 t_s[i], b, a);
      const Vec3& n = after.n_W[i];
      if (!n.isZero()) {
        sorter.add(RegimeKind::direction, "along the normal", t_s[i], std::pow(n.dot(old_error), 2),
                   std::pow(n.dot(new_error), 2));
        sorter.add(RegimeKind::direction, "in the tangent plane", t_s[i], b - std::pow(n.dot(old_error), 2),
                   a - std::pow(n.dot(new_error), 2));
      }
    }
    const Mat3 R_SW = recording.motion.q_WS.empty() ? Mat3(Mat3::Identity())
                                                    : Mat3(recording.motion.q_WS[i].toRotationMatrix().transpose());
    const Vec3 old_S = R_SW * old_error;
    const Vec3 new_S = R_SW * new_error;
    for (int axis = 0; axis < 3; ++axis) {
      sorter.add(RegimeKind::sensor_axis, fmt::format("sensor's {}", "xyz"[axis]), t_s[i], old_S[axis] * old_S[axis],
                 new_S[axis] * new_S[axis]);
    }
    const double into = (t_s[i] - t_s.front()) / std::max(t_s.back() - t_s.front(), 1e-300);
    sorter.add(RegimeKind::time, fmt::format("quarter {} of the time", std::min(4, 1 + static_cast<int>(4.0 * into))),
               t_s[i], b, a);
  }
  add_frequencies(sorter, used_t_s, used_before, used_after);
  return sorter.regimes();
}

std::string worsened_phase(const std::vector<Regime>& regimes, double share) {
  const auto grown = [](const Regime& regime) {
    return static_cast<double>(regime.samples) * (regime.after_N * regime.after_N - regime.before_N * regime.before_N);
  };
  double gained = 0.0;
  for (const Regime& regime : regimes) gained -= regime.kind == RegimeKind::phase ? std::min(0.0, grown(regime)) : 0.0;
  for (const Regime& regime : regimes) {
    if (regime.kind != RegimeKind::phase) continue;
    const bool clear = regime.after_N > regime.before_N + regime.error95_N;
    if (clear && grown(regime) > share * gained) return regime.name;
  }
  return "";
}

}  // namespace touchstone::discrepancy
