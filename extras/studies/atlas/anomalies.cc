#include "atlas/anomalies.h"

#include <algorithm>

namespace touchstone::atlas {
namespace {

// Stretches of samples that lag, counted where the exact contact point goes far enough meanwhile.
class StickDetector {
 public:
  explicit StickDetector(const AnomalyLimits& limits) : limits_(limits) {}

  void add(const TrackedContact& now, const Vec3& exact_step_W_m) {
    const Vec3 lag = now.exact_W_m - now.contact_W_m;
    const bool lags = now.contact && now.exact_depth_m > limits_.depth_m &&
                      lag.norm() > limits_.stick_lag_m + limits_.slack_m && lag.dot(exact_step_W_m) > 0.0;
    if (!lags) return end();
    path_m_ += exact_step_W_m.norm();
    ++samples_;
  }
  void end() {
    if (path_m_ >= limits_.stick_path_m) total_ += samples_;
    path_m_ = 0.0;
    samples_ = 0;
  }
  [[nodiscard]] std::size_t total() const noexcept { return total_; }

 private:
  AnomalyLimits limits_;
  double path_m_ = 0.0;
  std::size_t samples_ = 0;
  std::size_t total_ = 0;
};

// Whether the force of sample `i` pushes to the far side, see the header.
bool pops_through(const std::vector<TrackedContact>& run, std::size_t i, const AnomalyLimits& limits) {
  const Vec3& f_W_N = run[i].f_W_N;
  double back_m = 0.0;
  for (std::size_t j = i + 1; j-- > 0;) {
    if (!(f_W_N.dot(run[j].exact_n_W) < -limits.sine * f_W_N.norm())) return false;
    if (j > 0) back_m += (run[j].exact_W_m - run[j - 1].exact_W_m).norm();
    if (back_m > limits.stick_lag_m + limits.slack_m) break;
  }
  return true;
}

}  // namespace

Anomalies find_anomalies(const std::vector<TrackedContact>& run, const AnomalyLimits& limits) {
  Anomalies found;
  StickDetector stick(limits);
  for (std::size_t i = 0; i < run.size(); ++i) {
    const TrackedContact& now = run[i];
    const bool pressed = now.exact_depth_m > limits.depth_m;
    const double force = now.f_W_N.norm();
    stick.add(now, i == 0 ? Vec3(Vec3::Zero()) : Vec3(now.exact_W_m - run[i - 1].exact_W_m));
    ++found.samples;
    if (pressed && !now.contact) ++found.loses_contact;
    if (pressed && now.contact)
      found.largest_lag_m = std::max(found.largest_lag_m, (now.exact_W_m - now.contact_W_m).norm());
    if (!(force > 0.0)) continue;
    if (pressed && pops_through(run, i, limits)) ++found.pops_through;
    if (now.f_W_N.dot(now.own_n_W) < -limits.sine * force || now.tip_outside_m > limits.depth_m) ++found.pulls_inward;
  }
  stick.end();
  found.sticks = stick.total();
  return found;
}

}  // namespace touchstone::atlas
