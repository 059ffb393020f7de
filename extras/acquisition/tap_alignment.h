// Aligns the clocks of force sensor and motion tracker by everything that the hand does in the air and by taps on a
// hard surface (2006 paper, figure 2: "brief initial and final taps were added to aid registration of force and motion
// data").
//   1. Coarse, to a fraction of a tracker frame: the cross-correlation of the force, its slow part taken off, with the
//      acceleration of the tip along the surface's normal (Knapp and Carter, IEEE Trans. ASSP 24, 1976). It needs no
//      threshold, and a rhythm that fits twice shows as a second peak.
//   2. Free motion, if the tool is known: its weight and inertia m (g - a), from the tracker's motion, against the
//      force, both smoothed by one kernel. The force's derivative, alone and times the time, stands beside bias, drift
//      of the bias and scale in one regression: its coefficients are offset and skew.
//   3. Taps, if free motion does not suffice. While the tip touches, its height is level - compliance * force; before
//      and after, it flies. If the tool's mass m is known the sensor is an accelerometer: the height is the double
//      integral of -force / m from the instant of contact. The shift that makes the tracker's heights fit best is the
//      offset at that tap, by separable least squares (Golub and Pereyra 1973); the compliance is the same for all
//      taps. Errors of onset and release act with opposite signs.
//   Offset and skew follow from least squares over the clusters of step 2 or 3. Not over both: a tool that turns about
// the hand while it is stopped shifts all taps of a session by the same few milliseconds. Over simulated sessions the
// taps' mean is off by 1.9 ms RMS and free motion by 0.15; together they were worse at a session's ends than free
// motion alone, even with a delay of the taps' own beside them.
// Intervals: a few quarters of a second, in which the hand stops or is thrown back, hold most of what a session says,
// and near its ends two or three of them nearly all. There the usual covariance is too small and normal quantiles are
// too narrow; ClusteredFit (Bell and McCaffrey 2002) gives the covariance and Student's degrees of freedom for
// each time: about ten in the middle of a session, about five at its ends.
//   They do not contain what contacts leave in the smoothed force beside them: over 200 simulated sessions a shift of
// -0.04 ms on average, a fifth of the offset's scatter. To find contacts in the unsmoothed force and to leave out all
// that the kernel reaches is no cure: the shift stays within its error, and the scatter nearly doubles.
#pragma once

#include <string>
#include <vector>

#include "clustered_fit.h"
#include "harness/base/vec.h"
#include "harness/recording/tool_load.h"

namespace touchstone::acquisition {
using recording::ToolLoad;

struct TapOptions {
  double force_threshold_N = 0.0;  // 0: eight times the noise, at least a tenth of the largest peak
  double longest_tap_s = 0.4;      // a contact that lasts longer is scanning, not a tap
  double shortest_tap_s = 0.01;
  double approach_s = 0.1;  // of the motion before and after a tap that enters its fit
  double largest_skew = 500e-6;
};

// A brief contact in the force signal, with the bounces that follow; times on the force sensor's clock.
struct ForceTap {
  struct Flight {
    double from_s = 0.0, to_s = 0.0;
  };
  double onset_s = 0.0;
  double onset_sigma_s = 0.0;
  double release_s = 0.0;
  double release_sigma_s = 0.0;
  double peak_N = 0.0;
  std::vector<Flight> flights;  // between onset and release, if the tip bounced
};

// t_force = reference_s + offset_s + (1 + skew) (t_motion - reference_s).
struct ClockAlignment {
  double reference_s =
      0.0;  // on the motion's clock, near the middle of the taps: there offset and skew are uncorrelated
  double offset_s = 0.0;
  double skew = 0.0;
  double offset_sigma_s = 0.0;  // infinite: the fit did not determine the offset
  double skew_sigma = 0.0;
  double residual_rms_s = 0.0;  // of the events about the fit, weighted as they are there
  double degrees = 1.0;         // of freedom, at the reference time
  std::size_t taps = 0;         // that were fitted, or found if free motion was
  std::size_t free_motion = 0;  // seconds of free motion that were fitted; 0 if the tool is unknown or hardly moves
  bool skew_fitted = false;     // false: fewer than three events, or all at one end; then 0 +- 100 ppm was assumed
  // What was fitted: one event per tap or quarter of a second of free motion, on both clocks.
  struct Event {
    double force_s = 0.0, motion_s = 0.0, sigma_s = 0.0, residual_s = 0.0;
    bool free_motion = false;
  };
  std::vector<Event> events;

  [[nodiscard]] double to_force_clock(double t_motion_s) const {
    return t_motion_s + offset_s + skew * (t_motion_s - reference_s);
  }
  [[nodiscard]] double to_motion_clock(double t_force_s) const {
    return reference_s + (t_force_s - reference_s - offset_s) / (1.0 + skew);
  }
  // The fit's corrections of a nearby line, and the time that they are about: for uncertainties.
  ClusteredFit fit;
  double fitted_about_s = 0.0;
  // Standard uncertainty of the alignment at a time of the motion's clock with its degrees of freedom, and half the
  // width of its 95 % interval.
  [[nodiscard]] ClusteredFit::Error error_at(double t_motion_s) const;
  [[nodiscard]] double sigma_at(double t_motion_s) const;
  [[nodiscard]] double interval95_at(double t_motion_s) const;
};

// Both streams as they came. Times strictly increase.
struct ClockStreams {
  std::vector<double> t_force_s;
  std::vector<Vec3> force_S_N;  // as measured in the sensor's frame: weight, bias and contact
  std::vector<double> t_motion_s;
  std::vector<Vec3> tip_T_m;  // tracker's frame
  std::vector<Quat> q_TS;
  ToolLoad tool;  // without a mass, weight stays in and free motion is not used
  Vec3 tip_S_m = Vec3::Zero();
  Vec3 gravity_T_m_per_s2 = Vec3(0, 0, -9.81);
  Vec3 normal_T = Vec3::UnitZ();  // of the surface that is tapped, outward
};

// Throws BadData, saying what to do, without taps, if the two streams do not match, if they match in more than one way,
// and if the skew is more than clocks differ by.
ClockAlignment align_clocks(const ClockStreams& streams, const TapOptions& options, const std::string& source);

// The same by taps alone, from the force along the normal, weight already off, and the tip's height along it.
ClockAlignment align_by_taps(const std::vector<double>& t_force_s, const std::vector<double>& normal_force_N,
                             const std::vector<double>& t_motion_s, const std::vector<double>& height_m,
                             const TapOptions& options, const std::string& source);

}  // namespace touchstone::acquisition
