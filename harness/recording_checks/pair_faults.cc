#include "harness/recording_checks/pair_faults.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "harness/base/signed_order.h"
#include "harness/recording_checks/at_times.h"

namespace touchstone::recording_checks {
using recording::Recording;

namespace {

constexpr double most_left_of_pair = 0.5;
constexpr double clearly_less = 0.9;
constexpr double widest_shift_s = 1.0;
constexpr std::size_t fewest_pairs = 50;
constexpr std::size_t most_looked_at = 4000;

// RMS of the difference at the times of `expected`, of the forces as `read` reads them; infinite where the two hardly
// overlap. `part`: 0 the whole, 1 and 2 its halves.
template <class Read>
double force_difference_N(const Recording& expected, const Recording& obtained, double shift_s, int part,
                          const Read& read) {
  AtTimes there(obtained);
  const std::size_t stride = expected.size() / most_looked_at + 1;
  const std::size_t half = expected.size() / 2;
  double square = 0.0;
  std::size_t n = 0;
  for (std::size_t i = part == 2 ? half : 0; i < (part == 1 ? half : expected.size()); i += stride) {
    if (!there.find(expected.motion.t_s[i] + shift_s)) continue;
    square += (expected.f_W_N[i] - read(there)).squaredNorm();
    ++n;
  }
  if (n < fewest_pairs) return std::numeric_limits<double>::infinity();
  return std::sqrt(square / static_cast<double>(n));
}

Vec3 as_recorded(const AtTimes& at) { return at.force_N(); }

struct PairReading {
  RecordingFault fault;
  const char* meaning;
  const char* repair;
  bool needs_orientation;
  Vec3 (*read)(const AtTimes& at);
};

constexpr std::array pair_readings{
    PairReading{RecordingFault::reversed_force, "its force is the other's reversed",
                R"(give --flip-force, or read it with `touchstone import` and "force_sign": -1 in the map)", false,
                [](const AtTimes& at) -> Vec3 { return -at.force_N(); }},
    PairReading{RecordingFault::force_frame, "its force is in the sensor's frame",
                R"(read it with `touchstone import` and "force_frame": "sensor" in the map)", true,
                [](const AtTimes& at) -> Vec3 { return at.orientation() * at.force_N(); }},
    PairReading{RecordingFault::force_frame,
                "its force was turned by the orientation although it was in the object's frame",
                R"(read it with `touchstone import` and "force_frame": "inverse" in the map)", true,
                [](const AtTimes& at) -> Vec3 { return at.orientation().conjugate() * at.force_N(); }},
};

std::optional<RecordingFinding> other_reading(const Recording& expected, const Recording& obtained, double before_N) {
  std::optional<RecordingFinding> found;
  double least = most_left_of_pair * before_N;
  for (const PairReading& reading : pair_readings) {
    if (reading.needs_orientation && obtained.motion.q_WS.size() != obtained.size()) continue;
    const double after = force_difference_N(expected, obtained, 0.0, 0, reading.read);
    if (!(after < least)) continue;
    least = after;
    found = RecordingFinding{FaultWeight::fault, reading.fault,
                             fmt::format("{}: read so, the forces differ by {:.3g} N instead of {:.3g} N (RMS)",
                                         reading.meaning, after, before_N),
                             reading.repair};
  }
  if (found) return found;
  for (const SignedOrder& order : signed_orders()) {
    if (order.as_it_stands() || order.reversed()) continue;
    const double after = force_difference_N(expected, obtained, 0.0, 0,
                                            [&](const AtTimes& at) -> Vec3 { return order.applied(at.force_N()); });
    // The plainest first: of equals it stays.
    if (!(after < (found ? clearly_less * least : least))) continue;
    least = after;
    found = RecordingFinding{FaultWeight::fault, RecordingFault::force_frame,
                             fmt::format("{}: read so, the forces differ by {:.3g} N instead of {:.3g} N (RMS)",
                                         order.meaning(), after, before_N),
                             "correct these columns of the file"};
  }
  return found;
}

std::optional<RecordingFinding> shifted(const Recording& expected, const Recording& obtained, double before_N) {
  const double interval_s = (expected.motion.t_s.back() - expected.motion.t_s.front()) /
                            static_cast<double>(std::max<std::size_t>(1, expected.size() - 1));
  const auto difference = [&](double shift_s, int part) {
    return force_difference_N(expected, obtained, shift_s, part, as_recorded);
  };
  double shift_s = 0.0, least = before_N;
  double reach_s = widest_shift_s;
  for (double step_s = 0.01; step_s > 0.2 * interval_s; reach_s = step_s, step_s /= 5.0) {
    const double centre_s = shift_s;
    const int steps = static_cast<int>(std::ceil(reach_s / step_s));
    for (int k = -steps; k <= steps; ++k) {
      const double at_s = centre_s + k * step_s;
      const double left = difference(at_s, 0);
      if (left < least) least = left, shift_s = at_s;
    }
  }
  if (!(least < most_left_of_pair * before_N) || !(std::abs(shift_s) > 2.0 * interval_s)) return std::nullopt;
  for (const int part : {1, 2}) {
    if (!(difference(shift_s, part) < difference(0.0, part))) return std::nullopt;
  }
  return RecordingFinding{
      FaultWeight::fault, RecordingFault::clock,
      fmt::format("its force comes {:.3g} s {}: shifted by it, the forces differ by {:.3g} N instead of {:.3g} N (RMS)",
                  std::abs(shift_s), shift_s > 0.0 ? "later" : "earlier", least, before_N),
      fmt::format("read it with `touchstone import` and \"shift_force_s\": {:.4g} in the map", -shift_s)};
}

std::optional<RecordingFinding> other_unit(const Recording& expected, const Recording& obtained) {
  const auto difference_m = [&](double factor) {
    AtTimes there(obtained);
    double square = 0.0;
    std::size_t n = 0;
    for (std::size_t i = 0; i < expected.size(); i += expected.size() / most_looked_at + 1) {
      if (!there.find(expected.motion.t_s[i])) continue;
      square += (expected.motion.p_W_m[i] - factor * there.position_m()).squaredNorm();
      ++n;
    }
    return n < fewest_pairs ? std::numeric_limits<double>::infinity() : std::sqrt(square / static_cast<double>(n));
  };
  const double before_m = difference_m(1.0);
  for (const double factor : {1e-3, 1e3, 1e-2, 1e2}) {
    const double after_m = difference_m(factor);
    if (!(after_m < most_left_of_pair * most_left_of_pair * before_m)) continue;
    return RecordingFinding{
        FaultWeight::fault, RecordingFault::position_unit,
        fmt::format("its positions are {:g} times too large: divided by it, they differ by {:.3g} m instead of {:.3g} "
                    "m (RMS)",
                    1.0 / factor, after_m, before_m),
        "name its columns by their unit (x_mm, x_m)"};
  }
  return std::nullopt;
}

// Whether the two go the same way at the same times, wherever they are: else their forces differ by the hand, and any
// other reading may happen to lie nearer.
bool one_motion(const Recording& expected, const Recording& obtained) {
  AtTimes there(obtained);
  std::vector<Vec3> own_m, apart_m;
  for (std::size_t i = 0; i < expected.size(); i += expected.size() / most_looked_at + 1) {
    if (!there.find(expected.motion.t_s[i])) continue;
    own_m.push_back(expected.motion.p_W_m[i]);
    apart_m.push_back(there.position_m() - expected.motion.p_W_m[i]);
  }
  const auto squares_m2 = [](const std::vector<Vec3>& places_m) {
    Vec3 mean_m = Vec3::Zero();
    for (const Vec3& p : places_m) mean_m += p / static_cast<double>(places_m.size());
    double sum = 0.0;
    for (const Vec3& p : places_m) sum += (p - mean_m).squaredNorm();
    return sum;
  };
  return squares_m2(apart_m) <= most_left_of_pair * most_left_of_pair * squares_m2(own_m);
}

}  // namespace

std::vector<RecordingFinding> find_pair_faults(const Recording& expected, const Recording& obtained) {
  std::vector<RecordingFinding> findings;
  const auto whole = [](const Recording& r) { return r.size() >= fewest_pairs && r.f_W_N.size() == r.size(); };
  if (!whole(expected) || !whole(obtained)) return findings;
  const auto add = [&](std::optional<RecordingFinding> finding) {
    if (finding) findings.push_back(std::move(*finding));
  };
  add(other_unit(expected, obtained));
  if (!one_motion(expected, obtained)) return findings;
  const double before_N = force_difference_N(expected, obtained, 0.0, 0, as_recorded);
  if (!std::isfinite(before_N) || !(before_N > 0.0)) return findings;
  // What explains more is named alone: a shift by half of a period looks like a reversed force.
  auto reading = other_reading(expected, obtained, before_N);
  if (reading) {
    add(std::move(reading));
  } else {
    add(shifted(expected, obtained, before_N));
  }
  return findings;
}

}  // namespace touchstone::recording_checks
