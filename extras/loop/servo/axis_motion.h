// One axis of a hand that holds a device, integrated exactly between the events of the servo loop.
//
//   m v' = f - b v - k_h y - b_h (v - q) - F_c sign(v),   y' = v - q,   f' = (u - f) / tau
//
// m is the mass of device and hand together, b the device's viscous and F_c its Coulomb friction; k_h and b_h are the
// spring and damper between the hand and where it means to be, which moves with the velocity q; y is how far the device
// is from there; u is what the servo commands and f what the actuator gives (a first-order lag; tau = 0: f = u).
//
// Between events the equations are linear, and the state goes on by its transition matrix: no step is small. Events are
// reversals and breaking loose: at rest the device stays while the other forces do not exceed F_c. The instant of an
// event is found by going as far as nothing happens in steps of halving length, whose transition matrices are
// tabulated; they are made by doubling the shortest one in the form Phi - 1, which loses no digits (Moler and Van Loan,
// SIAM Review 45, 2003, method 3). The work done through each port is integrated exactly too, as a quadratic form of
// the state: W(2 s) = W(s) + Phi(s)^T W(s) Phi(s).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace touchstone::servo {

struct AxisParameters {
  double mass_kg = 0.0;            // > 0, of device and hand
  double damping_N_s_per_m = 0.0;  // of the device
  double friction_N = 0.0;         // of the device
  double hand_damping_N_s_per_m = 0.0;
  double hand_stiffness_N_per_m = 0.0;
  double actuator_time_constant_s = 0.0;
};

// Work since the beginning. The balance: the change of m v^2 / 2 is by_actuator + by_hand - viscous - dry.
struct PortWork {
  double by_actuator_J = 0.0;
  double by_hand_J = 0.0;  // by the hand's spring and damper
  double viscous_J = 0.0;  // lost in the device
  double dry_J = 0.0;
};

// Time is counted in quanta: 2^40 of them are one period of the servo loop, 1e-15 s at 1 kHz.
inline constexpr int period_bits = 40;
inline constexpr std::int64_t period_quanta = std::int64_t{1} << period_bits;

// The state of the linear equations, in this order.
enum AxisIndex : int { deviation_index, velocity_index, actuator_index, intended_index, command_index, friction_index };
using AxisVector = Eigen::Matrix<double, 6, 1>;
using AxisMatrix = Eigen::Matrix<double, 6, 6>;

// What happens to a state over some time, and the work done: by the actuator, by the hand, against viscous and against
// dry friction, each as z^T W z of the state at the beginning.
struct Transition {
  AxisMatrix change = AxisMatrix::Zero();  // Phi - 1
  std::array<AxisMatrix, 4> work{AxisMatrix::Zero(), AxisMatrix::Zero(), AxisMatrix::Zero(), AxisMatrix::Zero()};

  // First this, then `next`.
  [[nodiscard]] Transition then(const Transition& next) const;
};

// Transitions over all times up to a period, for a body that slides and for one that rests.
class AxisTransitions {
 public:
  // `frequent`: times in quanta that will be asked for again and again, besides a whole period.
  AxisTransitions(const AxisParameters& parameters, double period_s, const std::vector<std::int64_t>& frequent = {});

  [[nodiscard]] const AxisParameters& parameters() const noexcept { return parameters_; }
  // Over 2^level quanta.
  [[nodiscard]] const Transition& level(int level, bool resting) const {
    return levels_[resting ? 1 : 0][static_cast<std::size_t>(level)];
  }
  // Over a frequent time; nullptr for any other.
  [[nodiscard]] const Transition* frequent(std::int64_t quanta, bool resting) const;

 private:
  AxisParameters parameters_;
  std::array<std::vector<Transition>, 2> levels_;
  std::vector<std::pair<std::int64_t, std::array<Transition, 2>>> frequent_;
};

class AxisMotion {
 public:
  // Rests where the hand means it to be; `transitions` must outlive it.
  explicit AxisMotion(const AxisTransitions& transitions) : transitions_(&transitions) {}

  // From here on.
  void command(double force_N);
  void intend(double velocity_m_per_s) { z_[intended_index] = velocity_m_per_s; }
  void start_at(double deviation_m, double velocity_m_per_s);
  // At most a period.
  void advance(std::int64_t quanta);

  [[nodiscard]] double deviation_m() const noexcept { return z_[deviation_index]; }  // from where the hand means to be
  [[nodiscard]] double velocity_m_per_s() const noexcept { return z_[velocity_index]; }
  [[nodiscard]] double actuator_N() const noexcept { return z_[actuator_index]; }
  [[nodiscard]] double acceleration_m_per_s2() const noexcept;
  // Of the device on the hand, whose own mass is `hand_mass_kg` of the whole.
  [[nodiscard]] double felt_N(double hand_mass_kg) const noexcept;
  [[nodiscard]] bool resting() const noexcept { return resting_; }
  [[nodiscard]] const PortWork& work() const noexcept { return work_; }

 private:
  void go(std::int64_t quanta);  // on, no event being in between
  void apply(const Transition& transition);
  [[nodiscard]] AxisVector after(std::int64_t quanta) const;
  // The quanta, at most `most`, for which `stays` goes on to hold of the state.
  template <class Stays>
  [[nodiscard]] std::int64_t lasts(std::int64_t most, const Stays& stays) const;
  [[nodiscard]] std::int64_t until_reversal(std::int64_t most) const;
  [[nodiscard]] std::int64_t until_loose(std::int64_t most) const;
  [[nodiscard]] double others_N(const AxisVector& z) const noexcept;  // all forces but the dry friction
  void stand();                                                       // at velocity zero: rests, or starts off

  const AxisTransitions* transitions_;
  AxisVector z_ = AxisVector::Zero();
  double direction_ = 0.0;  // of the sliding under dry friction; 0: to be found
  bool resting_ = false;
  PortWork work_;
};

}  // namespace touchstone::servo
