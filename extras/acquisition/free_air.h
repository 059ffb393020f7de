// The residual force of a run that touches nothing, and its causes: the bias that moved since the calibration, the
// inertia of the tool (F = m (g - a), as an accelerometer on the tool senses it), and vibration. Told apart by
// smoothing both signals to the same bandwidth: slow motion is the same everywhere on the tool, vibration is not.
#pragma once

#include <string>
#include <vector>

#include "harness/recording/tool_load.h"

namespace touchstone::acquisition {
using recording::ToolLoad;
using recording::WrenchResidual;

// Accelerometer readings a = A g_S + b, from static orientations: A maps the sensor's frame and m/s^2 to its own.
struct AccelerometerMap {
  Mat3 per_m_per_s2 = Mat3::Identity();
  Vec3 offset = Vec3::Zero();
  double residual_m_per_s2 = 0.0;  // root mean square per component
};
// Least squares; needs at least four orientations that differ. Throws BadData naming `source` if they do not determine
// the accelerometer's axes.
AccelerometerMap identify_accelerometer(const std::vector<Vec3>& readings, const std::vector<Quat>& q_WS,
                                        const Vec3& gravity_W_m_per_s2, const std::string& source);

struct FreeAirRun {
  std::vector<double> t_wrench_s;
  std::vector<Wrench> wrench;
  std::vector<double> t_orientation_s;
  std::vector<Quat> q_WS;
  std::vector<double> t_acceleration_s;  // empty where there is no accelerometer
  std::vector<Vec3> acceleration;        // its own readings
};

// Root mean square lengths of the force error [N], motion of all parts smoothed to `cutoff_Hz`.
struct FreeAirBand {
  double cutoff_Hz = 0.0;
  double weight_removed_N = 0.0;  // bias and weight of the static calibration removed
  double bias_removed_N = 0.0;    // and this run's mean
  double inertia_removed_N =
      0.0;  // and the tool's inertia with the mass of the static calibration; NaN without accelerometer
  // Least squares of the force error on the acceleration over a clock offset within +-20 ms: had the static mass or the
  // clocks been wrong, they would differ here. NaN without accelerometer.
  double fitted_mass_kg = 0.0;
  double fitted_offset_s = 0.0;  // the force's clock is late by that much against the acceleration's
  double fitted_removed_N = 0.0;
};

// A stretch in which the tool pushes against something.
struct AirContact {
  double from_s = 0.0, to_s = 0.0;
  double force_N = 0.0;  // the largest that is left there
};

struct FreeAirReport {
  WrenchResidual raw;                // unsmoothed, bias and weight removed
  WrenchResidual at_rest;            // the part in which the tool does not turn
  Vec3 bias_shift_N = Vec3::Zero();  // mean error at rest: what the bias moved by since the calibration
  double rest_fraction = 0.0;
  std::vector<FreeAirBand> bands;
  // Where the run touches something after all, in order. Force smoothed to 5 Hz, bias, weight and (with an
  // accelerometer) inertia removed, that exceeds what a hand or an arm makes by moving the tool: half of its weight, or
  // a quarter of it where the inertia is known, and six robust deviations of its own.
  std::vector<AirContact> contacts;
  double contact_bar_N = 0.0;
};

// Empty, or that the run touches something, where, and how hard.
std::string contact_message(const FreeAirReport& report, const std::string& source);

// A turn slower than `rest_rad_per_s` counts as rest. Throws BadData naming `source` if wrench and orientation hardly
// overlap in time.
FreeAirReport analyse_free_air(const FreeAirRun& run, const ToolLoad& load, const AccelerometerMap& accelerometer,
                               const Vec3& gravity_W_m_per_s2, const std::vector<double>& cutoffs_Hz,
                               double rest_rad_per_s, const std::string& source);

}  // namespace touchstone::acquisition
