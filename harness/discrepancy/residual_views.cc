#include "harness/discrepancy/residual_views.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "harness/stats/quantile.h"

namespace touchstone::discrepancy {
using rendering::Prediction;

namespace {

constexpr double velocity_half_window_s = 0.02;
// A speed below this share of the typical one has no sure direction.
constexpr double slow_share = 0.1;

// The way between the samples about a window of 40 ms over the time between them: a tracker's noise divides by it.
std::vector<Vec3> velocities(const MotionColumns& motion) {
  const std::size_t n = motion.size();
  std::vector<Vec3> v_W(n, Vec3::Zero());
  std::size_t low = 0;
  std::size_t high = 0;
  for (std::size_t i = 0; i < n; ++i) {
    while (motion.t_s[low] < motion.t_s[i] - velocity_half_window_s) ++low;
    while (high + 1 < n && motion.t_s[high] < motion.t_s[i] + velocity_half_window_s) ++high;
    if (high > low) v_W[i] = (motion.p_W_m[high] - motion.p_W_m[low]) / (motion.t_s[high] - motion.t_s[low]);
  }
  return v_W;
}

// The j-th piecewise linear bump over the knots; the outer ones go on beyond them.
double bump(double x, std::span<const double> knots, std::size_t j) {
  const std::size_t last = knots.size() - 1;
  if (x <= knots.front()) return j == 0 ? 1.0 : 0.0;
  if (x >= knots.back()) return j == last ? 1.0 : 0.0;
  if (j > 0 && x <= knots[j]) return std::max(0.0, (x - knots[j - 1]) / (knots[j] - knots[j - 1]));
  if (j < last && x >= knots[j]) return std::max(0.0, (knots[j + 1] - x) / (knots[j + 1] - knots[j]));
  return 0.0;
}

template <std::size_t n>
std::array<double, n> scaled(std::array<double, n> knots, double scale) {
  for (double& knot : knots) knot *= scale;
  return knots;
}

class Views {
 public:
  Views(const MotionColumns& motion, const Prediction& prediction, const ViewScales& scales,
        const std::vector<ResidualBlock>& blocks)
      : motion_(motion),
        prediction_(prediction),
        scales_(scales),
        blocks_(blocks),
        v_W_(velocities(motion)),
        series_(motion.size()) {
    const std::size_t n = motion.size();
    rate_.resize(n);
    slid_W_.resize(n);
    way_W_.resize(n);
    // The velocity in parts: n . v along the normal, v - (n . v) n along the surface. The direction of sliding is
    // v / (|v| + a share of the usual speed), which goes to nought with the speed instead of jumping.
    for (std::size_t i = 0; i < n; ++i) {
      rate_[i] = normal(i).dot(v_W_[i]);
      slid_W_[i] = touches(i) ? Vec3(v_W_[i] - rate_[i] * normal(i)) : Vec3(Vec3::Zero());
      const double speed = slid_W_[i].norm() + slow_share * scales.speed_m_per_s;
      way_W_[i] = speed > 0.0 ? Vec3(slid_W_[i] / speed) : Vec3(Vec3::Zero());
    }
  }

  std::vector<ResidualView> all() {
    along_the_normal();
    along_the_surface();
    where_and_when();
    outside_the_contact();
    return std::move(views_);
  }

 private:
  [[nodiscard]] const Vec3& normal(std::size_t i) const { return prediction_.n_W[i]; }
  [[nodiscard]] bool touches(std::size_t i) const { return !normal(i).isZero(); }
  [[nodiscard]] double depth(std::size_t i) const { return prediction_.depth_m[i]; }
  [[nodiscard]] double load(std::size_t i) const { return prediction_.normal_N[i]; }
  [[nodiscard]] double step_s(std::size_t i) const { return i > 0 ? motion_.t_s[i] - motion_.t_s[i - 1] : 0.0; }
  [[nodiscard]] Vec3 sensor_axis(std::size_t i, int axis) const {
    return motion_.q_WS.empty() ? Vec3(Vec3::Unit(axis)) : Vec3(motion_.q_WS[i] * Vec3::Unit(axis));
  }

  void view(const char* name) { views_.push_back({name, {}}); }
  template <class Force>
  void add(const Force& force) {
    for (std::size_t i = 0; i < series_.size(); ++i) series_[i] = force(i);
    views_.back().means.push_back(block_means(blocks_, series_));
  }
  template <class Scalar>
  void add_normal(const Scalar& scalar) {
    add([&](std::size_t i) { return Vec3(scalar(i) * normal(i)); });
  }

  void along_the_normal() {
    // Any law N(d) of the depth alone is close to a sum of bumps over it.
    view("depth");
    const auto depths = scaled(std::array{0.0, 0.15, 0.35, 0.55, 0.75, 1.0}, scales_.depth_m);
    for (std::size_t j = 0; j < depths.size(); ++j)
      add_normal([&](std::size_t i) { return bump(depth(i), depths, j); });

    // b(d') as in Kelvin and Voigt's damping, and d b(d') as in Hunt and Crossley's.
    view("rate of the depth");
    const auto rates = scaled(std::array{-2.0, -1.0, -0.3, 0.0, 0.3, 1.0, 2.0}, scales_.depth_rate_m_per_s);
    for (std::size_t j = 0; j < rates.size(); ++j) {
      add_normal([&](std::size_t i) { return bump(rate_[i], rates, j); });
      add_normal([&](std::size_t i) { return depth(i) * bump(rate_[i], rates, j); });
    }

    view("past of the depth");
    std::vector<double> past(motion_.size());
    const auto add_past = [&] {
      add_normal([&](std::size_t i) { return past[i]; });
      add_normal([&](std::size_t i) { return past[i] * depth(i); });
    };
    for (const double time_s : {0.03, 0.1, 0.3, 1.0, 3.0}) {
      // A first-order lag m' = (d - m) / T, exact for a depth that stands still within a sample: what a spring behind a
      // damper (Maxwell's element) has forgotten.
      double mean = 0.0;
      for (std::size_t i = 0; i < past.size(); ++i) {
        const double keep = std::exp(-step_s(i) / time_s);
        past[i] = mean = keep * mean + (1.0 - keep) * depth(i);
      }
      add_past();
    }
    // The largest depth of this contact so far: damage, and curves that differ between loading and unloading.
    double deepest = 0.0;
    for (std::size_t i = 0; i < past.size(); ++i) past[i] = deepest = touches(i) ? std::max(deepest, depth(i)) : 0.0;
    add_past();
  }

  void along_the_surface() {
    // Friction mu(|v|) N against the way, and what sliding does to the normal force.
    view("sliding speed");
    const auto speeds = scaled(std::array{0.0, 0.1, 0.3, 0.6, 1.0, 2.0}, scales_.speed_m_per_s);
    for (std::size_t j = 0; j < speeds.size(); ++j) {
      add([&](std::size_t i) { return Vec3(bump(slid_W_[i].norm(), speeds, j) * load(i) * way_W_[i]); });
      add_normal([&](std::size_t i) { return bump(slid_W_[i].norm(), speeds, j) * depth(i); });
    }

    // Dry and viscous friction whose coefficient depends on the load.
    view("load");
    const auto loads = scaled(std::array{0.0, 0.15, 0.35, 0.55, 0.75, 1.0}, scales_.load_N);
    for (std::size_t j = 0; j < loads.size(); ++j) {
      add([&](std::size_t i) { return Vec3(bump(load(i), loads, j) * way_W_[i]); });
      add([&](std::size_t i) { return Vec3(bump(load(i), loads, j) * slid_W_[i]); });
    }

    // N M w for each element of a matrix M on the direction w, less its part along the normal: friction that differs by
    // direction.
    view("direction of sliding");
    for (int from = 0; from < 3; ++from) {
      for (int to = 0; to < 3; ++to) {
        add([&](std::size_t i) {
          const Vec3 f = load(i) * way_W_[i][from] * Vec3::Unit(to);
          return Vec3(f - normal(i).dot(f) * normal(i));
        });
      }
    }

    // How far the tip went since it turned back or touched, up to a length: a spring that gives way there.
    view("path since it turned");
    for (const double share : {0.003, 0.01, 0.03, 0.1, 0.3}) {
      const double length_m = share * scales_.extent_m;
      std::vector<Vec3> stretched(motion_.size(), Vec3::Zero());
      Vec3 z_W_m = Vec3::Zero();
      for (std::size_t i = 1; i < stretched.size() && length_m > 0.0; ++i) {
        if (!touches(i)) {
          z_W_m.setZero();
          continue;
        }
        // The spring's stretch follows the tip, stays in the tangent plane, and slips beyond its length (Dahl 1968).
        z_W_m += motion_.p_W_m[i] - motion_.p_W_m[i - 1];
        z_W_m -= normal(i).dot(z_W_m) * normal(i);
        if (z_W_m.norm() > length_m) z_W_m *= length_m / z_W_m.norm();
        stretched[i] = z_W_m / length_m;
      }
      add([&](std::size_t i) { return stretched[i]; });
      add([&](std::size_t i) { return Vec3(load(i) * stretched[i]); });
    }
  }

  void where_and_when() {
    view("place");
    // Stiffness over the place: polynomials up to the third degree in the three coordinates, each from -1 to 1.
    constexpr int degree = 3;
    const double half_m = std::max(0.5 * scales_.extent_m, 1e-300);
    const auto place = [&](std::size_t i) { return Vec3((motion_.p_W_m[i] - scales_.middle_W_m) / half_m); };
    for (int a = 0; a <= degree; ++a) {
      for (int b = 0; a + b <= degree; ++b) {
        for (int c = 0; a + b + c <= degree; ++c) {
          add_normal([&](std::size_t i) {
            const Vec3 r = place(i);
            return load(i) * std::pow(r.x(), a) * std::pow(r.y(), b) * std::pow(r.z(), c);
          });
        }
      }
    }

    // A stiffness that changes over the recording, and a drift along the sensor's axes.
    view("time");
    const auto times = scaled(std::array{0.0, 0.15, 0.3, 0.45, 0.6, 0.8, 1.0}, scales_.duration_s);
    for (std::size_t j = 0; j < times.size(); ++j) {
      const auto now = [&](std::size_t i) { return bump(motion_.t_s[i] - motion_.t_s.front(), times, j); };
      add_normal([&](std::size_t i) { return now(i) * load(i); });
      for (int axis = 0; axis < 3; ++axis) add([&](std::size_t i) { return Vec3(now(i) * sensor_axis(i, axis)); });
    }
  }

  void outside_the_contact() {
    // Drag, linear and squared, in contact and in free air alone; inertia; a constant in the world's and in the
    // sensor's frame; and a gradient over the place, as of a cable.
    view("motion");
    add([&](std::size_t i) { return v_W_[i]; });
    add([&](std::size_t i) { return Vec3(v_W_[i].norm() * v_W_[i]); });
    add([&](std::size_t i) { return touches(i) ? Vec3(Vec3::Zero()) : v_W_[i]; });
    add([&](std::size_t i) {
      return i > 0 && i + 1 < motion_.size()
                 ? Vec3((v_W_[i + 1] - v_W_[i - 1]) / (motion_.t_s[i + 1] - motion_.t_s[i - 1]))
                 : Vec3(Vec3::Zero());
    });
    for (int axis = 0; axis < 3; ++axis) {
      add([&](std::size_t) { return Vec3(Vec3::Unit(axis)); });
      add([&](std::size_t i) { return sensor_axis(i, axis); });
      for (int along = 0; along < 3; ++along) {
        add([&](std::size_t i) { return Vec3((motion_.p_W_m[i] - scales_.middle_W_m)[along] * Vec3::Unit(axis)); });
      }
    }

    view("place in free air");
    for (int axis = 0; axis < 3; ++axis) {
      const auto free = [&](std::size_t i) { return touches(i) ? Vec3(Vec3::Zero()) : Vec3(Vec3::Unit(axis)); };
      add(free);
      for (int along = 0; along < 3; ++along) {
        add([&](std::size_t i) { return Vec3((motion_.p_W_m[i] - scales_.middle_W_m)[along] * free(i)); });
      }
    }
  }

  const MotionColumns& motion_;
  const Prediction& prediction_;
  const ViewScales& scales_;
  const std::vector<ResidualBlock>& blocks_;
  std::vector<Vec3> v_W_;
  std::vector<double> rate_;  // of the tip along the normal, positive: leaving
  std::vector<Vec3> slid_W_;  // velocity along the surface
  std::vector<Vec3> way_W_;   // its direction, shorter where it is slow
  std::vector<Vec3> series_;  // one force of every sample
  std::vector<ResidualView> views_;
};

}  // namespace

ViewScales measure_view_scales(const MotionColumns& motion, const Prediction& prediction) {
  ViewScales scales;
  const auto v_W = velocities(motion);
  std::vector<double> depths;
  std::vector<double> rates;
  std::vector<double> speeds;
  std::vector<double> loads;
  Box3 box;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    scales.middle_W_m += motion.p_W_m[i] / static_cast<double>(motion.size());
    const Vec3& n = prediction.n_W[i];
    if (n.isZero()) continue;
    depths.push_back(prediction.depth_m[i]);
    loads.push_back(prediction.normal_N[i]);
    rates.push_back(std::abs(n.dot(v_W[i])));
    speeds.push_back((v_W[i] - n.dot(v_W[i]) * n).norm());
    box.extend(motion.p_W_m[i]);
  }
  // Without a sample in contact these stay 0.
  if (!depths.empty()) {
    scales.depth_m = stats::lower_quantile(std::move(depths), 0.95);
    scales.depth_rate_m_per_s = stats::lower_quantile(std::move(rates), 0.9);
    scales.speed_m_per_s = stats::lower_quantile(std::move(speeds), 0.8);
    scales.load_N = stats::lower_quantile(std::move(loads), 0.95);
  }
  scales.extent_m = box.isEmpty() ? 0.0 : box.diagonal().norm();
  scales.duration_s = motion.size() > 0 ? motion.t_s.back() - motion.t_s.front() : 0.0;
  return scales;
}

std::vector<ResidualView> residual_views(const MotionColumns& motion, const Prediction& prediction,
                                         const ViewScales& scales, const std::vector<ResidualBlock>& blocks) {
  return Views(motion, prediction, scales, blocks).all();
}

}  // namespace touchstone::discrepancy
