#include "lab/wall_experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lab/analysis.h"

namespace touchstone::hil {
namespace {

struct Touch {
  bool stable = false;
  bool touched = false;
  double rate_hardness_N_per_m = 0.0;  // 0 where the touch was too slow to tell
  double rendered_N_per_m = 0.0;
};

Touch judge(const ServoRun& run) {
  Touch touch;
  const auto first =
      std::find_if(run.ticks.begin(), run.ticks.end(), [](const ServoTick& tick) { return tick.p_W_m.x() < 0.0; });
  const auto left = static_cast<std::size_t>(run.ticks.end() - first);
  touch.touched = first != run.ticks.begin() && left > run.ticks.size() / 4;
  if (!touch.touched) return touch;
  std::vector<double> depth;
  for (auto tick = first; tick != run.ticks.end(); ++tick) depth.push_back(tick->p_W_m.x());
  touch.stable = run.whole() && !oscillates(depth, 5e-4);

  // The speed over the last 5 ms before the touch.
  const auto since =
      std::find_if(run.ticks.begin(), first, [&](const ServoTick& tick) { return tick.t_s >= first->t_s - 5e-3; });
  const double speed = since == first ? 0.0 : (since->p_W_m.x() - first->p_W_m.x()) / (first->t_s - since->t_s);
  double rate = 0.0;
  for (auto tick = first; std::next(tick) != run.ticks.end() && tick->t_s < first->t_s + 10e-3; ++tick) {
    const auto next = std::next(tick);
    rate = std::max(rate, (next->allowed_N.x() - tick->allowed_N.x()) / (next->t_s - tick->t_s));
  }
  if (speed > 5e-3) touch.rate_hardness_N_per_m = rate / speed;
  double force = 0.0, rest = 0.0;
  for (auto tick = run.ticks.end() - static_cast<std::ptrdiff_t>(left / 4); tick != run.ticks.end(); ++tick)
    force += tick->allowed_N.x(), rest -= tick->p_W_m.x();
  if (rest > 0.0) touch.rendered_N_per_m = force / rest;
  return touch;
}

}  // namespace

Finding wall_sweep(Bench& bench, const LabLimits& limits, const WallSweep& sweep) {
  Finding finding;
  finding.test = "wall-sweep";
  Curve hardness{"rate-hardness", {}, {}, true}, rendered{"stiffness rendered", {}, {}, true},
      width{"stiffest stable wall", {}, {}, true};
  const double limit_N = bench.limits.force_N;
  for (const double damping : sweep.damping_N_s_per_m) {
    std::vector<double> stiffness;
    std::vector<bool> stable;
    for (int step = 0;; ++step) {  // by half an octave
      const double k = sweep.softest_N_per_m * std::exp2(0.5 * step);
      if (k > 1.001 * sweep.stiffest_N_per_m) break;
      sweep.prepare();
      bench.tell(fmt::format("press the handle lightly against the wall x = 0 ({:.0f} N/m)", k));
      const auto run = run_servo(bench, sweep.trial_s, [&](const DeviceState& s, double) -> Vec3 {
        if (s.p_W_m.x() >= 0.0) return Vec3::Zero();
        return {std::clamp(-k * s.p_W_m.x() - damping * s.v_W_m_per_s.x(), 0.0, limit_N), 0.0, 0.0};
      });
      if (run.stopped || run.trip == Trip::dead_man || run.trip == Trip::asked)
        throw DeviceError(DeviceStatus::failed, "wall-sweep: stopped by the person at the device");
      const auto touch = judge(run);
      if (!touch.touched && run.trip == Trip::none) {
        throw DeviceError(
            DeviceStatus::failed,
            fmt::format("wall-sweep: at {:.0f} N/m the handle did not come from x > 0 to rest against the wall", k),
            "lift it off before each trial, then press");
      }
      finding.runs.push_back(run);
      stiffness.push_back(k);
      stable.push_back(touch.stable);
      if (!touch.stable) break;
      if (damping == 0.0) {
        rendered.x.push_back(k), rendered.y.push_back(touch.rendered_N_per_m);
        if (touch.rate_hardness_N_per_m > 0.0)
          hardness.x.push_back(k), hardness.y.push_back(touch.rate_hardness_N_per_m);
      }
    }
    const double z = z_width_N_per_m(stiffness, stable);
    finding.measurements.push_back({fmt::format("z_width_N_per_m.damping_{:g}", damping), z});
    width.x.push_back(damping), width.y.push_back(z);
    if (damping == 0.0) {
      finding.measurements.push_back({"z_width_N_per_m", z});
      finding.limits.push_back({"z_width_N_per_m", limits.z_width_N_per_m});
    }
  }
  double hardest = 0.0;
  for (const double h : hardness.y) hardest = std::max(hardest, h);
  if (!hardness.y.empty()) finding.measurements.push_back({"rate_hardness_N_per_m", hardest});
  finding.pictures = {{"Stiffness and rate-hardness", "stiffness asked for [N/m]", "[N/m]", {rendered, hardness}},
                      {"Z-width", "virtual damping [N s/m]", "stiffest stable wall [N/m]", {width}}};
  return finding;
}

}  // namespace touchstone::hil
