// The simulation of a blind case: hand, tool and contact at 10 kHz, then the instruments.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "hidden_physics/blind_case.h"

namespace touchstone::hidden_physics {
using recording::Recording;

namespace {

constexpr double step_s = 1e-4;
constexpr double record_Hz = 250.0;
constexpr double lead_s = 0.2;  // simulated before the recording begins and after it ends, for filters and lags
constexpr double gravity_m_per_s2 = 9.80665;

struct Truth {
  std::vector<Vec3> p_W_m;
  std::vector<Vec3> a_W_m_per_s2;
  std::vector<Vec3> f_W_N;

  // At any time, between steps; time 0 is the recording's start.
  static Vec3 at(const std::vector<Vec3>& series, double t_s) {
    const double place = std::clamp((t_s + lead_s) / step_s, 0.0, static_cast<double>(series.size() - 1));
    const auto i = std::min(static_cast<std::size_t>(place), series.size() - 2);
    const double share = place - static_cast<double>(i);
    return series[i] + share * (series[i + 1] - series[i]);
  }
};

// How the tool stands at a time of the recording.
using Turn = std::function<Quat(double)>;

Truth simulate(const BlindCase& plan, const HandScript& script, double duration_s) {
  // A hand about a tool: 0.15 kg on 800 N/m, damped at 0.8 of critical; the arm leans into presses.
  constexpr double mass_kg = 0.15;
  constexpr double hand_N_per_m = 800.0;
  const double hand_N_s_per_m = 2.0 * 0.8 * std::sqrt(hand_N_per_m * mass_kg);
  HiddenContact contact(plan.truth, plan.physics);
  const auto aim_W_m = [&](double t_s) {
    const HandScript::Aim aim = script.at(t_s + lead_s);
    const auto jet = plan.truth.at(aim.xy_m);
    const Vec3 n = Vec3(-jet.slope.x(), -jet.slope.y(), 1.0).normalized();
    const double lean = aim.height_m < 0.0 ? plan.physics.stiffness_N_per_m / hand_N_per_m : 0.0;
    const double radius = plan.physics.tip_radius_m;
    return Vec3(Vec3(aim.xy_m.x(), aim.xy_m.y(), jet.h) + (radius + aim.height_m * (1.0 + lean)) * n);
  };
  Truth truth;
  const auto steps = static_cast<std::size_t>((duration_s + 2.0 * lead_s) / step_s) + 1;
  Vec3 p = aim_W_m(-lead_s);
  Vec3 v = Vec3::Zero();
  Vec3 aim_before = p;
  for (std::size_t i = 0; i < steps; ++i) {
    const double t_s = static_cast<double>(i) * step_s - lead_s;
    const Vec3 aim = aim_W_m(t_s);
    const Vec3 aim_v = (aim - aim_before) / step_s;
    aim_before = aim;
    const auto forces = contact.step(t_s, step_s, p, v);
    const Vec3 hand = hand_N_per_m * (aim - p) + hand_N_s_per_m * (aim_v - v);
    const Vec3 a = (hand + forces.f_W_N) / mass_kg;
    truth.p_W_m.push_back(p);
    truth.a_W_m_per_s2.push_back(a);
    truth.f_W_N.push_back(forces.f_W_N);
    v += step_s * a;
    p += step_s * v;
  }
  return truth;
}

// Catmull and Rom's cubic through equally spaced points, at `place` in steps.
Vec3 cubic(const std::vector<Vec3>& points, double place) {
  const auto i = std::clamp<std::size_t>(static_cast<std::size_t>(std::max(0.0, place)), 1, points.size() - 3);
  const double u = place - static_cast<double>(i);
  const Vec3& a = points[i - 1];
  const Vec3& b = points[i];
  const Vec3& c = points[i + 1];
  const Vec3& d = points[i + 2];
  return b + 0.5 * u * (c - a + u * (2.0 * a - 5.0 * b + 4.0 * c - d + u * (3.0 * (b - c) + d - a)));
}

// A machine leads the tip along the motion, whatever the contact's force.
Truth lead_along(const BlindCase& plan, const MotionColumns& motion) {
  HiddenContact contact(plan.truth, plan.physics);
  const double period_s =
      (motion.t_s.back() - motion.t_s.front()) / static_cast<double>(std::max<std::size_t>(1, motion.size() - 1));
  const double last_s = motion.t_s.back() - motion.t_s.front();
  const auto place = [&](double t_s) { return cubic(motion.p_W_m, std::clamp(t_s, 0.0, last_s) / period_s); };
  Truth truth;
  const auto steps = static_cast<std::size_t>((last_s + 2.0 * lead_s) / step_s) + 1;
  for (std::size_t i = 0; i < steps; ++i) {
    const double t_s = static_cast<double>(i) * step_s - lead_s;
    const Vec3 p = place(t_s);
    const Vec3 before = place(t_s - step_s);
    const Vec3 v = (p - before) / step_s;
    truth.p_W_m.push_back(p);
    truth.a_W_m_per_s2.push_back((place(t_s + step_s) - 2.0 * p + before) / (step_s * step_s));
    truth.f_W_N.push_back(contact.step(t_s, step_s, p, v).f_W_N);
  }
  return truth;
}

// Second-order Butterworth low-pass at a quarter of the rate, forwards and backwards (bilinear transform: at half of
// Nyquist the prewarped frequency is 1).
void smooth_both_ways(std::vector<Vec3>& series) {
  constexpr double norm = 1.0 / (2.0 + std::numbers::sqrt2);
  constexpr double back = (2.0 - std::numbers::sqrt2) * norm;
  for (int pass = 0; pass < 2; ++pass) {
    Vec3 x1 = series.front();
    Vec3 x2 = series.front();
    Vec3 y1 = series.front();
    Vec3 y2 = series.front();
    for (Vec3& x : series) {
      const Vec3 y = norm * (x + 2.0 * x1 + x2) - back * y2;
      x2 = x1;
      x1 = x;
      y2 = y1;
      y1 = y;
      x = y;
    }
    std::reverse(series.begin(), series.end());
  }
}

Vec3 gaussian(Random& random) { return {random.normal(), random.normal(), random.normal()}; }

std::vector<Vec3> track(const BlindCase& plan, const Truth& truth, const std::vector<double>& t_s, Random random) {
  const double period_s = 1.0 / plan.declared.position_rate_Hz;
  const double start_s = -lead_s + 0.5 * period_s;
  std::vector<Vec3> seen;
  double t = start_s;
  while (t < t_s.back() + lead_s) {
    const Vec3 p = Truth::at(truth.p_W_m, t);
    const Vec3 shown = p + plan.instrument.shift_W_m + plan.instrument.turn_rad.cross(p);
    seen.push_back(shown + plan.declared.position_noise_m * gaussian(random));
    t += period_s;
  }
  smooth_both_ways(seen);
  std::vector<Vec3> positions;
  positions.reserve(t_s.size());
  for (const double wanted : t_s) {
    positions.push_back(cubic(seen, (wanted - start_s) / period_s));
  }
  return positions;
}

// The sensor's reading in its own frame, without noise.
Vec3 reading_S_N(const BlindCase& plan, const Truth& truth, const Turn& turn, double t_s, bool flip_friction,
                 const Vec3& n_W) {
  const HiddenInstrument& h = plan.instrument;
  Vec3 f = Truth::at(truth.f_W_N, t_s);
  if (flip_friction) f = 2.0 * n_W.dot(f) * n_W - f;
  f.z() -= h.weight_kg * gravity_m_per_s2;
  f -= h.inertia_kg * Truth::at(truth.a_W_m_per_s2, t_s);
  Vec3 s = turn(t_s).conjugate() * f;
  s += Vec3(h.c_xz * s.z(), h.c_yz * s.z(), 0.0);
  return s + h.bias_S_N + t_s * h.drift_S_N_per_s + plan.physics.outside.zero_N(t_s);
}

// What shakes the sensor, sample by sample.
class Shaking {
 public:
  Shaking(const HiddenShaking& shaking, Random random) : shaking_(shaking), random_(random) {
    const double omega = 2.0 * std::numbers::pi * shaking.ringing_Hz;
    const double ring = omega * std::sqrt(1.0 - shaking.ringing_damping * shaking.ringing_damping);
    // A damped oscillator under white noise, exact from sample to sample (Gillespie 1996, equation 1.9, as a complex
    // Ornstein-Uhlenbeck process).
    pole_ = std::exp(std::complex<double>(-shaking.ringing_damping * omega, ring) / record_Hz);
    ringing_ = shaking.ringing_N * std::complex<double>(random_.normal(), random_.normal());
  }

  Vec3 next(double t_s, double load_N, double sliding_m_per_s) {
    const HiddenShaking& s = shaking_;
    const double turn = 2.0 * std::numbers::pi * t_s;
    double f_N =
        s.hum_N * (std::sin(s.hum_Hz * turn + s.hum_phase_rad) + s.hum_second * std::sin(2.0 * s.hum_Hz * turn));
    if (sliding_m_per_s > s.buzz_from_m_per_s) {
      f_N += s.buzz_N * (load_N / s.buzz_load_N) * std::sin(s.buzz_Hz * turn);
    }
    f_N += ringing_.real();
    const double kick_N = s.ringing_N * std::sqrt(1.0 - std::norm(pole_));
    ringing_ = pole_ * ringing_ + kick_N * std::complex<double>(random_.normal(), random_.normal());
    return f_N * s.along_S;
  }

 private:
  HiddenShaking shaking_;
  Random random_;
  std::complex<double> pole_;
  std::complex<double> ringing_;
};

Recording measure(const BlindCase& plan, const Truth& truth, std::vector<double> times_s, const Turn& turn,
                  const Random& root) {
  Recording recording;
  recording.motion.t_s = std::move(times_s);
  recording.motion.p_W_m = track(plan, truth, recording.motion.t_s, root.stream(1));

  Random random = root.stream(2);
  const DeclaredInstrument& d = plan.declared;
  const double keep = std::exp(-1.0 / (record_Hz * d.force_noise_time_constant_s));
  Vec3 noise = d.force_noise_N * gaussian(random);
  const bool flip = plan.corruption == Corruption::negative_friction;
  Vec2 guess = Vec2::Zero();
  Shaking shaking(plan.shaking, root.stream(3));
  for (const double t_s : recording.motion.t_s) {
    const Vec3 p = Truth::at(truth.p_W_m, t_s);
    const auto foot = plan.truth.foot(p, t_s == 0.0 ? Vec2(p.head<2>()) : guess);
    guess = foot.q_W_m.head<2>();
    Vec3 s = reading_S_N(plan, truth, turn, t_s - plan.instrument.lag_s, flip, foot.n_W) + noise;
    const Vec3 v = (Truth::at(truth.p_W_m, t_s + step_s) - p) / step_s;
    const double load_N = std::max(0.0, foot.n_W.dot(Truth::at(truth.f_W_N, t_s)));
    s += shaking.next(t_s, load_N, (v - foot.n_W.dot(v) * foot.n_W).norm());
    noise = keep * noise + d.force_noise_N * std::sqrt(1.0 - keep * keep) * gaussian(random);
    const double limit = plan.instrument.limit_N;
    for (int axis = 0; axis < 3; ++axis) {
      s[axis] = d.force_step_N[axis] * std::round(std::clamp(s[axis], -limit, limit) / d.force_step_N[axis]);
    }
    const Quat q = turn(t_s);
    recording.motion.q_WS.push_back(q);
    recording.f_W_N.push_back(q * s);
  }
  if (plan.corruption == Corruption::shuffled_blocks) {
    // Seconds of force in another order, as when files are joined wrongly.
    const auto block = static_cast<std::size_t>(record_Hz);
    const std::size_t blocks = recording.size() / block;
    for (std::size_t b = blocks - 1; b > 0; --b) {
      const std::size_t other = random.below(b + 1);
      for (std::size_t i = 0; i < block; ++i) {
        std::swap(recording.f_W_N[b * block + i], recording.f_W_N[other * block + i]);
      }
    }
  }
  // Whole steps, as files of instruments have them.
  for (Vec3& p : recording.motion.p_W_m) p = 1e-7 * (1e7 * p).array().round().matrix();
  for (Vec3& f : recording.f_W_N) f = 1e-5 * (1e5 * f).array().round().matrix();
  recording.source = plan.id;
  return recording;
}

}  // namespace

Recording record(const BlindCase& plan, bool holdout) {
  const ScriptSettings& settings = holdout ? plan.holdout : plan.train;
  const Random root = Random(plan.seed).stream(holdout ? 12 : 11);
  ScriptSettings longer = settings;
  longer.duration_s += 2.0 * lead_s;
  const HandScript script(longer, root.stream(0));
  const auto samples = static_cast<std::size_t>(settings.duration_s * record_Hz);
  std::vector<double> t_s;
  t_s.reserve(samples);
  for (std::size_t i = 0; i < samples; ++i) t_s.push_back(static_cast<double>(i) / record_Hz);
  return measure(
      plan, simulate(plan, script, settings.duration_s), std::move(t_s),
      [&](double t) { return script.turn(t + lead_s); }, root);
}

Recording record_along(const BlindCase& plan, const MotionColumns& motion, std::uint64_t repetition) {
  const Random root = Random(plan.seed).stream(100).stream(repetition);
  const double start_s = motion.t_s.front();
  std::vector<double> t_s;
  for (const double t : motion.t_s) t_s.push_back(t - start_s);
  const auto turn = [&](double t) {
    if (motion.q_WS.empty()) return Quat(Quat::Identity());
    const auto next = std::upper_bound(t_s.begin(), t_s.end(), t);
    if (next == t_s.begin()) return motion.q_WS.front();
    if (next == t_s.end()) return motion.q_WS.back();
    const auto i = static_cast<std::size_t>(next - t_s.begin());
    return motion.q_WS[i - 1].slerp((t - t_s[i - 1]) / (t_s[i] - t_s[i - 1]), motion.q_WS[i]);
  };
  return measure(plan, lead_along(plan, motion), t_s, turn, root);
}

}  // namespace touchstone::hidden_physics
