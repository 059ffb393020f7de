// The clocks of force sensor and motion tracker, aligned by taps (2006 paper, figure 2: "brief initial and final taps
// were added to aid registration of force and motion data").
//   Force: the instant where the rising edge of a tap leaves the baseline. Motion: the instant where the approach line
// meets the level at which the surface stops the tip (a hinge h(t) = level + s max(0, t0 - t), fitted by least
// squares), much finer than the tracker's sample interval. Offset and skew then follow from weighted least squares over
// all taps.
#pragma once

#include <string>
#include <vector>

#include "harness/base/rooms.h"
#include "harness/base/vec.h"

namespace touchstone::acquisition {

struct TapOptions {
  double force_threshold_N = 0.0;  // 0: eight times the baseline's noise, at least a tenth of the median peak
  double longest_tap_s = 0.4;      // a contact that lasts longer is scanning, not a tap
  double shortest_tap_s = 0.01;
  double approach_s = 0.16;  // of the motion before a tap that may enter the line
  double largest_skew = 500e-6;
};

// A brief contact in the force signal; times on the force sensor's clock.
struct ForceTap {
  double onset_s = 0.0;
  double onset_sigma_s = 0.0;
  double release_s = 0.0;
  double release_sigma_s = 0.0;
  double peak_N = 0.0;
};

// The tip stopped by the surface; time on the tracker's clock.
struct MotionStop {
  double stop_s = 0.0;
  double stop_sigma_s = 0.0;
  double approach_m_per_s = 0.0;
  double height_rms_m = 0.0;  // of the heights about the fitted hinge; 0 where none could be fitted
};

// t_force = reference_s + offset_s + (1 + skew) (t_motion - reference_s).
struct ClockAlignment {
  double reference_s =
      0.0;  // on the motion's clock, near the middle of the taps: there offset and skew are uncorrelated
  double offset_s = 0.0;
  double skew = 0.0;
  double offset_sigma_s = 0.0;
  double skew_sigma = 0.0;
  double residual_rms_s = 0.0;  // of the taps about the fit
  std::size_t taps = 0;
  bool releases_used = false;
  bool skew_fitted = false;  // false: fewer than three taps, or all at one end; then 0 +- 100 ppm was assumed
  // What was fitted: one event per onset or release, on both clocks.
  struct Event {
    double force_s = 0.0, motion_s = 0.0, sigma_s = 0.0, residual_s = 0.0;
    bool release = false;
  };
  std::vector<Event> events;

  [[nodiscard]] double to_force_clock(double t_motion_s) const {
    return t_motion_s + offset_s + skew * (t_motion_s - reference_s);
  }
  [[nodiscard]] double to_motion_clock(double t_force_s) const {
    return reference_s + (t_force_s - reference_s - offset_s) / (1.0 + skew);
  }
  // Standard uncertainty of the alignment at a time of the motion's clock.
  [[nodiscard]] double sigma_at(double t_motion_s) const;
};

// `normal_force_N` is the force along the surface's outward normal; strictly increasing times.
std::vector<ForceTap> find_force_taps(const std::vector<double>& t_s, const std::vector<double>& normal_force_N,
                                      const TapOptions& options);

// `height_m` is the tip's height along the same normal, any origin. Finds every abrupt stop of a descent; not all are
// taps.
std::vector<MotionStop> find_motion_stops(const std::vector<double>& t_s, const std::vector<double>& height_m,
                                          const TapOptions& options);

// Throws BadData without taps, when the patterns do not match, and when they match in more than one way.
ClockAlignment align_by_taps(const std::vector<double>& t_force_s, const std::vector<double>& normal_force_N,
                             const std::vector<double>& t_motion_s, const std::vector<double>& height_m,
                             const TapOptions& options, const std::string& source);

}  // namespace touchstone::acquisition
