// The steps of tap_alignment.h, each by itself.
#pragma once

#include <string>
#include <vector>

#include "harness/acquisition/tap_alignment.h"
#include "harness/base/rooms.h"

namespace touchstone::acquisition {

// The force less its running median over 1.5 s, component by component. The tool's weight turns with the hand within
// half a second and more and the bias drifts slower still, while a tap lasts less than 0.4 s: what is left is taps, and
// what changes as fast. Neither orientation nor offset is needed.
std::vector<Vec3> without_slow_part(const std::vector<double>& t_s, const std::vector<Vec3>& force_N);

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

// The offset within that reach at which the tool's weight and inertia explain the force of free motion best; the coarse
// offset itself if the tool's mass is unknown or there is too little motion.
double free_motion_offset(const ClockStreams& streams, double coarse_offset_s);

// One event per tap that the motion shows too, at an offset within `error_s` of a guess; `tool_mass_kg` 0 if unknown.
std::vector<ClockAlignment::Event> tap_events(const std::vector<double>& t_force_s,
                                              const std::vector<double>& normal_force_N,
                                              const std::vector<double>& t_motion_s,
                                              const std::vector<double>& height_m, const std::vector<ForceTap>& taps,
                                              double guess_s, double error_s, double tool_mass_kg,
                                              const TapOptions& options);

// One event per second of free motion, by the tool's weight and inertia; empty if there is too little of it. The sigmas
// are right up to a common factor.
std::vector<ClockAlignment::Event> free_motion_events(const ClockStreams& streams, const ClockAlignment& near);

// Weighted least squares of offset and skew; drops events that are far off and fills the residuals.
ClockAlignment fit_clock_line(std::vector<ClockAlignment::Event> events, double interval_s);

}  // namespace touchstone::acquisition
