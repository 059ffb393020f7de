#include "lab/force_experiments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "lab/analysis.h"

namespace touchstone::hil {
namespace {

constexpr double rate_Hz = 1000.0;

ServoRun whole_run(Bench& bench, double seconds, const WantedForce& wanted, const char* test) {
  if (bench.sensor == nullptr)
    throw UsageError(
        fmt::format("{}: needs a force sensor that holds the handle; connect one in the hardware map", test));
  auto run = run_servo(bench, seconds, wanted, rate_Hz);
  if (!run.whole()) {
    throw DeviceError(
        DeviceStatus::failed,
        fmt::format("{}: the run was cut short at {:.3g} s: {}", test, run.ticks.empty() ? 0.0 : run.ticks.back().t_s,
                    run.stopped ? "stopped by the user" : to_string(run.trip)),
        "run it again");
  }
  double last = 0.0, gap = 0.0;
  for (const auto& sample : run.wrenches) gap = std::max(gap, sample.t_s - last), last = sample.t_s;
  gap = std::max(gap, run.ticks.back().t_s - last);
  if (gap > 0.02 || static_cast<double>(run.wrenches.size()) < 0.5 * rate_Hz * seconds) {
    throw DeviceError(
        DeviceStatus::failed,
        fmt::format("{}: the sensor gave {} samples in {:.3g} s, with a gap of {:.3g} s", test, run.wrenches.size(),
                    seconds, gap),
        "at least one per two ticks without a gap is needed: quiet the machine, or raise the sensor's rate");
  }
  return run;
}

// For clamped devices: any step up to the limit in one tick.
struct LiftedSlew {
  explicit LiftedSlew(Bench& b) : bench(b), before(b.limits.slew_N_per_s) {
    bench.limits.slew_N_per_s = 4.0 * bench.limits.force_N * rate_Hz;
  }
  ~LiftedSlew() { bench.limits.slew_N_per_s = before; }
  LiftedSlew(const LiftedSlew&) = delete;
  LiftedSlew& operator=(const LiftedSlew&) = delete;
  Bench& bench;
  double before;
};

// The commanded force along an axis as it was held from tick to tick.
double held_command(const std::vector<ServoTick>& ticks, const Vec3& along, double t_s) {
  const auto after =
      std::upper_bound(ticks.begin(), ticks.end(), t_s, [](double t, const ServoTick& tick) { return t < tick.t_s; });
  return after == ticks.begin() ? 0.0 : std::prev(after)->allowed_N.dot(along);
}

std::vector<double> maximum_length_sequence() {
  // x^9 + x^5 + 1
  std::vector<double> bits;
  unsigned state = 1;
  for (int i = 0; i < 511; ++i) {
    bits.push_back((state & 1U) != 0 ? 1.0 : -1.0);
    state = state >> 1U | (((state ^ state >> 4U) & 1U) << 8U);
  }
  return bits;
}

// Best lag of `force` behind what `command(t)` says, between 0 and `most_s`, by correlation and a parabola at its peak.
double best_lag(const std::vector<double>& t_s, const std::vector<double>& force, double most_s,
                const std::function<double(double)>& command) {
  constexpr double step = 2e-4;
  std::vector<double> agreement;
  double lag = 0.0;
  while (lag <= most_s) {
    double sum = 0.0, square = 0.0;
    for (std::size_t i = 0; i < t_s.size(); ++i) {
      const double u = command(t_s[i] - lag);
      sum += u * force[i], square += u * u;
    }
    agreement.push_back(square > 0.0 ? sum / std::sqrt(square) : 0.0);
    lag += step;
  }
  const auto peak = static_cast<std::size_t>(std::max_element(agreement.begin(), agreement.end()) - agreement.begin());
  if (peak == 0 || peak + 1 == agreement.size()) return step * static_cast<double>(peak);
  const double a = agreement[peak - 1], b = agreement[peak], c = agreement[peak + 1];
  return step * (static_cast<double>(peak) + 0.5 * (a - c) / (a - 2 * b + c));
}

}  // namespace

Finding noise_and_drift(const std::vector<WrenchSample>& samples, double lost) {
  constexpr double quietest_N = 1e-9, loudest_N = 0.1, session_s = 60.0, standard_errors = 5.0;
  const double seconds = samples.back().t_s - samples.front().t_s;
  const double rate = static_cast<double>(samples.back().sequence - samples.front().sequence) / seconds;
  const NoiseFloor noise = noise_floor(samples, rate);
  // Of a slope through n points of white noise, evenly over T: sigma sqrt(12 / n) / T in each axis.
  const double slope_error_N_per_s =
      noise.sigma_N.norm() * std::sqrt(12.0 / static_cast<double>(samples.size())) / seconds;
  Finding finding;
  finding.test = "noise-floor";
  finding.measurements = {{"rate_Hz", rate},
                          {"noise_fx_N", noise.sigma_N.x()},
                          {"noise_fy_N", noise.sigma_N.y()},
                          {"noise_fz_N", noise.sigma_N.z()},
                          {"quietest_N", noise.sigma_N.minCoeff()},
                          {"loudest_N", noise.sigma_N.maxCoeff()},
                          {"drift_N_per_s", noise.drift_N_per_s.norm()},
                          {"lost", lost}};
  finding.limits = {{"quietest_N", quietest_N},
                    {"loudest_N", 0.0, loudest_N},
                    {"drift_N_per_s", 0.0, loudest_N / session_s + standard_errors * slope_error_N_per_s},
                    {"lost", 0.0, 0.0}};
  finding.pictures = {{"Allan deviation of the loudest axis",
                       "averaging time [s]",
                       "deviation [N]",
                       {{"measured", noise.tau_s, noise.allan_N, false}}}};
  return finding;
}

Finding force_step(Bench& bench, const LabLimits& limits, double force_N, const Vec3& along, int repeats) {
  constexpr double hold_s = 0.25;
  const LiftedSlew lifted(bench);
  const auto on = [&](double t) { return static_cast<int>(std::floor(t / hold_s)) % 2 == 1; };
  const auto run = whole_run(
      bench, hold_s * (2 * repeats + 1),
      [&](const DeviceState&, double t) -> Vec3 { return on(t) ? Vec3(force_N * along) : Vec3::Zero(); }, "force-step");
  // Each rise over the others, from half a hold before its command to the end of its hold.
  std::vector<std::pair<double, double>> folded;
  std::size_t next = 0;
  for (std::size_t i = 1; i < run.ticks.size(); ++i) {
    const bool rises =
        run.ticks[i].allowed_N.dot(along) > 0.5 * force_N && run.ticks[i - 1].allowed_N.dot(along) <= 0.0;
    if (!rises) continue;
    const double at = run.ticks[i].t_s;
    while (next < run.wrenches.size() && run.wrenches[next].t_s < at - 0.5 * hold_s) ++next;
    for (std::size_t j = next; j < run.wrenches.size() && run.wrenches[j].t_s < at + 0.95 * hold_s; ++j)
      folded.emplace_back(run.wrenches[j].t_s - at, run.wrenches[j].wrench.f_N.dot(along));
  }
  std::sort(folded.begin(), folded.end());
  std::vector<double> t, f;
  for (const auto& [time, force] : folded) t.push_back(time), f.push_back(force);
  if (t.size() < 100)
    throw DeviceError(DeviceStatus::failed,
                      fmt::format("force-step: {} samples about the steps, and 100 are needed", t.size()),
                      "is the sensor clamped to the handle, and does it send?");
  const auto r = step_response(t, f, 0.0);
  Finding finding;
  finding.test = "force-step";
  finding.measurements = {{"step_commanded_N", force_N},
                          {"step_measured_N", r.final_N - r.initial_N},
                          {"step_error", std::abs((r.final_N - r.initial_N) / force_N - 1.0)},
                          {"step_delay_s", r.delay_s},
                          {"step_rise_s", r.rise_s},
                          {"step_overshoot", r.overshoot},
                          {"step_bandwidth_Hz", r.bandwidth_Hz}};
  finding.limits = {
      {"step_error", 0.0, limits.force_error},
      {"step_overshoot", -1.0, limits.overshoot},
      {"step_bandwidth_Hz", limits.bandwidth_Hz},
      // Half of the height is there after the latency and what the bandwidth takes.
      {"step_delay_s", 0.0, limits.latency_s + std::numbers::ln2 / (2 * std::numbers::pi * limits.bandwidth_Hz)}};
  finding.runs = {run};
  finding.pictures = {{"Force step", "time since the command [s]", "force [N]", {{"measured", t, f, true}}}};
  finding.pictures[0].curves.push_back(
      {"commanded", {-0.5 * hold_s, 0.0, 0.0, 0.95 * hold_s}, {0.0, 0.0, force_N, force_N}});
  return finding;
}

Finding force_latency(Bench& bench, const LabLimits& limits, double force_N, const Vec3& along) {
  const LiftedSlew lifted(bench);
  const auto bits = maximum_length_sequence();
  const double period_s = static_cast<double>(bits.size()) / rate_Hz;
  constexpr int periods = 6;
  const auto run = whole_run(
      bench, periods * period_s,
      [&](const DeviceState&, double t) -> Vec3 {
        const auto i = static_cast<std::size_t>(std::llround(t * rate_Hz)) % bits.size();
        return 0.5 * force_N * (1.0 + bits[i]) * along;
      },
      "force-latency");
  // Without the first period, in which the response builds up.
  std::vector<double> t, f;
  double mean = 0.0;
  for (const auto& s : run.wrenches) {
    if (s.t_s < period_s) continue;
    t.push_back(s.t_s), f.push_back(s.wrench.f_N.dot(along));
    mean += f.back();
  }
  if (t.size() < bits.size())
    throw DeviceError(DeviceStatus::failed,
                      fmt::format("force-latency: {} samples, and {} are needed", t.size(), bits.size()),
                      "raise the sensor's rate");
  for (double& v : f) v -= mean / static_cast<double>(t.size());
  const double command_mean = 0.5 * force_N * (1.0 + 1.0 / static_cast<double>(bits.size()));
  const auto command = [&](double at) { return held_command(run.ticks, along, at) - command_mean; };
  const double lag = best_lag(t, f, 0.05, command);

  // Fourier sums over whole periods at the sequence's harmonics.
  const double from = t.front(), to = from + (periods - 1 - 0.01) * period_s;
  std::vector<double> frequency, gain;
  for (std::size_t harmonic = 1; harmonic <= 255; harmonic += harmonic < 20 ? 1 : 4) {
    const double hz = static_cast<double>(harmonic) / period_s, w = 2 * std::numbers::pi * hz;
    std::complex<double> y, u;
    for (std::size_t i = 1; i + 1 < t.size() && t[i] < to; ++i)
      y += f[i] * std::polar(0.5 * (t[i + 1] - t[i - 1]), -w * t[i]);
    for (std::size_t i = 0; i + 1 < run.ticks.size(); ++i) {
      const double a = run.ticks[i].t_s, b = run.ticks[i + 1].t_s;
      if (a < from || a >= to) continue;
      const std::complex<double> whole =
          (std::polar(1.0, -w * b) - std::polar(1.0, -w * a)) / std::complex<double>(0.0, -w);
      u += (run.ticks[i].allowed_N.dot(along) - command_mean) * whole;
    }
    frequency.push_back(hz);
    gain.push_back(std::abs(y) / std::abs(u));
  }
  double steady = 0.0;
  for (std::size_t i = 0; i < 5; ++i) steady += gain[i] / 5.0;
  double bandwidth = frequency.back();  // at least that
  for (std::size_t i = 1; i < gain.size(); ++i) {
    const double level = std::numbers::sqrt2 / 2 * steady;
    if (gain[i] >= level) continue;
    bandwidth = frequency[i - 1] + (frequency[i] - frequency[i - 1]) *
                                       std::clamp((gain[i - 1] - level) / (gain[i - 1] - gain[i]), 0.0, 1.0);
    break;
  }
  Finding finding;
  finding.test = "force-latency";
  finding.measurements = {{"latency_s", lag}, {"gain_low", steady}, {"bandwidth_Hz", bandwidth}};
  finding.limits = {{"latency_s", 0.0, limits.latency_s},
                    {"gain_low", 1.0 - limits.force_error, 1.0 + limits.force_error},
                    {"bandwidth_Hz", limits.bandwidth_Hz}};
  finding.runs = {run};
  finding.pictures = {
      {"Gain from command to force", "frequency [Hz]", "gain [1]", {{"measured", frequency, gain, false}}}};
  return finding;
}

Finding golden_replay(Bench& bench, const LabLimits& limits, const GoldenForce& golden,
                      const std::function<Vec3(std::size_t)>& render, double force_limit_N) {
  constexpr double quiet_s = 0.25;
  double peak = 0.0, square = 0.0;
  for (const Vec3& f : golden.f_W_N) peak = std::max(peak, f.norm()), square += f.squaredNorm();
  const double golden_rms = std::sqrt(square / static_cast<double>(std::max<std::size_t>(1, golden.f_W_N.size())));
  if (golden.t_s.size() < 10 || golden.t_s.size() != golden.f_W_N.size() || !(peak > 0.0))
    throw BadData(fmt::format(
        "{}: a golden trajectory with at least 10 samples and forces was expected; choose another golden case",
        golden.name));
  const double scale = std::min(1.0, force_limit_N / peak), first = golden.t_s.front(),
               last = golden.t_s.back() - first;
  const LiftedSlew lifted(bench);
  std::size_t next = 0;
  Vec3 now = Vec3::Zero();
  double renderer_error = 0.0;
  const auto run = whole_run(
      bench, quiet_s + last,
      [&](const DeviceState&, double t) -> Vec3 {
        // Every sample in its order, also where a tick came late.
        while (next < golden.t_s.size() && golden.t_s[next] - first <= t - quiet_s + 1e-9) {
          now = render(next);
          renderer_error = std::max(renderer_error, (now - golden.f_W_N[next]).norm());
          ++next;
        }
        return scale * now;
      },
      "golden-replay");
  Vec3 bias = Vec3::Zero();
  double quiet = 0.0;
  for (const auto& s : run.wrenches) {
    if (s.t_s < quiet_s) bias += s.wrench.f_N, quiet += 1.0;
  }
  if (quiet < 10)
    throw DeviceError(DeviceStatus::failed, "golden-replay: fewer than 10 samples before the trajectory",
                      "does the sensor send?");
  bias /= quiet;
  const auto golden_at = [&](double t) -> Vec3 {
    const double at = t - quiet_s + first;
    if (at <= first) return at < first ? Vec3(Vec3::Zero()) : golden.f_W_N.front();
    const auto after = std::upper_bound(golden.t_s.begin(), golden.t_s.end(), at);
    if (after == golden.t_s.end()) return golden.f_W_N.back();
    const auto i = static_cast<std::size_t>(after - golden.t_s.begin());
    const double share = (at - golden.t_s[i - 1]) / (golden.t_s[i] - golden.t_s[i - 1]);
    return (1.0 - share) * golden.f_W_N[i - 1] + share * golden.f_W_N[i];
  };
  std::vector<double> t;
  std::vector<Vec3> measured;
  for (const auto& s : run.wrenches) {
    if (s.t_s < quiet_s) continue;
    t.push_back(s.t_s);
    measured.push_back((s.wrench.f_N - bias) / scale);
  }
  const auto error_at_lag = [&](double lag) {
    double sum = 0.0;
    for (std::size_t i = 0; i < t.size(); ++i) sum += (measured[i] - golden_at(t[i] - lag)).squaredNorm();
    return std::sqrt(sum / static_cast<double>(t.size()));
  };
  double lag = 0.0, least = error_at_lag(0.0);
  const double as_is = least;
  double tried = 5e-4;
  while (tried <= 0.05) {
    if (const double e = error_at_lag(tried); e < least) least = e, lag = tried;
    tried += 5e-4;
  }
  Finding finding;
  finding.test = "golden-replay";
  finding.measurements = {{"golden_peak_N", peak},
                          {"force_scale", scale},
                          {"renderer_error_N", renderer_error},
                          {"force_error_rms_N", as_is},
                          {"golden_rms_N", golden_rms},
                          {"force_error_share", as_is / golden_rms},
                          {"force_error_after_lag_N", least},
                          {"lag_s", lag},
                          {"saturated_ticks", static_cast<double>(run.saturated)}};
  finding.limits = {{"renderer_error_N", 0.0, 1e-6 * peak},
                    {"force_error_share", 0.0, limits.golden_error},
                    {"lag_s", 0.0, limits.latency_s},
                    {"saturated_ticks", 0.0, 0.0}};
  Picture picture{"Golden " + golden.name + " through renderer and device", "time [s]", "force [N]", {}};
  Curve golden_curve{"golden", {}, {}, false}, measured_curve{"measured", {}, {}, false};
  for (std::size_t i = 0; i < t.size(); i += std::max<std::size_t>(1, t.size() / 2000)) {
    golden_curve.x.push_back(t[i] - quiet_s), golden_curve.y.push_back(golden_at(t[i]).norm());
    measured_curve.x.push_back(t[i] - quiet_s), measured_curve.y.push_back(measured[i].norm());
  }
  picture.curves = {golden_curve, measured_curve};
  finding.runs = {run};
  finding.pictures = {picture};
  return finding;
}

}  // namespace touchstone::hil
