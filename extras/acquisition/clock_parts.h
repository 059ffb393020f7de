// The steps by which tap_alignment.h aligns the clocks of sensor and tracker, each by itself so that it can be tested.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "clustered_fit.h"
#include "tap_alignment.h"

namespace touchstone::acquisition {

// The force less its running median over 1.5 s, component by component. The tool's weight turns with the hand within
// half a second and more and the bias drifts slower still, while a tap lasts less than 0.4 s: the residual is taps, and
// what changes as fast. Neither orientation nor offset is needed.
std::vector<Vec3> without_slow_part(const std::vector<double>& t_s, const std::vector<Vec3>& force_N);

// What is missing in a stream, as the end of a message (". In the force, 2 s are missing ..."): gaps of several sample
// intervals. Empty where they are less than a hundredth of the time.
std::string missing_in(const std::vector<double>& t_s, std::string_view what);

// t_force - t_motion by cross-correlation, good to a fraction of the tracker's interval. `quick_force_N` is without its
// slow part.
double coarse_offset(const std::vector<double>& t_force_s, const std::vector<Vec3>& quick_force_N,
                     const std::vector<double>& t_motion_s, const std::vector<double>& height_m,
                     const std::string& source);

// Brief contacts in the force along the normal. Those that follow one another within 150 ms are bounces of one tap.
std::vector<ForceTap> find_force_taps(const std::vector<double>& t_s, const std::vector<double>& normal_force_N,
                                      const TapOptions& options);

// A hand that dwells on the surface shifts the coarse offset by part of a tap.
inline constexpr double coarse_error_s = 0.12;

// What says something of the clocks and is independent of everything else that does: a tap, or a quarter of a second of
// free motion. The first two parameters of its equations are the correction of the offset at the reference time of a
// nearby line, and of the skew times clock_time_unit_s; others are of this kind of observation alone.
struct ClockCluster {
  NormalEquations equations;
  ClockAlignment::Event event;
  double duration_s = 0.0;
};
inline constexpr Eigen::Index own_clock_terms = 2;
inline constexpr double clock_time_unit_s = 10.0;  // so that both terms are of one size over a session

// The tool as an accelerometer. Keeps a reference to the streams.
class FreeMotion {
 public:
  explicit FreeMotion(const ClockStreams& streams);
  // The offset within that reach at which the tool's weight and inertia explain the force of free motion best; the
  // coarse offset itself if the tool's mass is unknown or there is too little motion.
  [[nodiscard]] double offset_near(double coarse_offset_s) const;
  // Corrections of a line that is a few milliseconds off at most, since they are linear; empty if there is too little
  // free motion. Parameters: two of the clocks; bias and its drift, three each; the scale of the force. The events'
  // residuals are about the line that free motion alone gives, their sigmas right up to a common factor.
  [[nodiscard]] std::vector<ClockCluster> clusters(const ClockAlignment& near) const;

 private:
  const ClockStreams& streams_;
  // Of the tool, in the sensor's frame, bias not in it: at each frame that could be used.
  std::vector<double> t_motion_s_;
  std::vector<Vec3> inertia_N_, force_N_;
};

// One event per tap that the motion shows too, at an offset within `error_s` of a guess; `tool_mass_kg` 0 if unknown.
std::vector<ClockAlignment::Event> tap_events(const std::vector<double>& t_force_s,
                                              const std::vector<double>& normal_force_N,
                                              const std::vector<double>& t_motion_s,
                                              const std::vector<double>& height_m, const std::vector<ForceTap>& taps,
                                              double guess_s, double error_s, double tool_mass_kg,
                                              const TapOptions& options);

// The line through events of one kind, without those that are far off it.
ClockAlignment line_through(std::vector<ClockAlignment::Event> events, double interval_s);

// A cluster for each tap, without those that are far off the line through the others.
std::vector<ClockCluster> tap_clusters(std::vector<ClockAlignment::Event> events, const ClockAlignment& near,
                                       double interval_s);

// The line that fits clusters of one kind, which are about `near`, and how well it is known. Its skew is 0 where the
// clusters do not tell it, whatever `near` has; its uncertainty is infinite where they do not determine an offset.
ClockAlignment fit_clock_line(const std::vector<ClockCluster>& clusters, const ClockAlignment& near);

}  // namespace touchstone::acquisition
