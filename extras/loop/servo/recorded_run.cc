#include "servo/recorded_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <optional>

#include "harness/base/error.h"
#include "harness/base/progress.h"

namespace touchstone::servo {
namespace {

constexpr double coarse_s = 4e-3;            // contact lasts longer
constexpr std::size_t coarse_samples = 400;  // of the recording, for the coarse search
constexpr double least_share = 0.5;          // of the recording, within the path

// A series of a trace between its samples; nothing outside of it.
std::optional<Vec3> at(const std::vector<double>& t_s, const std::vector<Vec3>& series, double time_s) {
  const auto after = std::ranges::upper_bound(t_s, time_s);
  if (after == t_s.begin() || after == t_s.end()) return std::nullopt;
  const auto i = static_cast<std::size_t>(after - t_s.begin());
  const double share = (time_s - t_s[i - 1]) / (t_s[i] - t_s[i - 1]);
  return series[i - 1] + share * (series[i] - series[i - 1]);
}

// The mean square of the difference of the positions, of every n-th sample; none where too few overlap.
double misfit_m2(const LoopTrace& run, const recording::Recording& recording, double shift_s, std::size_t every) {
  double sum = 0.0;
  std::size_t compared = 0, tried = 0;
  for (std::size_t i = 0; i < recording.size(); i += every) {
    ++tried;
    const auto simulated = at(run.t_s, run.tip_W_m, recording.motion.t_s[i] + shift_s);
    if (!simulated) continue;
    sum += (*simulated - recording.motion.p_W_m[i]).squaredNorm();
    ++compared;
  }
  if (static_cast<double>(compared) < least_share * static_cast<double>(tried))
    return std::numeric_limits<double>::infinity();
  return sum / static_cast<double>(compared);
}

double best_shift_s(const LoopTrace& run, const recording::Recording& recording) {
  const double path_s = run.t_s.back() - run.t_s.front();
  const double recorded_s = recording.motion.t_s.back() - recording.motion.t_s.front();
  const double first = run.t_s.front() - recording.motion.t_s.back() + least_share * recorded_s;
  const double last = run.t_s.back() - recording.motion.t_s.front() - least_share * recorded_s;
  const std::size_t every = std::max<std::size_t>(1, recording.size() / coarse_samples);
  double best = first, least = std::numeric_limits<double>::infinity();
  for (double shift_s = first; shift_s <= last; shift_s += coarse_s) {
    stop_if_asked();
    const double misfit = misfit_m2(run, recording, shift_s, every);
    if (misfit < least) best = shift_s, least = misfit;
  }
  if (!std::isfinite(least)) {
    throw BadData(fmt::format(
        "{}: it lasts {:g} s and the path {:g} s: half of the recording or more was expected to lie within the path",
        recording.source, recorded_s, path_s));
  }
  constexpr int bits = 24;
  return boost::math::tools::brent_find_minima(
             [&](double shift_s) { return std::min(misfit_m2(run, recording, shift_s, 1), 1e9); }, best - coarse_s,
             best + coarse_s, bits)
      .first;
}

std::string sentence_of(const RecordedComparison& own) {
  return fmt::format(
      "The recording {} the simulation: over {:.3g} s the positions differ by {:.2g} of {:.2g} mm, the forces by "
      "{:.2g} of "
      "{:.2g} N ({:.2g} JND; root mean squares); the largest vibration is {:.2g} N at {:.0f} Hz recorded, {:.2g} N at "
      "{:.0f} Hz simulated.",
      own.agrees ? "agrees with" : "differs from", own.compared_s, 1e3 * own.difference_m, 1e3 * own.motion_m,
      own.difference_N, own.force_N, own.difference_jnd, own.recorded.amplitude_N, own.recorded.frequency_Hz,
      own.simulated.amplitude_N, own.simulated.frequency_Hz);
}

RecordedComparison compare(const MassRun& mass, const LoopParameters& parameters, const recording::Recording& recording,
                           const perception::Thresholds& thresholds) {
  const LoopTrace& run = mass.run;
  RecordedComparison out;
  out.device_mass_kg = mass.device_mass_kg;
  out.shift_s = best_shift_s(run, recording);
  // At the instants of the simulation, so that both have one rate.
  std::vector<Vec3> recorded_N, simulated_N;
  std::vector<Vec3> recorded_m;
  for (std::size_t i = 0; i < run.size(); ++i) {
    const auto p_W_m = at(recording.motion.t_s, recording.motion.p_W_m, run.t_s[i] - out.shift_s);
    const auto f_W_N = at(recording.motion.t_s, recording.f_W_N, run.t_s[i] - out.shift_s);
    const auto acting_N = at(run.t_s, run.commanded_W_N, run.t_s[i] - parameters.latency_s);
    if (!p_W_m || !f_W_N || !acting_N) continue;
    recorded_m.push_back(*p_W_m);
    recorded_N.push_back(*f_W_N);
    simulated_N.push_back(*acting_N);
    out.difference_m += (*p_W_m - run.tip_W_m[i]).squaredNorm();
    out.difference_N += (*f_W_N - *acting_N).squaredNorm();
    out.force_N += f_W_N->squaredNorm();
  }
  if (recorded_m.empty()) throw BadData(recording.source + ": nothing of it lies within the path");
  const auto samples = static_cast<double>(recorded_m.size());
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : recorded_m) mean += p / samples;
  for (const Vec3& p : recorded_m) out.motion_m += (p - mean).squaredNorm();
  for (double* const square : {&out.motion_m, &out.difference_m, &out.force_N, &out.difference_N})
    *square = std::sqrt(*square / samples);
  out.compared_s = samples * parameters.period_s;
  out.difference_jnd = out.difference_N / std::max(thresholds.force.just_noticeable_difference(out.force_N),
                                                   thresholds.force.absolute_threshold);
  out.recorded = largest_vibration(recorded_N, 1.0 / parameters.period_s, thresholds);
  out.simulated = largest_vibration(simulated_N, 1.0 / parameters.period_s, thresholds);
  out.agrees = out.difference_jnd < 1.0 && std::abs(out.recorded.jnd - out.simulated.jnd) < 1.0;
  out.sentence = sentence_of(out);
  return out;
}

}  // namespace

RecordedComparison compare_recorded(const LoopEvaluation& evaluation, const LoopSetup& setup,
                                    const recording::Recording& recording, const perception::Thresholds& thresholds) {
  if (recording.f_W_N.empty())
    throw BadData(recording.source + ": no force: the force on the device was expected (fx_N, fy_N, fz_N)");
  if (recording.size() < 2) throw BadData(recording.source + ": two samples or more were expected");
  std::optional<RecordedComparison> best;
  for (const MassRun& run : evaluation.runs) {
    if (run.run.size() < 2) continue;
    auto own = compare(run, setup.with_mass(run.device_mass_kg), recording, thresholds);
    if (!best || own.difference_m < best->difference_m) best = std::move(own);
  }
  if (!best)
    throw BadData(recording.source + ": the path is shorter than two periods; there is nothing to compare it with");
  return *best;
}

}  // namespace touchstone::servo
