#include "pose_faults.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "harness/stats/quantile.h"
#include "smoothing.h"

namespace touchstone::acquisition {
namespace {

constexpr double most_m_per_s2 = 25.0;   // of a hand, as the header derives it
constexpr double clear_of_noise = 12.0;  // what stands out has sqrt(5) of it in each component; of 1e5 the largest 11.6
constexpr double stands_out = 2.5;       // times the second largest of the six steps around
constexpr double longest_swap_s = 0.5;
constexpr double clear_of_hold = 6.0;  // times the noise: what a pose that was held may be off without harm
constexpr double median_of_chi3 = 1.538;

bool repeats(const std::vector<Vec3>& p, const std::vector<Quat>& q, std::size_t i) {
  return p[i] == p[i - 1] && q[i].coeffs() == q[i - 1].coeffs();
}

// Runs of one pose, bit for bit, from which the next one is clearly off; at the end of the file there is no next one.
void find_held(const std::vector<double>& t, const std::vector<Vec3>& p, const std::vector<Quat>& q,
               PoseFaults& faults) {
  for (std::size_t first = 1; first < t.size(); ++first) {
    if (!repeats(p, q, first)) continue;
    std::size_t next = first + 1;
    while (next < t.size() && repeats(p, q, next)) ++next;
    const double off = next < t.size() ? (p[next] - p[first]).norm() : 0.0;
    if (off > clear_of_hold * faults.noise_m) {
      faults.held.push_back({t[first], t[next - 1], off});
      for (std::size_t i = first; i < next; ++i) faults.measured[i] = false;
    }
    first = next;
  }
}

// The step from pose k to k + 1 less what its neighbours move; 0 where it does not stand out.
double jump_at(const std::vector<double>& t, const std::vector<Vec3>& p, std::size_t k, double interval_s) {
  std::array<double, 6> around{};
  std::size_t n = 0;
  for (std::size_t i = k - 3; i <= k + 3; ++i) {
    if (t[i + 1] - t[i] > 1.8 * interval_s) return 0.0;  // a gap
    if (i != k) around[n++] = (p[i + 1] - p[i]).norm();
  }
  std::ranges::sort(around, std::greater<>());
  const double step = (p[k + 1] - p[k]).norm();
  if (!(step > stands_out * around[1])) return 0.0;
  return (p[k + 1] - p[k] - 0.5 * (p[k] - p[k - 1] + p[k + 2] - p[k + 1])).norm();
}

}  // namespace

double tip_noise_m(const std::vector<Vec3>& tip_m) {
  std::vector<double> thirds;
  for (std::size_t i = 3; i < tip_m.size(); ++i)
    thirds.push_back((tip_m[i] - 3 * tip_m[i - 1] + 3 * tip_m[i - 2] - tip_m[i - 3]).norm());
  return thirds.empty() ? 0.0 : stats::upper_median(std::move(thirds)) / (median_of_chi3 * std::sqrt(20.0));
}

PoseFaults find_pose_faults(const std::vector<double>& t_s, const std::vector<Vec3>& tip_m,
                            const std::vector<Quat>& q) {
  PoseFaults faults;
  faults.measured.assign(t_s.size(), true);
  faults.noise_m = tip_noise_m(tip_m);
  if (t_s.size() < 8) return faults;
  find_held(t_s, tip_m, q, faults);
  std::vector<std::size_t> index;
  std::vector<double> t;
  std::vector<Vec3> p;
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    if (faults.measured[i]) index.push_back(i), t.push_back(t_s[i]), p.push_back(tip_m[i]);
  }
  if (t.size() < 8) return faults;
  const double interval = sample_interval_s(t);
  const double smallest = std::max(clear_of_noise * faults.noise_m, most_m_per_s2 * interval * interval / 4.0);
  std::vector<std::size_t> jumps;
  for (std::size_t k = 3; k + 4 < t.size(); ++k) {
    if (jump_at(t, p, k, interval) > smallest) jumps.push_back(k);
  }
  for (std::size_t j = 0; j < jumps.size(); ++j) {
    const std::size_t there = jumps[j];
    const double off = (p[there + 1] - p[there]).norm();
    const std::size_t back = j + 1 < jumps.size() ? jumps[j + 1] : there;
    const Vec3 both = p[there + 1] - p[there] + p[back + 1] - p[back];
    if (back == there || t[back] - t[there] > longest_swap_s || both.norm() > 0.5 * off) {
      faults.jumped.push_back({t[there], t[there + 1], off});
      continue;
    }
    faults.swapped.push_back({t[there + 1], t[back], off});
    for (std::size_t i = index[there + 1]; i <= index[back]; ++i) faults.measured[i] = false;
    ++j;
  }
  return faults;
}

}  // namespace touchstone::acquisition
