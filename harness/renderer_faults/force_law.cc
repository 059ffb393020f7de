#include "harness/renderer_faults/force_law.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "harness/base/random.h"
#include "harness/renderer_faults/probe.h"
#include "harness/surface/box_mesh.h"
#include "harness/surface/moved_mesh.h"

namespace touchstone::renderer_faults {
using rendering::Renderer;
using rendering::StepResult;
using surface::Surface;

namespace {

// One pressed place: the face's normal, the depth, and what was answered.
struct Reading {
  Vec3 n;
  double depth_m = 0.0;
  Vec3 f_N;
};

// No round figures: those would stand on the edge between two steps of a quantised force.
constexpr std::array loads_N{0.0531, 0.1137, 0.2273, 0.517, 1.093, 2.31, 3.71, 5.93, 9.97};
// Deeper than this no stroke goes, however soft the contact is.
constexpr double deepest_m = 0.05;

double depth_of(const Engine& engine, double load_N) {
  return std::min(load_N / engine.stiffness_N_per_m, deepest_m * load_N / loads_N.back());
}

// Axes, the eight octants, and some more.
std::vector<Vec3> directions() {
  std::vector<Vec3> all;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const int axes = std::abs(x) + std::abs(y) + std::abs(z);
        // No two components of the same size: which is the strongest must be clear.
        if (axes == 1 || axes == 3) all.push_back(Vec3(x, 0.83 * y, 0.67 * z).normalized());
      }
    }
  }
  Random random(213);
  constexpr int others = 6;
  for (int i = 0; i < others; ++i) all.push_back(random.direction());
  return all;
}

// On the top of a block that is turned so that its top looks along each direction.
std::vector<Reading> press_everywhere(const Engine& engine) {
  std::vector<Reading> readings;
  const double half_m = 5.0 * depth_of(engine, loads_N.back()) + half_side_m;
  const surface::TriangleMesh block = surface::box_mesh({-half_m, -half_m, -2.0 * half_m}, {half_m, half_m, 0.0});
  for (const Vec3& n : directions()) {
    const Quat turn = Quat::FromTwoVectors(Vec3::UnitZ(), n);
    Probe probe(engine, moved(block, turn, Vec3::Zero()));
    const Vec3 foot = turn * Vec3(0.0031, 0.0017, 0.0);
    double depth_m = depth_of(engine, loads_N.front());
    probe.approach(foot, n, depth_m);
    for (const double load_N : loads_N) {
      const double target_m = depth_of(engine, load_N);
      // 2 m/s at 1 kHz.
      constexpr double largest_step_m = 2e-3;
      const int steps = 1 + static_cast<int>((target_m - depth_m) / largest_step_m);
      const double from_m = depth_m;
      StepResult last;
      for (int i = 1; i <= steps; ++i) last = probe.press(foot, n, from_m + (target_m - from_m) * i / steps);
      // Once more: what is damped is at rest then.
      last = probe.press(foot, n, target_m);
      depth_m = target_m;
      readings.push_back({n, target_m, last.f_W_N});
    }
  }
  return readings;
}

// F = scale d^power.
struct Law {
  double scale = 0.0;
  double power = 1.0;
  [[nodiscard]] double operator()(double depth_m) const { return scale * std::pow(depth_m, power); }
};

// Of what is off, over the rms of the right force, up to a load: what is at fault at high loads alone does not blur
// what is seen at low ones.
double off(const std::vector<Reading>& readings, const Law& law, const ForceMap& map, double up_to_N) {
  double error = 0.0;
  double right = 0.0;
  for (const Reading& one : readings) {
    const Vec3 expected = law(one.depth_m) * one.n;
    if (expected.norm() > up_to_N) continue;
    // Each reading counts by its share: a light one as much as a heavy one.
    error += (one.f_N - map(expected)).squaredNorm() / expected.squaredNorm();
    right += 1.0;
  }
  return std::sqrt(error / std::max(1.0, right));
}

std::vector<ForceMap> axis_maps() {
  std::vector<ForceMap> maps;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      ForceMap map;
      map.from = order;
      for (std::size_t a = 0; a < 3; ++a) map.positive[a] = map.negative[a] = (signs >> a & 1) != 0 ? -1.0 : 1.0;
      maps.push_back(map);
    }
  } while (std::ranges::next_permutation(order).found);
  for (std::size_t a = 0; a < 3; ++a) {
    ForceMap lost;
    lost.from[a] = -1;
    maps.push_back(lost);
    ForceMap half;
    half.positive[a] = -1.0;
    maps.push_back(half);
    half.positive[a] = 1.0;
    half.negative[a] = -1.0;
    maps.push_back(half);
    // No pull along one way of an axis.
    half.negative[a] = 0.0;
    maps.push_back(half);
    half.negative[a] = 1.0;
    half.positive[a] = 0.0;
    maps.push_back(half);
  }
  // All but one.
  for (int kept = 0; kept < 3; ++kept) {
    ForceMap lost;
    lost.from = {-1, -1, -1};
    lost.from[static_cast<std::size_t>(kept)] = kept;
    maps.push_back(lost);
  }
  ForceMap strongest;
  strongest.strongest_only = true;
  maps.push_back(strongest);
  return maps;
}

std::vector<Law> laws_of(const Engine& engine, const std::vector<Reading>& readings) {
  // The median of the normal force of the two lightest loads.
  std::array<double, 2> light_N{};
  for (std::size_t load = 0; load < light_N.size(); ++load) {
    std::vector<double> normal_N;
    for (std::size_t i = load; i < readings.size(); i += loads_N.size()) normal_N.push_back(readings[i].f_N.norm());
    std::ranges::nth_element(normal_N, normal_N.begin() + std::ssize(normal_N) / 2);
    light_N[load] = normal_N[normal_N.size() / 2];
  }
  std::vector<Law> laws{{engine.stiffness_N_per_m, 1.0}};
  if (!(light_N[0] > 0.0 && light_N[1] > light_N[0])) return laws;
  const double d0_m = depth_of(engine, loads_N[0]);
  const double d1_m = depth_of(engine, loads_N[1]);
  laws.push_back({light_N[1] / d1_m, 1.0});
  const double power = std::log(light_N[1] / light_N[0]) / std::log(d1_m / d0_m);
  laws.push_back({light_N[0] / std::pow(d0_m, power), power});
  return laws;
}

// The map with the limits of components along these axes that the readings could have: the largest that came, where the
// right force is above it. No axis but the first is limited if `first_alone`.
ForceMap limited_along(const std::vector<Reading>& readings, const Law& law, ForceMap map, const Mat3& axes,
                       bool first_alone) {
  const ForceMap right = map;
  map.limited = axes;
  for (Eigen::Index a = 0; a < (first_alone ? 1 : 3); ++a) {
    double least_N = 0.0;
    double most_N = 0.0;
    double right_least_N = 0.0;
    double right_most_N = 0.0;
    for (const Reading& one : readings) {
      const double came_N = axes.row(a).dot(one.f_N);
      const double expected_N = axes.row(a).dot(right(law(one.depth_m) * one.n));
      least_N = std::min(least_N, came_N);
      most_N = std::max(most_N, came_N);
      right_least_N = std::min(right_least_N, expected_N);
      right_most_N = std::max(right_most_N, expected_N);
    }
    constexpr double clearly = 1.02;
    if (right_least_N < clearly * least_N) map.least_N[a] = least_N;
    if (right_most_N > clearly * most_N) map.most_N[a] = most_N;
  }
  return map;
}

// By magnitude.
ForceMap limited_in_all(const std::vector<Reading>& readings, ForceMap map) {
  map.limit_N = 0.0;
  for (const Reading& one : readings) map.limit_N = std::max(map.limit_N, one.f_N.norm());
  return map;
}

// The directions in which force is missing, without their signs, those of most readings first: where one component
// alone is limited, that of its axis.
std::vector<Vec3> missing_directions(const std::vector<Reading>& readings, const Law& law, const ForceMap& map) {
  struct Direction {
    Vec3 along;
    int readings = 0;
  };
  std::vector<Direction> found;
  for (const Reading& one : readings) {
    const Vec3 expected = map(law(one.depth_m) * one.n);
    const Vec3 missing = expected - one.f_N;
    constexpr double clearly = 0.02;
    if (!(missing.norm() > clearly * expected.norm())) continue;
    const Vec3 along = missing.normalized();
    constexpr double same = 0.9998;  // the cosine of a degree
    const auto known =
        std::ranges::find_if(found, [&](const Direction& d) { return std::abs(d.along.dot(along)) > same; });
    if (known == found.end()) {
      found.push_back({along, 1});
    } else {
      ++known->readings;
    }
  }
  std::ranges::stable_sort(found, std::ranges::greater{}, &Direction::readings);
  constexpr std::size_t most = 40;
  std::vector<Vec3> directions;
  for (std::size_t i = 0; i < std::min(most, found.size()); ++i) directions.push_back(found[i].along);
  return directions;
}

// Saturations that the readings could have: the simplest first.
std::vector<ForceMap> saturations(const std::vector<Reading>& readings, const Law& law, const ForceMap& axes) {
  std::vector<ForceMap> maps{limited_along(readings, law, axes, Mat3::Identity(), false),
                             limited_in_all(readings, axes)};
  const auto directions = missing_directions(readings, law, axes);
  const auto frame_of = [](const Vec3& first, const Vec3& second) -> Mat3 {
    Mat3 frame;
    frame.row(0) = first;
    frame.row(1) = (second - second.dot(first) * first).normalized();
    frame.row(2) = first.cross(Vec3(frame.row(1))).normalized();
    return frame;
  };
  for (const Vec3& one : directions)
    maps.push_back(limited_along(readings, law, axes, frame_of(one, one.unitOrthogonal()), true));
  for (std::size_t i = 0; i < directions.size(); ++i) {
    for (std::size_t j = i + 1; j < directions.size(); ++j) {
      constexpr double upright = 0.02;
      if (std::abs(directions[i].dot(directions[j])) < upright)
        maps.push_back(limited_along(readings, law, axes, frame_of(directions[i], directions[j]), false));
    }
  }
  return maps;
}

// The largest step of which every component that came is a multiple; 0: there is none.
double common_step_N(const std::vector<Reading>& readings, const ForceMap& map) {
  const auto at_limit = [&](Eigen::Index axis, double part) {
    constexpr double same = 1e-9;
    return std::abs(part - map.least_N[axis]) <= same * std::abs(part) ||
           std::abs(part - map.most_N[axis]) <= same * std::abs(part) || std::abs(part) >= (1.0 - same) * map.limit_N;
  };
  std::vector<double> parts_N;
  for (const Reading& one : readings) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      // What is cut off stands at the limit, not on a step.
      if (const double part = one.f_N[axis]; std::abs(part) > 1e-9 && !at_limit(axis, part))
        parts_N.push_back(std::abs(part));
    }
  }
  if (parts_N.size() < 20) return 0.0;
  const double least_N = std::ranges::min(parts_N);
  // The least one is a small multiple of the step.
  for (int parts = 1; parts <= 4; ++parts) {
    const double step_N = least_N / parts;
    const bool all = std::ranges::all_of(parts_N, [&](double part) {
      return std::abs(part / step_N - std::round(part / step_N)) < 1e-4 * std::max(1.0, part / step_N);
    });
    if (all && step_N > 1e-4 * loads_N.front()) return step_N;
  }
  return 0.0;
}

class Mapped final : public Renderer {
 public:
  Mapped(std::unique_ptr<Renderer> inner, const ForceMap& map) : inner_(std::move(inner)), map_(map) {}

 private:
  void do_reset() override { inner_->reset(); }
  StepResult do_step(const rendering::TipState& tip) noexcept override {
    StepResult result = inner_->step(tip);
    result.f_W_N = map_(result.f_W_N);
    return result;
  }
  [[nodiscard]] std::string do_failure() const override { return inner_->failure(); }
  std::unique_ptr<Renderer> inner_;
  ForceMap map_;
};

class ClosestPoint final : public Renderer {
 public:
  ClosestPoint(std::shared_ptr<const Surface> surface, double stiffness_N_per_m, double radius_m, double friction)
      : surface_(std::move(surface)), stiffness_N_per_m_(stiffness_N_per_m), radius_m_(radius_m), friction_(friction) {}

 private:
  void do_reset() override { before_W_m_.reset(); }
  StepResult do_step(const rendering::TipState& tip) noexcept override {
    StepResult result;
    result.contact_W_m = tip.p_W_m;
    const Vec3 move = tip.p_W_m - before_W_m_.value_or(tip.p_W_m);
    before_W_m_ = tip.p_W_m;
    const surface::SurfacePoint foot = surface_->closest(tip.p_W_m);
    const double depth_m = radius_m_ - foot.signed_distance_m;
    if (!(depth_m > 0.0)) return result;
    const Vec3 out = foot.signed_distance_m < 0.0 ? Vec3(foot.p_W_m - tip.p_W_m) : Vec3(tip.p_W_m - foot.p_W_m);
    result.n_W = foot.distance_m > 0.0 ? Vec3(out / foot.distance_m) : foot.n_W;
    result.depth_m = depth_m;
    result.contact_W_m = tip.p_W_m + depth_m * result.n_W;
    result.f_W_N = stiffness_N_per_m_ * depth_m * result.n_W;
    result.contact = true;
    // Against what moves along the surface, rounding aside.
    const Vec3 along = move - move.dot(result.n_W) * result.n_W;
    constexpr double rounding = 1e-6;
    if (friction_ > 0.0 && along.norm() > rounding * depth_m)
      result.f_W_N -= friction_ * stiffness_N_per_m_ * depth_m * along.normalized();
    return result;
  }
  std::shared_ptr<const Surface> surface_;
  double stiffness_N_per_m_;
  double radius_m_;
  double friction_;
  std::optional<Vec3> before_W_m_;
};

}  // namespace

Vec3 ForceMap::operator()(const Vec3& f) const {
  Vec3 out;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto i = static_cast<Eigen::Index>(a);
    const double part = from[a] < 0 ? 0.0 : f[from[a]];
    out[i] = part * (part > 0.0 ? positive[a] : negative[a]);
  }
  if (strongest_only) {
    Eigen::Index strongest = 0;
    out.cwiseAbs().maxCoeff(&strongest);
    out = Vec3(out[strongest] * Vec3::Unit(strongest));
  }
  if (limits_components()) out = limited.transpose() * (limited * out).cwiseMax(least_N).cwiseMin(most_N);
  if (const double size_N = out.norm(); size_N > limit_N) out *= limit_N / size_N;
  if (step_N > 0.0) {
    for (double& part : out) {
      const double steps = part / step_N;
      part = step_N * (rounding == Rounding::nearest        ? std::round(steps)
                       : rounding == Rounding::towards_zero ? std::trunc(steps)
                                                            : std::floor(steps));
    }
  }
  return out;
}

bool ForceMap::limits_components() const {
  return std::isfinite(least_N.maxCoeff()) || std::isfinite(most_N.minCoeff());
}

ForceMap ForceMap::axes_alone() const {
  ForceMap axes;
  axes.from = from;
  axes.positive = positive;
  axes.negative = negative;
  axes.strongest_only = strongest_only;
  return axes;
}

std::optional<ForceMap> ForceMap::inverse() const {
  ForceMap undo;
  for (std::size_t a = 0; a < 3; ++a) {
    if (strongest_only || from[a] < 0 || positive[a] != negative[a] || positive[a] == 0.0) return std::nullopt;
    const auto b = static_cast<std::size_t>(from[a]);
    undo.from[b] = static_cast<int>(a);
    undo.positive[b] = undo.negative[b] = 1.0 / positive[a];
  }
  return undo;
}

ForceFaults identify_force_map(const Engine& engine) {
  const auto readings = press_everywhere(engine);
  const auto laws = laws_of(engine, readings);
  constexpr double light_N = 0.24;
  constexpr double all_N = std::numeric_limits<double>::infinity();
  // A fault must take away most of what is off, and more than rounding, epsilon and a per cent, and leave little.
  const auto explains = [&](double with, double without) {
    return with < 0.3 * without && without > 0.01 && with < 0.15;
  };
  ForceFaults faults;
  Law law = laws.front();
  const auto best_law = [&](const ForceMap& map, double up_to_N) {
    double least = all_N;
    for (const Law& one : laws) {
      if (const double now = off(readings, one, map, up_to_N); now < 0.9 * least) {
        least = now;
        law = one;
      }
    }
    return least;
  };
  faults.before = best_law({}, all_N);

  // Axes first, from light loads, at which nothing saturates that is of use; a saturation below is tried with them.
  double axes_off = best_law({}, light_N);
  ForceMap axes;
  for (const ForceMap& map : axis_maps()) {
    faults.axes_leave = std::min(faults.axes_leave, best_law(map, all_N));
    const double now = best_law(map, light_N);
    if (!explains(now, axes_off)) continue;
    axes_off = now;
    axes = map;
    faults.axes = true;
  }
  faults.map = axes;
  double now_off = best_law(axes, all_N);
  for (const ForceMap& map : saturations(readings, law, axes)) {
    const double with = best_law(map, all_N);
    faults.limits_leave = std::min(faults.limits_leave, with);
    if (!explains(with, now_off)) continue;
    now_off = with;
    faults.map = map;
    faults.saturated = true;
  }
  ForceMap stepped = faults.map;
  stepped.step_N = common_step_N(readings, faults.map);
  if (stepped.step_N > 0.0) {
    double without = best_law(faults.map, all_N);
    for (const Rounding rounding : {Rounding::nearest, Rounding::towards_zero, Rounding::down}) {
      stepped.rounding = rounding;
      constexpr double least = 2e-3;
      const double with = best_law(stepped, all_N);
      faults.steps_leave = std::min(faults.steps_leave, with);
      if (!(without > least && with < 0.3 * without)) continue;
      now_off = without = with;
      faults.map = stepped;
      faults.quantised = true;
    }
  }
  faults.after = now_off;
  return faults;
}

Engine with_map(const Engine& engine, const ForceMap& map) {
  Engine mapped = engine;
  mapped.make = [make = engine.make, map](std::shared_ptr<const Surface> surface, double unit) {
    return std::unique_ptr<Renderer>(std::make_unique<Mapped>(make(std::move(surface), unit), map));
  };
  return mapped;
}

Engine reference_engine(const Engine& like) {
  Engine reference = like;
  reference.epsilon_m = 0.0;
  reference.settle_samples = 0;
  reference.allocations = {};
  reference.make = [k = like.stiffness_N_per_m, r = like.tip_radius_m, friction = like.friction](
                       std::shared_ptr<const Surface> surface, double unit) {
    return std::unique_ptr<Renderer>(std::make_unique<ClosestPoint>(std::move(surface), k / unit, r * unit, friction));
  };
  return reference;
}

}  // namespace touchstone::renderer_faults
