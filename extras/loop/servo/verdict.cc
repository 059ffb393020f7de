#include "servo/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "harness/perception/features/spectrum.h"
#include "harness/perception/judge/vibration_scale.h"

namespace touchstone::servo {
namespace {

constexpr double kSettling_s = 0.1;
constexpr double kWindow_s = 0.128;
constexpr double kSustained = 0.9;  // of the amplitude, a window later: dies away no faster than in 1.2 s
constexpr double kOnset_s = 0.064;  // as harness/perception takes it for the burst after contact
constexpr double kLowest_Hz = 20.0;
constexpr double kHighest_Hz = 1000.0;
constexpr double kHannBandwidth = 1.5;  // bins of noise that the window sums up
constexpr std::size_t kTimesThrownOut = 3;
constexpr double kShareThrownOut = 0.02;

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
    const auto spectrum = perception::amplitude_spectrum(x, rate_Hz, kHighest_Hz);
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
    if (f_Hz >= kLowest_Hz) sum += power[k] / kHannBandwidth / std::pow(thresholds.vibration_force_N(f_Hz), 2);
  }
  return sum;
}

// Frequency and amplitude of the largest peak.
Vibration peak_of(const std::vector<double>& power, double step_Hz) {
  Vibration out;
  std::size_t peak = 0;
  for (std::size_t k = 1; k < power.size(); ++k) {
    if (static_cast<double>(k) * step_Hz >= kLowest_Hz && (peak == 0 || power[k] > power[peak])) peak = k;
  }
  if (peak == 0) return out;
  // The window spreads a sine over its bin and the neighbours; where the power lies among them is its frequency.
  double sum = 0.0, moment = 0.0;
  for (std::size_t k = peak - 1; k <= std::min(peak + 1, power.size() - 1); ++k) {
    sum += power[k];
    moment += power[k] * static_cast<double>(k);
  }
  if (sum > 0.0) out.frequency_Hz = step_Hz * moment / sum;
  out.amplitude_N = std::sqrt(sum / kHannBandwidth);
  return out;
}

struct Window {
  Vibration beyond, own;
};

// Forces are those on the hand.
Window judge_window(const LoopTrace& run, const LoopTrace& ideal, const Stretch& part, double rate_Hz,
                    const perception::Thresholds& thresholds) {
  double step_Hz = 0.0;
  std::vector<double> all = powers(run.felt_W_N, part, rate_Hz, step_Hz);
  const std::vector<double> own = powers(ideal.felt_W_N, part, rate_Hz, step_Hz);
  const perception::VibrationScale scale(thresholds);
  const double own_jnd = scale.from_nothing(over_threshold(own, step_Hz, thresholds));
  const double all_jnd = scale.from_nothing(over_threshold(all, step_Hz, thresholds));
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = std::max(0.0, all[k] - own[k]);
  Window out{peak_of(all, step_Hz), peak_of(own, step_Hz)};
  out.beyond.jnd = std::max(0.0, all_jnd - own_jnd);
  out.own.jnd = own_jnd;
  out.beyond.at_s = out.own.at_s = 0.5 * (run.t_s[part.begin] + run.t_s[part.end - 1]);
  return out;
}

void keep_worse(Vibration& worst, const Vibration& found) {
  if (found.jnd > worst.jnd) worst = found;
}

void judge_stretch(const LoopTrace& run, const LoopTrace& ideal, const Stretch& part, std::size_t length,
                   double rate_Hz, const perception::Thresholds& thresholds, Judgement& out) {
  std::vector<Window> windows;  // each begins in the middle of the one before
  for (std::size_t begin = part.begin; begin + length <= part.end; begin += length / 2)
    windows.push_back(judge_window(run, ideal, {begin, begin + length}, rate_Hz, thresholds));
  for (std::size_t i = 0; i < windows.size(); ++i) {
    keep_worse(out.ringing, windows[i].beyond);
    keep_worse(out.own, windows[i].own);
    if (i + 2 >= windows.size()) continue;
    const Vibration &now = windows[i].beyond, &later = windows[i + 2].beyond;
    if (later.amplitude_N >= kSustained * now.amplitude_N) keep_worse(out.buzz, now.jnd < later.jnd ? now : later);
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

Judgement judge(const LoopTrace& run, const LoopTrace& ideal, const perception::Thresholds& thresholds) {
  Judgement out;
  const std::size_t size = std::min(run.size(), ideal.size());
  if (size < 2) return out;
  const double rate_Hz = static_cast<double>(run.size() - 1) / (run.t_s.back() - run.t_s.front());
  const auto samples = [rate_Hz](double time_s) { return static_cast<std::size_t>(std::lround(time_s * rate_Hz)); };
  const std::size_t settling = samples(kSettling_s), length = samples(kWindow_s), onset = samples(kOnset_s);

  std::size_t judged = 0, limited = 0;
  Lost lost;
  for (const Stretch& contact : contacts(ideal, size)) {
    std::size_t at = contact.begin, ideal_at = contact.begin;
    const std::size_t kick_end = std::min(contact.begin + onset, size);
    const double kick_N = largest_N(run.felt_W_N, contact.begin, kick_end, at) -
                          largest_N(ideal.felt_W_N, contact.begin, kick_end, ideal_at);
    if (contact.begin > 0 && kick_N > out.kick_N) {
      out.kick_N = kick_N;
      out.kick_at_s = run.t_s[at];
    }
    if (contact.end - contact.begin < settling + 2 * length) continue;
    const Stretch part{contact.begin + settling, contact.end};
    judged += part.end - part.begin;
    const Lost here = lost_contact(run, part);
    lost.times += here.times;
    lost.samples += here.samples;
    for (std::size_t i = part.begin; i < part.end; ++i) limited += run.limited[i];
    judge_stretch(run, ideal, part, length, rate_Hz, thresholds, out);
  }
  out.energy_J = std::max(0.0, *std::ranges::max_element(run.by_actuator_J));
  out.device_felt_N = felt_in_air_N(run, size);
  out.thrown_out = lost.times;
  out.judged_s = static_cast<double>(judged) / rate_Hz;
  if (judged > 0) out.limited_share = static_cast<double>(limited) / static_cast<double>(judged);
  const bool thrown = lost.times >= kTimesThrownOut &&
                      static_cast<double>(lost.samples) >= kShareThrownOut * static_cast<double>(judged);
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

std::string sentence(const Judgement& judgement) {
  const std::string vibration = fmt::format("{:.0f} Hz with {:.3g} N ({:.2g} JND)", judgement.buzz.frequency_Hz,
                                            judgement.buzz.amplitude_N, judgement.buzz.jnd);
  switch (judgement.verdict) {
    case Verdict::stable:
      return fmt::format("Stable: the largest vibration that stays is {:.3g} N, {:.2g} JND, which is not felt.",
                         judgement.buzz.amplitude_N, judgement.buzz.jnd);
    case Verdict::buzzes:
      return fmt::format("Buzzes at {}.", vibration);
    case Verdict::unstable:
      return fmt::format("Unstable: the hand is thrown out of contact {} times in {:.2g} s, at {}.",
                         judgement.thrown_out, judgement.judged_s, vibration);
    case Verdict::cannot_tell:
      return fmt::format("Cannot tell: on an ideal servo the hand never stays in contact for {:.2g} s.",
                         kSettling_s + 2.0 * kWindow_s);
  }
  return "";
}

}  // namespace touchstone::servo
