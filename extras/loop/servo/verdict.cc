#include "servo/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "harness/perception/features/spectrum.h"
#include "harness/perception/judge/vibration_scale.h"

namespace touchstone::servo {
namespace {

constexpr double window_s = 0.128;
constexpr double sustained = 0.9;  // of the amplitude, a window later: dies away no faster than in 1.2 s
constexpr double onset_s = 0.064;  // as harness/perception takes it for the burst after contact
constexpr double lowest_Hz = 20.0;
constexpr double highest_Hz = 1000.0;
constexpr double hann_bandwidth = 1.5;  // bins of noise that the window sums up
constexpr std::size_t times_thrown_out = 3;
constexpr double share_thrown_out = 0.02;
constexpr double least_real_time = 2.0;
constexpr double timed_from_s = 0.5;  // what is shorter says little of a renderer's cost

struct Stretch {
  std::size_t begin = 0, end = 0;
};

std::vector<Stretch> contacts(const LoopTrace& trace, std::size_t size) {
  std::vector<Stretch> out;
  for (std::size_t i = 0; i < size; ++i) {
    if (trace.contact[i] == 0) continue;
    const std::size_t begin = i;
    while (i < size && trace.contact[i] != 0) ++i;
    out.push_back({begin, i});
  }
  return out;
}

// Power of all axes by bin: the squared amplitudes of sines.
std::vector<double> powers(const std::vector<Vec3>& f_W_N, const Stretch& window, double rate_Hz, double& step_Hz) {
  std::vector<double> sum;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> x;
    for (std::size_t i = window.begin; i < window.end; ++i) x.push_back(f_W_N[i][axis]);
    const auto spectrum = perception::amplitude_spectrum(x, rate_Hz, highest_Hz);
    step_Hz = spectrum.step_Hz;
    sum.resize(spectrum.amplitude.size(), 0.0);
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += std::pow(spectrum.amplitude[k], 2);
  }
  return sum;
}

// Powers over those of the thresholds, summed.
double over_threshold(const std::vector<double>& power, double step_Hz, const perception::Thresholds& thresholds) {
  double sum = 0.0;
  for (std::size_t k = 0; k < power.size(); ++k) {
    const double f_Hz = static_cast<double>(k) * step_Hz;
    if (f_Hz >= lowest_Hz) sum += power[k] / hann_bandwidth / std::pow(thresholds.vibration_force_N(f_Hz), 2);
  }
  return sum;
}

// Frequency and amplitude of the largest peak.
Vibration peak_of(const std::vector<double>& power, double step_Hz) {
  Vibration out;
  std::size_t peak = 0;
  for (std::size_t k = 1; k < power.size(); ++k) {
    if (static_cast<double>(k) * step_Hz >= lowest_Hz && (peak == 0 || power[k] > power[peak])) peak = k;
  }
  if (peak == 0) return out;
  // The window spreads a sine over its bin and the neighbours; where the power lies among them is its frequency.
  double sum = 0.0, moment = 0.0;
  for (std::size_t k = peak - 1; k <= std::min(peak + 1, power.size() - 1); ++k) {
    sum += power[k];
    moment += power[k] * static_cast<double>(k);
  }
  if (sum > 0.0) out.frequency_Hz = step_Hz * moment / sum;
  out.amplitude_N = std::sqrt(sum / hann_bandwidth);
  return out;
}

struct Window {
  Vibration loops, encoders, own;
};

// What `all` has more than `some`, bin by bin.
std::vector<double> beyond(std::vector<double> all, const std::vector<double>& some) {
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = std::max(0.0, all[k] - some[k]);
  return all;
}

// Forces are those on the hand.
Window judge_window(const LoopRuns& runs, const Stretch& part, double rate_Hz,
                    const perception::Thresholds& thresholds) {
  double step_Hz = 0.0;
  const perception::VibrationScale scale(thresholds);
  const auto felt_jnd = [&](const std::vector<double>& power) {
    return scale.from_nothing(over_threshold(power, step_Hz, thresholds));
  };
  const std::vector<double> all = powers(runs.run.felt_W_N, part, rate_Hz, step_Hz);
  const std::vector<double> own = powers(runs.ideal.felt_W_N, part, rate_Hz, step_Hz);
  const std::vector<double> stepped =
      runs.stepped.size() == 0 ? own : powers(runs.stepped.felt_W_N, part, rate_Hz, step_Hz);
  Window out{peak_of(beyond(all, own), step_Hz), peak_of(beyond(stepped, own), step_Hz), peak_of(own, step_Hz)};
  const double own_jnd = felt_jnd(own), stepped_jnd = felt_jnd(stepped);
  out.own.jnd = own_jnd;
  out.encoders.jnd = std::max(0.0, stepped_jnd - own_jnd);
  out.loops.jnd = std::max(0.0, felt_jnd(all) - std::max(own_jnd, stepped_jnd));
  out.loops.at_s = out.encoders.at_s = out.own.at_s = 0.5 * (runs.run.t_s[part.begin] + runs.run.t_s[part.end - 1]);
  return out;
}

void keep_worse(Vibration& worst, const Vibration& found) {
  if (found.jnd > worst.jnd) worst = found;
}

void judge_stretch(const LoopRuns& runs, const Stretch& part, std::size_t length, double rate_Hz,
                   const perception::Thresholds& thresholds, Judgement& out) {
  std::vector<Window> windows;  // each begins in the middle of the one before
  for (std::size_t begin = part.begin; begin + length <= part.end; begin += length / 2)
    windows.push_back(judge_window(runs, {begin, begin + length}, rate_Hz, thresholds));
  for (std::size_t i = 0; i < windows.size(); ++i) {
    keep_worse(out.ringing, windows[i].loops);
    keep_worse(out.encoder, windows[i].encoders);
    keep_worse(out.own, windows[i].own);
    if (i + 2 >= windows.size()) continue;
    const Vibration &now = windows[i].loops, &later = windows[i + 2].loops;
    if (later.amplitude_N >= sustained * now.amplitude_N) keep_worse(out.buzz, now.jnd < later.jnd ? now : later);
  }
}

double largest_N(const std::vector<Vec3>& f_W_N, std::size_t begin, std::size_t end, std::size_t& at) {
  double largest = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    if (f_W_N[i].norm() <= largest) continue;
    largest = f_W_N[i].norm();
    at = i;
  }
  return largest;
}

struct Lost {
  std::size_t times = 0, samples = 0;
};

Lost lost_contact(const LoopTrace& run, const Stretch& part) {
  Lost out;
  for (std::size_t i = part.begin; i < part.end; ++i) {
    if (run.contact[i] != 0) continue;
    ++out.samples;
    if (i == part.begin || run.contact[i - 1] != 0) ++out.times;
  }
  return out;
}

double felt_in_air_N(const LoopTrace& run, std::size_t size) {
  double square = 0.0;
  std::size_t samples = 0;
  for (std::size_t i = 0; i < size; ++i) {
    if (run.contact[i] != 0) continue;
    square += run.felt_W_N[i].squaredNorm();
    ++samples;
  }
  return samples == 0 ? 0.0 : std::sqrt(square / static_cast<double>(samples));
}

}  // namespace

std::string_view name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::stable:
      return "stable";
    case Verdict::buzzes:
      return "buzzes";
    case Verdict::unstable:
      return "unstable";
    case Verdict::cannot_tell:
      return "cannot tell";
  }
  return "";
}

LoopRuns run_for_judgement(rendering::Renderer& renderer, const MotionColumns& path, const LoopParameters& parameters) {
  LoopRuns out;
  const auto began = std::chrono::steady_clock::now();
  out.run = run_loop(renderer, path, parameters);
  const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  out.real_time_factor = static_cast<double>(out.run.size()) * parameters.period_s / std::max(elapsed_s, 1e-9);
  out.too_slow = out.real_time_factor < least_real_time && elapsed_s > timed_from_s;
  if (out.too_slow) return out;
  out.open = run_open(renderer, path, parameters);
  out.ideal = run_ideal_loop(renderer, path, parameters);
  return out;
}

void run_encoder(LoopRuns& runs, rendering::Renderer& renderer, const MotionColumns& path,
                 const LoopParameters& parameters) {
  if (!runs.too_slow && parameters.resolution_m > 0.0)
    runs.stepped = run_ideal_loop(renderer, path, parameters, parameters.resolution_m);
}

Judgement judge(const LoopRuns& runs, const perception::Thresholds& thresholds, double settling_s) {
  const LoopTrace &run = runs.run, &ideal = runs.ideal, &open = runs.open;
  Judgement out;
  out.real_time_factor = runs.real_time_factor;
  out.too_slow = runs.too_slow;
  std::size_t size = std::min(run.size(), ideal.size());
  if (runs.stepped.size() > 0) size = std::min(size, runs.stepped.size());
  if (size < 2) return out;
  const double rate_Hz = static_cast<double>(run.size() - 1) / (run.t_s.back() - run.t_s.front());
  const auto samples = [rate_Hz](double time_s) { return static_cast<std::size_t>(std::lround(time_s * rate_Hz)); };
  const std::size_t settling = samples(settling_s), length = samples(window_s), onset = samples(onset_s);

  std::size_t judged = 0, limited = 0;
  std::size_t after_last = 0;
  Lost lost;
  for (const Stretch& contact : contacts(ideal, size)) {
    std::size_t at = contact.begin, ideal_at = contact.begin;
    const std::size_t kick_end = std::min(contact.begin + onset, size);
    const double expected_N = largest_N(ideal.felt_W_N, contact.begin, kick_end, ideal_at);
    const double kick_N = largest_N(run.felt_W_N, contact.begin, kick_end, at) - expected_N;
    const auto since_last = std::span(open.contact).subspan(after_last, contact.begin - after_last);
    after_last = contact.end;
    if (std::ranges::find(since_last, 0) != since_last.end() && kick_N > out.kick_N) {
      out.kick_N = kick_N;
      out.kick_jnd = kick_N / std::max(thresholds.force.just_noticeable_difference(expected_N),
                                       thresholds.force.absolute_threshold);
      out.kick_at_s = run.t_s[at];
    }
    if (contact.end - contact.begin < settling + 2 * length) continue;
    const Stretch part{contact.begin + settling, contact.end};
    judged += part.end - part.begin;
    const Lost here = lost_contact(run, {part.begin + (part.end - part.begin) / 2, part.end});
    lost.times += here.times;
    lost.samples += here.samples;
    for (std::size_t i = part.begin; i < part.end; ++i) limited += run.limited[i];
    judge_stretch(runs, part, length, rate_Hz, thresholds, out);
  }
  out.energy_J = std::max(0.0, *std::ranges::max_element(run.by_actuator_J));
  out.device_felt_N = felt_in_air_N(run, size);
  out.thrown_out = lost.times;
  out.judged_s = static_cast<double>(judged) / rate_Hz;
  if (judged > 0) out.limited_share = static_cast<double>(limited) / static_cast<double>(judged);
  const bool thrown = lost.times >= times_thrown_out &&
                      2.0 * static_cast<double>(lost.samples) >= share_thrown_out * static_cast<double>(judged);
  if (run.left_at_s && !ideal.left_at_s) {
    out.verdict = Verdict::unstable;
  } else if (judged == 0) {
    out.verdict = Verdict::cannot_tell;
  } else if (thrown) {
    out.verdict = Verdict::unstable;
  } else {
    out.verdict = out.buzz.jnd >= 1.0 ? Verdict::buzzes : Verdict::stable;
  }
  return out;
}

Vibration largest_vibration(const std::vector<Vec3>& f_W_N, double rate_Hz, const perception::Thresholds& thresholds) {
  const auto length = static_cast<std::size_t>(std::lround(window_s * rate_Hz));
  const perception::VibrationScale scale(thresholds);
  Vibration worst;
  for (std::size_t begin = 0; begin + length <= f_W_N.size(); begin += std::max<std::size_t>(1, length / 2)) {
    const auto first = f_W_N.begin() + static_cast<std::ptrdiff_t>(begin);
    if (std::any_of(first, first + static_cast<std::ptrdiff_t>(length), [](const Vec3& f) { return f.isZero(0.0); }))
      continue;
    double step_Hz = 0.0;
    const std::vector<double> power = powers(f_W_N, {begin, begin + length}, rate_Hz, step_Hz);
    Vibration own = peak_of(power, step_Hz);
    own.jnd = scale.from_nothing(over_threshold(power, step_Hz, thresholds));
    own.at_s = (static_cast<double>(begin) + 0.5 * static_cast<double>(length)) / rate_Hz;
    keep_worse(worst, own);
  }
  return worst;
}

std::string sentence(const Judgement& judgement) {
  const std::string vibration = fmt::format("{:.0f} Hz with {:.3g} N ({:.2g} JND)", judgement.buzz.frequency_Hz,
                                            judgement.buzz.amplitude_N, judgement.buzz.jnd);
  switch (judgement.verdict) {
    case Verdict::stable:
      if (judgement.encoder.jnd >= 1.0) {
        return fmt::format(
            "Stable. The encoder is felt: its steps shake the hand with up to {:.3g} N ({:.2g} JND) as it "
            "moves.",
            judgement.encoder.amplitude_N, judgement.encoder.jnd);
      }
      return fmt::format("Stable: the largest vibration that stays is {:.3g} N, {:.2g} JND, which is not felt.",
                         judgement.buzz.amplitude_N, judgement.buzz.jnd);
    case Verdict::buzzes:
      return fmt::format("Buzzes at {}.", vibration);
    case Verdict::unstable:
      return fmt::format("Unstable: the hand is thrown out of contact {} times in {:.2g} s, at {}.",
                         judgement.thrown_out, judgement.judged_s, vibration);
    case Verdict::cannot_tell:
      if (judgement.too_slow) {
        return fmt::format(
            "Cannot tell: a step of the renderer takes {:.2g} of the servo's period on this machine, where up to 0.5 "
            "was "
            "expected; measure its cost with touchstone replay --timing.",
            1.0 / judgement.real_time_factor);
      }
      return fmt::format("Cannot tell: on an ideal servo the hand never stays in contact for {:.2g} s.",
                         device_settling_s + 2.0 * window_s);
  }
  return "";
}

}  // namespace touchstone::servo
