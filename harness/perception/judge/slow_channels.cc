#include "harness/perception/judge/slow_channels.h"

#include <algorithm>
#include <cmath>

#include "harness/base/vec.h"
#include "harness/perception/judge/growth.h"

namespace touchstone::perception {
namespace {

constexpr double slid_share = 0.05;            // of the samples at a depth: less shows no sliding there
constexpr double direction_force = 5.0;        // absolute thresholds of force that a direction needs
constexpr double bound_standard_errors = 0.5;  // standard errors of what differs by a bound at most: that is two

Vec3 static_force(const ResponseCurves& c, double d, const DepthGrid& grid, bool with_side = true) {
  if (!with_side) return {at_depth(c.normal_N, d, grid), 0.0, 0.0};
  return {at_depth(c.normal_N, d, grid), at_depth(c.side_N[0], d, grid), at_depth(c.side_N[1], d, grid)};
}

bool seen_at(const Response& r, double d) {
  const auto j = static_cast<std::size_t>(d / r.grid.spacing_m);
  return j < r.knots() && r.seen[j] > 0.0 && (j + 1 >= r.knots() || r.seen[j + 1] > 0.0);
}

// What the samples at a depth show of the force across.
struct Sliding {
  bool slides = false;
  bool to_and_fro = false;  // so that friction and a steady force across are told apart
  Vec3 towards = Vec3::Zero();
};

Sliding sliding_of(double share, const Vec3& towards) {
  const bool slides = share > slid_share;
  return {slides, slides && towards.norm() < one_way_share, towards};
}

Sliding sliding_at(const Response& r, double d) {
  return sliding_of(at_depth(r.slid, d, r.grid),
                    {0.0, at_depth(r.slid_towards[0], d, r.grid), at_depth(r.slid_towards[1], d, r.grid)});
}

// Whether the steady forces across of two processes can be compared at a depth: friction hides in them where all
// sliding went one way.
bool side_is_known(const Sliding& a, const Sliding& b) {
  return (!a.slides || a.to_and_fro) && (!b.slides || b.to_and_fro);
}

// Both slid one way, and the same: what they feel against it is compared as a whole.
bool one_way_alike(const Sliding& a, const Sliding& b) {
  return a.slides && b.slides && !a.to_and_fro && !b.to_and_fro &&
         a.towards.dot(b.towards) > one_way_share * one_way_share;
}

// What the responses of both leave at a depth (response.h): two recordings by other hands may differ by it.
struct LeftAt {
  double normal_N = 0.0;
  double side_N = 0.0;

  [[nodiscard]] double both_N() const { return std::hypot(normal_N, side_N); }
};

LeftAt left_at(const Response& real, const Response& rendered, double d) {
  return {std::hypot(at_depth(real.left_N, d, real.grid), at_depth(rendered.left_N, d, rendered.grid)),
          std::hypot(at_depth(real.left_side_N, d, real.grid), at_depth(rendered.left_side_N, d, rendered.grid))};
}

// Over all depths where a process slid, each as its samples are, or where `counts` says.
struct Rubbed {
  double weight = 0.0;
  double depth_m = 0.0;
  double slid_m_per_s = 0.0;  // root mean square
  double load_N = 0.0;
  double friction_N = 0.0;       // against the motion
  Vec3 across_N = Vec3::Zero();  // all that is met, across the direction of pressing
};

template <class Weight>
Rubbed rubbed(const Response& r, const ResponseCurves& c, Weight weight) {
  Rubbed sum;
  for (std::size_t j = 0; j < r.knots(); ++j) {
    const double w = weight(j);
    if (!(w > 0.0)) continue;
    const double d = r.slid_depth_m[j];
    const Vec3 towards(0.0, r.slid_towards[0][j], r.slid_towards[1][j]);
    sum.weight += w;
    sum.depth_m += w * d;
    sum.slid_m_per_s += w * r.slid_m_per_s[j] * r.slid_m_per_s[j];
    sum.load_N += w * at_depth(c.normal_N, d, r.grid);
    sum.friction_N += w * at_depth(c.friction_N, d, r.grid);
    sum.across_N += w * (Vec3(0.0, at_depth(c.side_N[0], d, r.grid), at_depth(c.side_N[1], d, r.grid)) +
                         at_depth(c.friction_N, d, r.grid) * towards);
  }
  if (!(sum.weight > 0.0)) return sum;
  sum.depth_m /= sum.weight;
  sum.slid_m_per_s = std::sqrt(sum.slid_m_per_s / sum.weight);
  sum.load_N /= sum.weight;
  sum.friction_N /= sum.weight;
  sum.across_N /= sum.weight;
  return sum;
}

// The friction of two processes, where both slid at a depth, else of each where it slid. It goes with the load
// (Amontons), by which it is taken to the shallower of the two mean depths, and hardly with the speed.
SlowEvidence friction_evidence(const Response& real, const ResponseCurves& real_curves, const Response& rendered,
                               const ResponseCurves& rendered_curves, double least_depth_m,
                               const Thresholds& thresholds) {
  const std::size_t knots = std::min(real.knots(), rendered.knots());
  const auto sliding = [](const Response& r, std::size_t j) {
    return sliding_of(r.slid[j], {0.0, r.slid_towards[0][j], r.slid_towards[1][j]});
  };
  const auto slid = [](const Response& r, std::size_t j) { return r.seen[j] * r.slid[j]; };
  for (const bool to_and_fro : {true, false}) {
    const auto own_way = [&](const Response& r, std::size_t j) {
      const Sliding own = sliding(r, j);
      return own.slides && own.to_and_fro == to_and_fro && r.slid_depth_m[j] >= least_depth_m;
    };
    const auto both = [&](std::size_t j) {
      const bool alike = j < knots && own_way(real, j) && own_way(rendered, j) &&
                         (to_and_fro || one_way_alike(sliding(real, j), sliding(rendered, j)));
      return alike ? std::min(slid(real, j), slid(rendered, j)) : 0.0;
    };
    Rubbed own = rubbed(real, real_curves, both);
    Rubbed other = rubbed(rendered, rendered_curves, both);
    if (to_and_fro && own.weight == 0.0) {
      const auto alone = [&](const Response& r) {
        return [&, at = &r](std::size_t j) { return own_way(*at, j) ? slid(*at, j) : 0.0; };
      };
      own = rubbed(real, real_curves, alone(real));
      other = rubbed(rendered, rendered_curves, alone(rendered));
    }
    if (!(std::min(own.weight, other.weight) > 0.0) || !(std::min(own.load_N, other.load_N) > 0.0)) continue;
    const double d = std::min(own.depth_m, other.depth_m);
    double own_growth = at_depth(real_curves.normal_N, d, real.grid) / own.load_N;
    double other_growth = at_depth(rendered_curves.normal_N, d, rendered.grid) / other.load_N;
    // Against the motion: a friction that helps it is apart by the sum.
    const double own_N = own_growth * (to_and_fro ? std::abs(own.friction_N) : own.across_N.norm());
    const double other_N = other_growth * (to_and_fro ? std::abs(other.friction_N) : other.across_N.norm());
    const double apart_N = to_and_fro ? std::abs(other_growth * other.friction_N - own_growth * own.friction_N)
                                      : (other_growth * other.across_N - own_growth * own.across_N).norm();
    const double load_N = at_depth(real_curves.normal_N, d, real.grid);
    SlowEvidence evidence{true, friction_jnd(own_N, other_N, apart_N, load_N, thresholds), d, own_N, other_N};
    const double larger_N = std::max(own_N, other_N);
    const double left_N = left_at(real, rendered, d).side_N;
    const double by_left =
        bound_standard_errors * friction_jnd(larger_N, larger_N + left_N, left_N, load_N, thresholds);
    evidence.by_hand = std::hypot(friction_by_hand_jnd(larger_N, std::min(own_growth, other_growth),
                                                       other.slid_m_per_s / own.slid_m_per_s, load_N, thresholds),
                                  by_left);
    return evidence;
  }
  return {};
}

// Least-squares slope of the force's magnitude.
double slope_of(const ResponseCurves& c, const std::vector<double>& depths_m, const DepthGrid& grid, bool with_side) {
  double mean_d = 0.0;
  double mean_f = 0.0;
  for (const double d : depths_m) {
    mean_d += d / static_cast<double>(depths_m.size());
    mean_f += static_force(c, d, grid, with_side).norm() / static_cast<double>(depths_m.size());
  }
  double df = 0.0;
  double dd = 0.0;
  for (const double d : depths_m) {
    df += (d - mean_d) * (static_force(c, d, grid, with_side).norm() - mean_f);
    dd += (d - mean_d) * (d - mean_d);
  }
  return dd > 0.0 ? df / dd : 0.0;
}

// Of depths, the one that differs most beyond what another hand may make of it.
void keep_larger(SlowEvidence& evidence, const SlowEvidence& other) {
  const auto certain = [](const SlowEvidence& e) { return e.jnd - e.by_hand / bound_standard_errors; };
  if (!evidence.known || certain(other) > certain(evidence)) evidence = other;
}

}  // namespace

double steady_force_N(const Response& own, const Response& other, double depth_m) {
  const bool side_known = side_is_known(sliding_at(own, depth_m), sliding_at(other, depth_m));
  return static_force(own.curves, depth_m, own.grid, side_known).norm();
}

double depth_exponent(const ResponseCurves& c, double d, double step_m, const DepthGrid& grid) {
  const double below_m = std::max(0.0, d - step_m);
  const double force_N = static_force(c, d, grid).norm();
  const double rise_N = force_N - static_force(c, below_m, grid).norm();
  return force_N > 0.0 && d > below_m ? std::max(0.0, d * rise_N / ((d - below_m) * force_N)) : 0.0;
}

double force_at_depth_jnd(double force_jnd, double real_N, double rendered_N, double exponent,
                          const Thresholds& thresholds) {
  // One JND of depth is the fraction w of it. A force that goes as d^n changes by n w in its logarithm then, so that
  // the two forces are D = |ln(rendered / real)| / (n w) JND of depth apart. Both errors of the observer are
  // independent and add as variances: a difference of `jnd` in the force and D in the depth comes to
  // 1 / sqrt(1 / jnd^2 + 1 / D^2) of both.
  const double depth_error = exponent * thresholds.depth_fraction;
  const double jnd = std::abs(force_jnd);
  if (!(depth_error > 0.0) || !(real_N > 0.0) || !(rendered_N > 0.0) || jnd == 0.0) return jnd;
  const double depth_jnd = std::abs(std::log(rendered_N / real_N)) / depth_error;
  return jnd * depth_jnd / std::hypot(jnd, depth_jnd);
}

double friction_jnd(double real_N, double rendered_N, double apart_N, double load_N, const Thresholds& thresholds) {
  const double least_N = thresholds.force.just_noticeable_difference(load_N);
  const NoticeableSteps steps({least_N, least_N, thresholds.friction_fraction, thresholds.friction_fraction});
  const double larger_N = std::max(real_N, rendered_N);
  return steps(larger_N) - steps(larger_N - apart_N);
}

double friction_by_hand_jnd(double larger_N, double loads, double speeds, double load_N, const Thresholds& thresholds) {
  const GrowthBounds growth = growth_bounds(loads, 1.0);
  const auto bound = [&](double factor) {
    return bound_standard_errors *
           friction_jnd(larger_N, factor * larger_N, (factor - 1.0) * larger_N, load_N, thresholds);
  };
  return std::hypot(bound(std::max(growth.most / growth.by_law, growth.by_law / growth.least)),
                    bound(std::exp(std::abs(std::log(speeds)))));
}

std::vector<double> common_depths_m(const Response& real, const Response& rendered) {
  std::vector<double> depths;
  const double common = std::min(real.deepest_m, rendered.deepest_m);
  for (int tenth = 2; tenth <= 10; ++tenth) {
    const double d = 0.1 * tenth * common * (1.0 - 1e-9);
    if (seen_at(real, d) && seen_at(rendered, d)) depths.push_back(d);
  }
  return depths;
}

namespace {

// What goes with the speed is felt against the whole impedance, of spring and damper: its JND is a fraction of the
// magnitude of both together (Fu, Landman, van Paassen and Mulder 2018). An error of the observer's of the rate, as
// large as that of the depth, arrives in that force as a whole.
SlowEvidence damping_evidence(const Response& real, const ResponseCurves& real_curves, const Response& rendered,
                              const ResponseCurves& rendered_curves, bool same_motion,
                              const std::vector<double>& depths_m, const Thresholds& thresholds) {
  const NoticeableSteps steps(thresholds.force);
  const DepthGrid& grid = real.grid;
  double own_damping_N = 0.0, other_damping_N = 0.0, damping_depth_m = depths_m.back();  // where they differ most
  for (const double d : depths_m) {
    const double v = std::min(at_depth(real.speed_m_per_s, d, grid), at_depth(rendered.speed_m_per_s, d, grid));
    const double own_rate = v * at_depth(real_curves.normal_N_s_per_m, d, grid);
    const double other_rate = v * at_depth(rendered_curves.normal_N_s_per_m, d, grid);
    if (std::abs(other_rate - own_rate) <= std::abs(other_damping_N - own_damping_N)) continue;
    own_damping_N = own_rate;
    other_damping_N = other_rate;
    damping_depth_m = d;
  }
  const double steady_N = at_depth(real_curves.normal_N, depths_m.back(), grid);
  const double damping_N = std::max(std::abs(own_damping_N), std::abs(other_damping_N));
  const double whole_N = std::hypot(steady_N, damping_N);
  const double apart_N = std::abs(other_damping_N - own_damping_N);
  const double deep_exponent = depth_exponent(real_curves, depths_m.back(), 0.1 * depths_m.back(), grid);
  const double both = whole_N > 0.0 ? std::hypot(deep_exponent * steady_N, damping_N) / whole_N : 0.0;
  const auto jnd_of = [&](double less_N) {
    const double rest_N = std::max(0.0, whole_N - less_N);
    return force_at_depth_jnd(steps(whole_N) - steps(rest_N), whole_N, rest_N, both, thresholds);
  };
  const LeftAt left_there = same_motion ? LeftAt{} : left_at(real, rendered, damping_depth_m);
  return {true,
          jnd_of(apart_N),
          damping_depth_m,
          own_damping_N,
          other_damping_N,
          false,
          bound_standard_errors * jnd_of(left_there.normal_N)};
}

}  // namespace

SlowEvidences slow_evidence(const Response& real, const ResponseCurves& real_curves, const Response& rendered,
                            const ResponseCurves& rendered_curves, bool same_motion,
                            const std::vector<double>& depths_m, const Thresholds& thresholds) {
  SlowEvidences evidence;
  const auto at = [&evidence](SlowChannel c) -> SlowEvidence& { return evidence[static_cast<std::size_t>(c)]; };
  if (depths_m.empty()) return evidence;
  const NoticeableSteps steps(thresholds.force);
  const DepthGrid& grid = real.grid;
  bool all_sides_known = true;
  Vec3 real_sum = Vec3::Zero();
  Vec3 rendered_sum = Vec3::Zero();
  double deep = 0.0;
  double left_mean_N = 0.0;
  double left_deep_N = 0.0;
  for (const double d : depths_m) {
    const Sliding own_sliding = sliding_at(real, d);
    const Sliding other_sliding = sliding_at(rendered, d);
    const bool side_known = side_is_known(own_sliding, other_sliding);
    all_sides_known = all_sides_known && side_known;
    const Vec3 fr = static_force(real_curves, d, grid, side_known);
    const Vec3 fc = static_force(rendered_curves, d, grid, side_known);
    const double exponent = depth_exponent(real_curves, d, 0.1 * depths_m.back(), grid);
    const LeftAt left = same_motion ? LeftAt{} : left_at(real, rendered, d);
    left_mean_N += left.both_N() / static_cast<double>(depths_m.size());
    const auto force_jnd = [&](double own_N, double other_N, double own_exponent) {
      return force_at_depth_jnd(steps(other_N) - steps(own_N), own_N, other_N, own_exponent, thresholds);
    };
    const double left_N = side_known ? left.both_N() : left.normal_N;
    keep_larger(at(SlowChannel::force),
                {true, force_jnd(fr.norm(), fc.norm(), exponent), d, fr.norm(), fc.norm(), false,
                 bound_standard_errors * force_jnd(fr.norm(), fr.norm() + left_N, exponent)});
    if (d >= 0.6 * depths_m.back() && side_known) {
      real_sum += fr;
      rendered_sum += fc;
      deep += 1.0;
      left_deep_N += left.side_N;
    }
  }
  at(SlowChannel::rate) =
      damping_evidence(real, real_curves, rendered, rendered_curves, same_motion, depths_m, thresholds);
  at(SlowChannel::friction) =
      friction_evidence(real, real_curves, rendered, rendered_curves, 0.999 * depths_m.front(), thresholds);
  // A delay that the lag of a response took out counts by its length, whatever force it displaces.
  const auto delay_of = [](const Response& r, const ResponseCurves& c) {
    return r.lag_s > 0.0 ? std::max(0.0, r.lag_s + apparent_lag_s(r, c)) : 0.0;
  };
  const double own_s = delay_of(real, real_curves);
  const double other_s = delay_of(rendered, rendered_curves);
  const double delay_jnd = std::abs(other_s - own_s) / thresholds.delay_s;
  SlowEvidence& rate = at(SlowChannel::rate);
  if (delay_jnd > rate.jnd) rate = {true, delay_jnd, depths_m.back(), own_s, other_s, true, 0.0};
  if (depths_m.size() >= 3) {
    // Steps of a fraction w each: ratio = (1 + w)^steps.
    const double kr = slope_of(real_curves, depths_m, grid, all_sides_known);
    const double kc = slope_of(rendered_curves, depths_m, grid, all_sides_known);
    if (kr > 0.0 && kc > 0.0) {
      const auto stiffness_jnd = [&](double k) {
        return std::abs(std::log(k / kr)) / std::log1p(thresholds.stiffness_fraction);
      };
      // From one end of the depths to the other.
      const double left_N_per_m = 2.0 * left_mean_N / (depths_m.back() - depths_m.front());
      at(SlowChannel::stiffness) = {true,
                                    stiffness_jnd(kc),
                                    depths_m.back(),
                                    kr,
                                    kc,
                                    false,
                                    bound_standard_errors * stiffness_jnd(kr + left_N_per_m)};
    }
  }
  const double least = direction_force * thresholds.force.absolute_threshold;
  if (deep > 0.0 && real_sum.norm() / deep > least && rendered_sum.norm() / deep > least) {
    // tan = |a x b| / (a . b): exact also where the angle is small, unlike the inverse cosine.
    const double angle = std::atan2(real_sum.cross(rendered_sum).norm(), real_sum.dot(rendered_sum));
    const double left_rad = std::atan(left_deep_N / real_sum.norm());
    at(SlowChannel::direction) = {true,
                                  angle / thresholds.direction_rad,
                                  depths_m.back(),
                                  0.0,
                                  angle,
                                  false,
                                  bound_standard_errors * left_rad / thresholds.direction_rad};
  }
  if (same_motion) {
    for (auto& own : evidence) own.by_hand = 0.0;
  }
  return evidence;
}

std::array<double, slow_channels> slow_errors(const Response& real, const Response& rendered, bool same_motion,
                                              const std::vector<double>& depths_m, const Thresholds& thresholds) {
  // Jackknife over n blocks, with x_b the evidence without block b: the variance is
  //   (n - 1) / n sum (x_b - mean)^2 = (n - 1) / n (sum x_b^2 - (sum x_b)^2 / n).
  // With one motion a block holds the same stretch of both recordings and is left out of both at once, which keeps what
  // they have in common; else the recordings are independent and their variances add.
  std::array<double, slow_channels> variance{};
  const auto gather = [&](auto&& curves_without) {
    std::array<double, slow_channels> sum{};
    std::array<double, slow_channels> squares{};
    for (std::size_t b = 0; b < jackknife_blocks; ++b) {
      const auto& [r, c] = curves_without(b);
      const auto evidence = slow_evidence(real, *r, rendered, *c, same_motion, depths_m, thresholds);
      for (std::size_t e = 0; e < slow_channels; ++e) {
        sum[e] += evidence[e].jnd;
        squares[e] += evidence[e].jnd * evidence[e].jnd;
      }
    }
    constexpr double n = static_cast<double>(jackknife_blocks);
    for (std::size_t e = 0; e < slow_channels; ++e)
      variance[e] += (n - 1.0) / n * std::max(0.0, squares[e] - sum[e] * sum[e] / n);
  };
  using Pair = std::pair<const ResponseCurves*, const ResponseCurves*>;
  if (same_motion) {
    gather([&](std::size_t b) { return Pair{&real.without[b], &rendered.without[b]}; });
  } else {
    gather([&](std::size_t b) { return Pair{&real.without[b], &rendered.curves}; });
    gather([&](std::size_t b) { return Pair{&real.curves, &rendered.without[b]}; });
  }
  for (double& v : variance) v = std::sqrt(v);
  return variance;
}

}  // namespace touchstone::perception
