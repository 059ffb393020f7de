// What a device makes of a commanded force, measured by a force sensor that its handle is clamped to (the sensor's axes
// along the device's): step, frequency response, latency, and the forces of a golden trajectory. All command forces:
// the bench needs a dead-man input. A run that is cut short by a trip measures nothing and throws DeviceError.
#pragma once

#include <functional>
#include <vector>

#include "lab/finding.h"
#include "lab/servo_loop.h"

namespace touchstone::hil {

// A sensor that nothing touches: white noise and drift of the samples, and `lost` of them. A dead channel is quieter
// than any real one; a loose cable is louder than 0.1 N. Drift may make 0.1 N in a session of a minute: beyond that it
// is a force of its own in what is recorded; beside that, five standard errors of the line through the noise.
Finding noise_and_drift(const std::vector<WrenchSample>& samples, double lost);

// `repeats` steps of `force_N` along the unit vector `along`, folded over each other: steady force, delay to 50 %, rise
// from 10 to 90 %, overshoot. The slew limit is lifted to the whole step in one tick, which the clamp makes safe.
Finding force_step(Bench& bench, const LabLimits& limits, double force_N, const Vec3& along, int repeats = 5);

// A pseudo-random binary sequence (maximum length, 511 ticks; Ljung 1999, section 13.3) of +-`force_N` / 2 about
// `force_N` / 2: the gain over frequency by the ratio of the Fourier sums of force and held command, the frequency at
// which it falls to 0.71, and the lag at which command and force correlate best.
Finding force_latency(Bench& bench, const LabLimits& limits, double force_N, const Vec3& along);

// A golden trajectory through renderer and device: `render(i)` is the renderer's force at sample i, computed in the
// servo loop; all forces are scaled by one number so that the golden's peak is at most `force_limit_N`. Compared with
// the golden as measured, and after the best lag. Begins with a quarter of a second at zero, for the sensor's bias.
struct GoldenForce {
  std::string name;
  std::vector<double> t_s;
  std::vector<Vec3> f_W_N;
};
Finding golden_replay(Bench& bench, const LabLimits& limits, const GoldenForce& golden,
                      const std::function<Vec3(std::size_t)>& render, double force_limit_N);

}  // namespace touchstone::hil
