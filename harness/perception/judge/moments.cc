#include "harness/perception/judge/moments.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/base/vec.h"
#include "harness/perception/judge/slow_channels.h"

namespace touchstone::perception {

std::vector<FeltMoment> felt_moments(const JudgedProcess& real, const JudgedProcess& rendered, bool same_motion,
                                     const Thresholds& thresholds) {
  std::vector<FeltMoment> moments;
  const FeltSeries& felt = rendered.felt;
  const auto length = static_cast<std::size_t>(std::max(4.0, std::round(moment_s * felt.rate_Hz)));
  const double deepest = real.response->deepest_m;
  for (std::size_t first = 0; first + length <= felt.size(); first += length) {
    Vec3 expected = Vec3::Zero();
    Vec3 given = Vec3::Zero();
    double used = 0.0;
    double depth_m = 0.0;
    for (std::size_t i = first; i < first + length; ++i) {
      const double d = felt.depth_m[i] - rendered.contact.depth_m;
      // Beyond the real process's deepest press nothing is known of it.
      if (!(d >= 0.0) || (!same_motion && d > deepest)) continue;
      if (same_motion) {
        expected += Vec3(real.felt.force_N[0][i], real.felt.force_N[1][i], real.felt.force_N[2][i]);
      } else {
        const auto e = expected_force_N(*real.response, felt, rendered.contact.depth_m, i);
        expected += Vec3(e[0], e[1], e[2]);
      }
      given += Vec3(felt.force_N[0][i], felt.force_N[1][i], felt.force_N[2][i]);
      depth_m += d;
      used += 1.0;
    }
    if (used < 0.5 * static_cast<double>(length)) continue;
    expected /= used;
    given /= used;
    const Vec3 apart = given - expected;
    FeltMoment moment;
    moment.sample = first + length / 2;
    moment.t_s = felt.t_s(moment.sample);
    // The difference of the vectors, as a change of a force as large as the larger of the two.
    const NoticeableSteps steps(thresholds.force);
    const double larger = std::max(expected.norm(), given.norm());
    const double smaller = std::max(0.0, larger - apart.norm());
    moment.sideways_share = apart.squaredNorm() > 0.0 ? 1.0 - apart.x() * apart.x() / apart.squaredNorm() : 0.0;
    // An error of the depth looks like a force along the direction of pressing, not like one across.
    const double exponent = std::sqrt(1.0 - moment.sideways_share) *
                            depth_exponent(real.response->curves, depth_m / used, 0.1 * deepest, real.response->grid);
    moment.jnd = force_at_depth_jnd(steps(larger) - steps(smaller), larger, smaller, exponent, thresholds);
    moments.push_back(moment);
  }
  return moments;
}

double noticed_share(const std::vector<FeltMoment>& moments) {
  if (moments.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto noticed = std::count_if(moments.begin(), moments.end(), [](const auto& m) { return m.jnd > 1.0; });
  return static_cast<double>(noticed) / static_cast<double>(moments.size());
}

}  // namespace touchstone::perception
