// What the makers of sensor and tracker declare, and noise drawn from it. Format: "touchstone-instrument/1" (JSON).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "harness/base/random.h"
#include "harness/recording/trajectory.h"

namespace touchstone::discrepancy {

struct InstrumentDescription {
  double force_noise_N = 0.0;                // standard deviation per axis
  double force_noise_time_constant_s = 0.0;  // first-order colouring; 0: white
  Vec3 force_step_N = Vec3::Zero();          // quantisation in the sensor's frame
  double position_noise_m = 0.0;             // standard deviation per axis of one tracker sample
  double position_wander_m = 0.0;            // the part of it that changes slowly, as calibration residuals do
  double position_wander_time_constant_s = 4.0;
  double position_rate_Hz = 60.0;   // of the tracker
  double geometry_error_m = 0.0;    // the mesh is off by at most this
  double position_low_pass = 0.25;  // corner over the rate; from the recording, not the file
  double normal_error_rad = 0.0;    // angle between facets and the smooth surface; from the mesh, not the file
  double mesh_extent_m = 0.0;       // diagonal of its box; from the mesh, not the file
  bool declared = true;             // false: estimated from the recording
};

// Throws BadData with the place in the file.
InstrumentDescription load_instrument(const std::filesystem::path& path);

// The same as a file: what load_instrument() reads.
std::string instrument_to_json(const InstrumentDescription& instrument);

// Without a description: force noise from second differences of the force where nothing moves it, position noise from
// the residual of the position after a local quadratic fit. Both are lower bounds in motion; reports say "estimated".
InstrumentDescription estimate_instrument(const recording::Recording& recording);

// Where the tracker ends, as position_low_pass has it: there noise of the declared size has the fifth differences of
// the recorded positions, over one period of the tracker, in which a hand's motion hardly shows (difference-based
// variance: Gasser, Sroka and Jennen-Steinmetz 1986, Biometrika 73:625). Within a tenth where the declared size is
// right.
double measured_low_pass(const MotionColumns& motion, const InstrumentDescription& instrument);

// The motion with one draw of tracker noise added: white at the tracker's rate, low-passed at a share of that rate
// without delay (second-order Butterworth, forwards and backwards) and interpolated, as optical trackers deliver it.
MotionColumns with_position_noise(const MotionColumns& motion, const InstrumentDescription& instrument, Random& random);

// A declared bound ("off by at most") counts as a uniform error: its standard deviation.
double geometry_deviation_m(const InstrumentDescription& instrument);

// The motion as one draw of the mesh's error would have it: shifted along `n_W` (of every sample) by a height that is
// smooth along the surface.
MotionColumns with_geometry_error(const MotionColumns& motion, const std::vector<Vec3>& n_W,
                                  const InstrumentDescription& instrument, Random& random);

// One draw of how the true normal leans against the facet's at every sample, in the tangent plane [rad].
std::vector<Vec3> normal_tilts(const MotionColumns& motion, const std::vector<Vec3>& n_W,
                               const InstrumentDescription& instrument, Random& random);

// One draw of force noise per sample, coloured, plus the rounding of the steps as a uniform error.
std::vector<Vec3> force_noise(const MotionColumns& motion, const InstrumentDescription& instrument, Random& random);

}  // namespace touchstone::discrepancy
