// What the lab tests compute from their samples; each with its source, and testable without a lab.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "devices/interfaces.h"

namespace touchstone::hil {

// Noise and drift of a sensor that nothing touches.
struct NoiseFloor {
  Vec3 sigma_N = Vec3::Zero();  // white part: overlapping Allan deviation at one sample (IEEE Std 952-1997, annex C)
  Vec3 drift_N_per_s = Vec3::Zero();   // least-squares line
  std::vector<double> tau_s, allan_N;  // Allan deviation of the largest axis
};
// Throws BadData for fewer than four samples.
NoiseFloor noise_floor(const std::vector<WrenchSample>& samples, double rate_Hz);

// A force step: delay to 50 %, rise between 10 and 90 %, overshoot, and the bandwidth of a first-order system with that
// rise.
struct StepResponse {
  double initial_N = 0.0, final_N = 0.0, delay_s = 0.0, rise_s = 0.0, overshoot = 0.0, bandwidth_Hz = 0.0;
};
StepResponse step_response(const std::vector<double>& t_s, const std::vector<double>& force_N, double command_s);

// Periods of a servo loop.
struct Jitter {
  double mean_s = 0.0, p99_late_s = 0.0, worst_late_s = 0.0;
  std::uint64_t missed = 0;              // periods longer than twice the nominal one
  std::vector<std::uint64_t> histogram;  // of lateness in steps of `bin_s`; the last collects the rest
};
Jitter servo_jitter(const std::vector<double>& t_s, double nominal_s, double bin_s, std::size_t bins);

// Largest stiffness that a sampled wall renders passively, K < 2 b / T (Colgate and Schenkel 1997, without virtual
// damping).
double passive_stiffness_N_per_m(double device_damping_N_s_per_m, double period_s);
// From a sweep: the largest stiffness before the first unstable one; 0 where none was stable.
double z_width_N_per_m(const std::vector<double>& stiffness_N_per_m, const std::vector<bool>& stable);
// The position swings with growing or sustained amplitude above `noise_m` in the last half of the contact.
bool oscillates(const std::vector<double>& position_m, double noise_m);

// "SCHED_FIFO 80" or "SCHED_OTHER": jitter limits are held only against the former.
std::string scheduling();

}  // namespace touchstone::hil
