#include "slide_windows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/base/error.h"
#include "harness/stats/quantile.h"

namespace touchstone::texture {
using recording::Recording;

namespace {

constexpr double slide_window_s = 0.256;  // as in perceive's vibration
constexpr double smoothing_s = 0.1;
constexpr double slides_m_per_s = 0.005;  // slower is a hand at rest, as in perceive
constexpr double touches_N = 0.02;
constexpr double even = 0.2;       // largest standard deviation of speed and load in a window, over their means
constexpr double one_rate = 0.05;  // largest difference of an interval from the median, over that
constexpr double least_rate_Hz = 100.0;

// Throws BadData for what nobody measured, whose powers would be no numbers.
void check_forces(const Recording& recording) {
  constexpr double most_force_N = 1e9;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const double force_N = recording.f_W_N[i].cwiseAbs().maxCoeff();
    if (force_N <= most_force_N) continue;
    throw BadData(
        fmt::format("{}: sample {} (t = {:.6g} s) has a force of {:.3g} N; at most {:g} N were expected: "
                    "remove or repair the sample, or name the unit in the header",
                    recording.source, i + 1, recording.motion.t_s[i], force_N, most_force_N));
  }
}

// The median interval. Throws BadData for one that differs.
double interval_s(const Recording& recording) {
  const std::vector<double>& t = recording.motion.t_s;
  if (t.size() < 3) throw BadData(fmt::format("{}: has {} samples", recording.source, t.size()));
  std::vector<double> intervals;
  for (std::size_t i = 1; i < t.size(); ++i) intervals.push_back(t[i] - t[i - 1]);
  const double median = stats::median(intervals);
  for (std::size_t i = 1; i < t.size(); ++i) {
    if (std::abs(t[i] - t[i - 1] - median) <= one_rate * median) continue;
    throw BadData(
        fmt::format("{}: sample {} (t = {:.6g} s) comes {:.4g} ms after the one before, the others {:.4g} ms: a "
                    "spectrum needs one rate; give a part of the recording without holes",
                    recording.source, i + 1, t[i], 1e3 * (t[i] - t[i - 1]), 1e3 * median));
  }
  return (t.back() - t.front()) / static_cast<double>(t.size() - 1);
}

// Hann-weighted means; at the ends of what there is.
std::vector<Vec3> smooth(const std::vector<Vec3>& x, double rate_Hz) {
  const auto reach = static_cast<std::ptrdiff_t>(std::round(0.5 * smoothing_s * rate_Hz));
  const auto n = static_cast<std::ptrdiff_t>(x.size());
  std::vector<double> weights;
  for (std::ptrdiff_t k = -reach; k <= reach; ++k)
    weights.push_back(0.5 + 0.5 * std::cos(std::numbers::pi * static_cast<double>(k) / static_cast<double>(reach + 1)));
  std::vector<Vec3> result(x.size());
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    // As far to both sides: else the mean at an end would be one of another time.
    const std::ptrdiff_t far = std::min({reach, i, n - 1 - i});
    Vec3 sum = Vec3::Zero();
    double weight = 0.0;
    for (std::ptrdiff_t k = -far; k <= far; ++k) {
      const double w = weights[static_cast<std::size_t>(k + reach)];
      sum += w * x[static_cast<std::size_t>(i + k)];
      weight += w;
    }
    result[static_cast<std::size_t>(i)] = sum / weight;
  }
  return result;
}

// Each sample as the hand made it.
struct Sliding {
  std::vector<double> speed_m_per_s;
  std::vector<double> load_N;  // smooth
  // Measured, along the normal, against the motion and across it: in this frame friction and load are slow however the
  // path bends.
  std::array<std::vector<double>, 3> force_N;
};

Sliding sliding_of(const Recording& recording, const Vec3& normal_W, double rate_Hz) {
  const std::vector<Vec3> p = smooth(recording.motion.p_W_m, rate_Hz);
  const std::vector<Vec3> f = smooth(recording.f_W_N, rate_Hz);
  Sliding sliding;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1;
    const std::size_t after = std::min(i + 1, p.size() - 1);
    Vec3 v = (p[after] - p[before]) * rate_Hz / static_cast<double>(after - before);
    v -= v.dot(normal_W) * normal_W;
    sliding.speed_m_per_s.push_back(v.norm());
    sliding.load_N.push_back(f[i].dot(normal_W));
    const Vec3 against = v.norm() > 0.0 ? Vec3(-v.normalized()) : Vec3(Vec3::Zero());
    const Vec3& measured = recording.f_W_N[i];
    sliding.force_N[0].push_back(measured.dot(normal_W));
    sliding.force_N[1].push_back(measured.dot(against));
    sliding.force_N[2].push_back(measured.dot(against.cross(normal_W)));
  }
  return sliding;
}

struct Evenness {
  double mean = 0.0;
  double share = 0.0;  // standard deviation over the mean
  double least = 0.0;
};

Evenness evenness(const std::vector<double>& x, std::size_t first, std::size_t length) {
  Evenness result;
  const auto begin = x.begin() + static_cast<std::ptrdiff_t>(first);
  const auto end = begin + static_cast<std::ptrdiff_t>(length);
  for (auto at = begin; at != end; ++at) result.mean += *at / static_cast<double>(length);
  double squares = 0.0;
  for (auto at = begin; at != end; ++at) squares += (*at - result.mean) * (*at - result.mean);
  result.share = std::sqrt(squares / static_cast<double>(length)) / std::abs(result.mean);
  result.least = *std::min_element(begin, end);
  return result;
}

}  // namespace

std::vector<double> without_parabola(const std::vector<double>& x, std::size_t first, std::size_t length) {
  Eigen::MatrixXd slow(length, 3);
  Eigen::VectorXd left(length);
  for (std::size_t i = 0; i < length; ++i) {
    const double u = 2.0 * static_cast<double>(i) / static_cast<double>(length - 1) - 1.0;
    const auto row = static_cast<Eigen::Index>(i);
    slow.row(row) << 1.0, u, u * u;
    left[row] = x[first + i];
  }
  const Eigen::Vector3d fitted = (slow.transpose() * slow).ldlt().solve(slow.transpose() * left);
  left -= slow * fitted;
  return {left.begin(), left.end()};
}

SlideWindows slide_windows(const Recording& recording, const Vec3& normal_W, double step_share) {
  SlideWindows result;
  result.source = recording.source;
  check_forces(recording);
  result.rate_Hz = 1.0 / interval_s(recording);
  if (result.rate_Hz < least_rate_Hz) {
    throw BadData(fmt::format("{}: {:.4g} samples per second; a texture is felt from 20 Hz on, and {:g} are needed",
                              recording.source, result.rate_Hz, least_rate_Hz));
  }
  const Vec3 normal = normal_W.normalized();
  const Sliding sliding = sliding_of(recording, normal, result.rate_Hz);
  const auto length = static_cast<std::size_t>(std::round(slide_window_s * result.rate_Hz));
  const auto step =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::round(step_share * static_cast<double>(length))));
  result.window_s = static_cast<double>(length) / result.rate_Hz;
  double fastest = 0.0, hardest_N = 0.0;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    fastest = std::max(fastest, sliding.speed_m_per_s[i]);
    hardest_N = std::max(hardest_N, sliding.load_N[i]);
    if (sliding.speed_m_per_s[i] >= slides_m_per_s && sliding.load_N[i] >= touches_N)
      result.sliding_s += 1.0 / result.rate_Hz;
  }
  for (std::size_t first = 0; first + length <= recording.size(); first += step) {
    const Evenness speed = evenness(sliding.speed_m_per_s, first, length);
    const Evenness load = evenness(sliding.load_N, first, length);
    if (!(speed.least >= slides_m_per_s && load.least >= touches_N && speed.share <= even && load.share <= even))
      continue;
    SlideWindow window{
        recording.motion.t_s[first], speed.mean, load.mean, evenness(sliding.force_N[1], first, length).mean, {}};
    for (std::size_t axis = 0; axis < 3; ++axis)
      window.fast_N[axis] = without_parabola(sliding.force_N[axis], first, length);
    result.windows.push_back(std::move(window));
  }
  if (result.windows.empty()) {
    throw BadData(
        fmt::format("{}: nowhere slides the tip for {:.3g} s at a speed and a normal force that vary by less than "
                    "{:.0f} %: it slides "
                    "for {:.3g} s, at up to {:.4g} mm/s and with up to {:.4g} N along the normal ({:g}, {:g}, {:g}). "
                    "Press with more "
                    "than {:g} N, stroke faster than {:g} mm/s, give --normal if the sample does not face +z, and "
                    "--flip-force if the "
                    "file has the force BY the probe",
                    recording.source, slide_window_s, 100.0 * even, result.sliding_s, 1e3 * fastest, hardest_N,
                    normal.x(), normal.y(), normal.z(), touches_N, 1e3 * slides_m_per_s));
  }
  return result;
}

}  // namespace touchstone::texture
