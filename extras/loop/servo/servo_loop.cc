#include "servo/servo_loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <numbers>
#include <utility>

#include "harness/base/error.h"
#include "harness/base/random.h"

namespace touchstone::servo {
namespace {

constexpr double fastest_in_a_period = 1e6;
constexpr double most_periods = 1e7;         // what fits in memory
constexpr double beyond_workspace_m = 10.0;  // from where the hand means to be; devices reach 0.2 m

// Times in quanta of a period.
std::int64_t quanta_of(double time_s, double period_s) {
  return static_cast<std::int64_t>(std::llround(time_s / period_s * static_cast<double>(period_quanta)));
}

void check(const LoopParameters& own, const MotionColumns& path) {
  const auto refuse_unless = [](bool right, const char* name, double value, const char* expected) {
    if (!right || !std::isfinite(value)) {
      throw UsageError(fmt::format("{} is {}: {} was expected", name, value, expected));
    }
  };
  if (path.size() < 2) throw UsageError("the path has fewer than two samples");
  refuse_unless(own.axis.mass_kg > 0.0, "mass_kg", own.axis.mass_kg, "above 0");
  refuse_unless(own.hand_mass_kg >= 0.0 && own.hand_mass_kg <= own.axis.mass_kg, "the hand's mass_kg", own.hand_mass_kg,
                "0 or more, and no more than the whole");
  refuse_unless(own.period_s > 0.0, "period_s", own.period_s, "above 0");
  refuse_unless(own.latency_s >= 0.0 && own.latency_s <= 100.0 * own.period_s, "latency_s", own.latency_s,
                "0 to 100 periods");
  refuse_unless(own.jitter_s >= 0.0 && own.jitter_s < own.period_s, "jitter_s", own.jitter_s, "0 to below one period");
  for (const auto& [name, value] : {std::pair{"resolution_m", own.resolution_m},
                                    {"damping_N_s_per_m", own.axis.damping_N_s_per_m},
                                    {"friction_N", own.axis.friction_N},
                                    {"hand_damping_N_s_per_m", own.axis.hand_damping_N_s_per_m},
                                    {"hand_stiffness_N_per_m", own.axis.hand_stiffness_N_per_m},
                                    {"the actuator's time constant", own.axis.actuator_time_constant_s},
                                    {"virtual_damping_N_s_per_m", own.virtual_damping_N_s_per_m}}) {
    refuse_unless(value >= 0.0, name, value, "0 or more");
  }
  // One quantum of time must be short beside whatever the equations do.
  const double lag_s = own.axis.actuator_time_constant_s;
  const double fastest_per_s =
      std::max({(own.axis.damping_N_s_per_m + own.axis.hand_damping_N_s_per_m) / own.axis.mass_kg,
                std::sqrt(own.axis.hand_stiffness_N_per_m / own.axis.mass_kg), lag_s > 0.0 ? 1.0 / lag_s : 0.0});
  if (!(fastest_per_s * own.period_s <= fastest_in_a_period)) {
    throw UsageError(
        fmt::format("hand and device are as fast as {:.3g} times in a period: at most {:.0g} was expected; "
                    "more mass, or less damping, stiffness or bandwidth",
                    fastest_per_s * own.period_s, fastest_in_a_period));
  }
  const double periods = (path.t_s.back() - path.t_s.front()) / own.period_s;
  if (!(periods <= most_periods)) {
    throw UsageError(fmt::format("the path lasts {} s, which is {:.3g} periods of {} s: at most {:.0g} was expected",
                                 path.t_s.back() - path.t_s.front(), periods, own.period_s, most_periods));
  }
}

// The path at the beginning of each period.
class PathAtPeriods {
 public:
  PathAtPeriods(const MotionColumns& path, double period_s) : path_(path), period_s_(period_s) {}
  [[nodiscard]] std::size_t periods() const {
    return static_cast<std::size_t>(std::floor((path_.t_s.back() - path_.t_s.front()) / period_s_ + 1e-9));
  }
  [[nodiscard]] double t_s(std::size_t k) const { return path_.t_s.front() + static_cast<double>(k) * period_s_; }
  // To be asked for in ascending order.
  struct Place {
    Vec3 p_W_m;
    Quat q_WS;
  };
  Place at(std::size_t k) {
    const double t = std::min(t_s(k), path_.t_s.back());
    while (i_ + 2 < path_.size() && path_.t_s[i_ + 1] <= t) ++i_;
    const double share = (t - path_.t_s[i_]) / (path_.t_s[i_ + 1] - path_.t_s[i_]);
    Place place{path_.p_W_m[i_] + share * (path_.p_W_m[i_ + 1] - path_.p_W_m[i_]), Quat::Identity()};
    if (!path_.q_WS.empty()) place.q_WS = path_.q_WS[i_].slerp(share, path_.q_WS[i_ + 1]);
    return place;
  }

 private:
  const MotionColumns& path_;
  double period_s_;
  std::size_t i_ = 0;
};

// What the servo makes of the renderer's answer.
class Servo {
 public:
  Servo(rendering::Renderer& renderer, const LoopParameters& own) : renderer_(renderer), own_(own) {
    renderer_.reset();
  }

  struct Answer {
    Vec3 f_W_N = Vec3::Zero();
    Vec3 contact_W_m = Vec3::Zero();
    bool contact = false;
    bool limited = false;
  };
  Answer answer(double t_s, const Vec3& tip_W_m, const Quat& q_WS) {
    const Vec3 measured_W_m = measure(tip_W_m);
    const Vec3 v_W = velocity(t_s, own_.exact_velocity ? tip_W_m : measured_W_m);
    const rendering::StepResult result = renderer_.step({t_s, measured_W_m, q_WS});
    if (result.status == rendering::StepStatus::failed || !result.f_W_N.allFinite()) {
      const std::string why = renderer_.failure();
      throw BadData(fmt::format("the renderer broke down in the loop at {} s: {}", t_s,
                                why.empty() ? "its force is not finite" : why));
    }
    Answer out{own_.force_gain * result.f_W_N, result.contact_W_m, result.contact, false};
    if (result.contact && own_.virtual_damping_N_s_per_m > 0.0) {
      out.f_W_N -= own_.virtual_damping_N_s_per_m * v_W.dot(result.n_W) * result.n_W;
    }
    const double size_N = out.f_W_N.norm();
    out.limited = size_N > own_.force_limit_N;
    if (out.limited) out.f_W_N *= own_.force_limit_N / size_N;
    return out;
  }

 private:
  [[nodiscard]] Vec3 measure(const Vec3& tip_W_m) const {
    if (own_.resolution_m <= 0.0) return tip_W_m;
    return tip_W_m.unaryExpr([this](double x) { return own_.resolution_m * std::nearbyint(x / own_.resolution_m); });
  }
  Vec3 velocity(double t_s, const Vec3& p_W_m) {
    if (last_t_s_) {
      const double dt_s = t_s - *last_t_s_;
      const double share = 1.0 - std::exp(-2.0 * std::numbers::pi * own_.velocity_cutoff_Hz * dt_s);
      velocity_W_ += share * ((p_W_m - last_W_m_) / dt_s - velocity_W_);
    }
    last_t_s_ = t_s;
    last_W_m_ = p_W_m;
    return velocity_W_;
  }

  rendering::Renderer& renderer_;
  const LoopParameters& own_;
  std::optional<double> last_t_s_;
  Vec3 last_W_m_ = Vec3::Zero();
  Vec3 velocity_W_ = Vec3::Zero();
};

class Loop {
 public:
  Loop(rendering::Renderer& renderer, const MotionColumns& path, const LoopParameters& own)
      : own_(own),
        path_(path, own.period_s),
        latency_(quanta_of(own.latency_s, own.period_s)),
        transitions_(own.axis, own.period_s, frequent()),
        axes_{AxisMotion(transitions_), AxisMotion(transitions_), AxisMotion(transitions_)},
        servo_(renderer, own),
        random_(own.seed) {}

  LoopTrace run(std::size_t keep_every) {
    LoopTrace trace;
    const std::size_t periods = path_.periods();
    auto here = path_.at(0);
    for (std::size_t k = 0; k < periods && !trace.left_at_s; ++k) {
      const auto next = path_.at(k + 1);
      intended_W_m_ = here.p_W_m;
      intended_m_per_s_ = (next.p_W_m - here.p_W_m) / own_.period_s;
      for (int i = 0; i < 3; ++i) axis(i).intend(intended_m_per_s_[i]);
      if (k == 0) {
        for (int i = 0; i < 3; ++i) axis(i).start_at(0.0, intended_m_per_s_[i]);
      }
      period(k, here.q_WS, k % keep_every == 0, trace);
      here = next;
    }
    return trace;
  }

 private:
  [[nodiscard]] std::vector<std::int64_t> frequent() const {
    const std::int64_t part = latency_ % period_quanta;
    if (part == 0 || own_.jitter_s > 0.0) return {};
    return {part, period_quanta - part};
  }
  AxisMotion& axis(int i) { return axes_[static_cast<std::size_t>(i)]; }

  // One period: the position is sampled, and forces that are due begin to act.
  void period(std::size_t k, const Quat& q_WS, bool keep, LoopTrace& trace) {
    now_ = 0;
    const auto late = own_.jitter_s > 0.0 ? quanta_of(random_.uniform(0.0, own_.jitter_s), own_.period_s) : 0;
    go_on_until(std::min(late, period_quanta - 1));
    sample(k, q_WS, keep, trace);
    if (trace.left_at_s) return;
    go_on_until(period_quanta);
    for (Due& due : due_) due.at -= period_quanta;
  }

  void go_on_until(std::int64_t end) {
    while (!due_.empty() && due_.front().at <= end) {
      advance_to(due_.front().at);
      for (int i = 0; i < 3; ++i) axis(i).command(due_.front().f_W_N[i]);
      due_.pop_front();
    }
    advance_to(end);
  }

  void advance_to(std::int64_t end) {
    if (end <= now_) return;
    for (AxisMotion& own : axes_) own.advance(end - now_);
    now_ = end;
  }

  void sample(std::size_t k, const Quat& q_WS, bool keep, LoopTrace& trace) {
    const double since_s = static_cast<double>(now_) * (own_.period_s / static_cast<double>(period_quanta));
    const double t_s = path_.t_s(k) + since_s;
    const Vec3 intended_W_m = intended_W_m_ + since_s * intended_m_per_s_;
    const Vec3 away_m(axis(0).deviation_m(), axis(1).deviation_m(), axis(2).deviation_m());
    if (!(away_m.norm() < beyond_workspace_m)) {
      trace.left_at_s = t_s;
      return;
    }
    const Vec3 tip_W_m = intended_W_m + away_m;
    const Servo::Answer answer = servo_.answer(t_s, tip_W_m, q_WS);
    if (keep) record(trace, t_s, intended_W_m, tip_W_m, answer);
    due_.push_back({now_ + latency_, answer.f_W_N});
  }

  void record(LoopTrace& trace, double t_s, const Vec3& intended_W_m, const Vec3& tip_W_m,
              const Servo::Answer& answer) {
    Vec3 felt_W_N;
    double by_actuator_J = 0.0, by_hand_J = 0.0, lost_J = 0.0, kinetic_J = 0.0;
    for (int i = 0; i < 3; ++i) {
      felt_W_N[i] = axis(i).felt_N(own_.hand_mass_kg);
      by_actuator_J += axis(i).work().by_actuator_J;
      by_hand_J += axis(i).work().by_hand_J;
      lost_J += axis(i).work().viscous_J + axis(i).work().dry_J;
      kinetic_J += 0.5 * own_.axis.mass_kg * std::pow(axis(i).velocity_m_per_s(), 2);
    }
    trace.t_s.push_back(t_s);
    trace.intended_W_m.push_back(intended_W_m);
    trace.tip_W_m.push_back(tip_W_m);
    trace.contact_W_m.push_back(answer.contact_W_m);
    trace.commanded_W_N.push_back(answer.f_W_N);
    trace.felt_W_N.push_back(felt_W_N);
    trace.contact.push_back(answer.contact ? 1 : 0);
    trace.limited.push_back(answer.limited ? 1 : 0);
    trace.by_actuator_J.push_back(by_actuator_J);
    trace.by_hand_J.push_back(by_hand_J);
    trace.lost_J.push_back(lost_J);
    trace.kinetic_J.push_back(kinetic_J);
  }

  struct Due {
    std::int64_t at;  // in quanta since the beginning of the period
    Vec3 f_W_N;
  };
  LoopParameters own_;
  PathAtPeriods path_;
  std::int64_t latency_;
  AxisTransitions transitions_;
  std::array<AxisMotion, 3> axes_;
  Servo servo_;
  Random random_;
  std::deque<Due> due_;
  Vec3 intended_W_m_ = Vec3::Zero();      // at the beginning of the period
  Vec3 intended_m_per_s_ = Vec3::Zero();  // in it
  std::int64_t now_ = 0;                  // in quanta since the beginning of the period
};

}  // namespace

LoopTrace run_loop(rendering::Renderer& renderer, const MotionColumns& path, const LoopParameters& parameters,
                   std::size_t keep_every) {
  check(parameters, path);
  return Loop(renderer, path, parameters).run(keep_every);
}

LoopTrace run_ideal_loop(rendering::Renderer& renderer, const MotionColumns& path, LoopParameters parameters,
                         double resolution_m) {
  parameters.period_s /= static_cast<double>(ideal_rate);
  parameters.latency_s = parameters.jitter_s = 0.0;
  parameters.resolution_m = resolution_m;
  parameters.exact_velocity = true;
  parameters.axis.actuator_time_constant_s = 0.0;
  parameters.velocity_cutoff_Hz = std::numeric_limits<double>::infinity();
  return run_loop(renderer, path, parameters, ideal_rate);
}

LoopTrace run_open(rendering::Renderer& renderer, const MotionColumns& path, const LoopParameters& parameters) {
  check(parameters, path);
  LoopParameters plain;
  plain.force_gain = parameters.force_gain;
  Servo servo(renderer, plain);
  PathAtPeriods places(path, parameters.period_s);
  LoopTrace trace;
  for (std::size_t k = 0; k < places.periods(); ++k) {
    const auto place = places.at(k);
    const Servo::Answer answer = servo.answer(places.t_s(k), place.p_W_m, place.q_WS);
    trace.t_s.push_back(places.t_s(k));
    trace.intended_W_m.push_back(place.p_W_m);
    trace.tip_W_m.push_back(place.p_W_m);
    trace.contact_W_m.push_back(answer.contact_W_m);
    trace.commanded_W_N.push_back(answer.f_W_N);
    trace.contact.push_back(answer.contact ? 1 : 0);
  }
  return trace;
}

}  // namespace touchstone::servo
