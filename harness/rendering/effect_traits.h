// What the search for missing effects, and whoever else does not run an effect, must know of it. An effect says this of
// itself, in its own file, so that nobody else has a list of names.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "harness/base/vec.h"
#include "harness/rendering/surface_frame.h"

namespace touchstone::rendering {

// Typical sizes of a recording in contact, from which an effect takes the scales of its parameters, so that nothing
// depends on the unit or size of the object.
struct RecordingScales {
  double force_N = 0.0;         // 90th percentile of the measured force's magnitude in contact
  double largest_axis_N = 0.0;  // of the sensor
  double depth_m = 0.0;         // 90th percentile
  double speed_m_per_s = 0.0;   // median tangential speed in contact
  double depth_rate_m_per_s = 0.0;
  double duration_s = 0.0;
  double position_noise_m = 0.0;      // declared
  double facet_m = 0.0;               // way along the surface from one normal to another one; at most the depth
  double contact_disagreement = 0.0;  // share of the samples in contact by force or by model that are so by one alone
  // The object's where what was touched faces its z and lies about its origin; else one that faces as the surface does,
  // about the middle of what was touched. So nothing depends on where the world's origin lies and how its axes are
  // turned.
  SurfaceFrame frame = {};
  Vec3 low_m = Vec3::Zero();  // of the positions in contact, in that frame
  Vec3 high_m = Vec3::Zero();
  [[nodiscard]] double extent_m() const { return (high_m - low_m).head<2>().norm(); }
  // Whether the contact went over the surface at all. An indentation at one place tells nothing of other places; there
  // the extent is at most what noise makes: peak to peak 2 * 3.9 deviations of 10,000 normal samples, on two axes.
  [[nodiscard]] bool over_surface() const {
    constexpr double peak_to_peak = 11.0;
    return extent_m() > peak_to_peak * position_noise_m && extent_m() > 1e-6 * depth_m;
  }
  // How many are in contact by the sensor or by the model alone only where the surface is elsewhere.
  [[nodiscard]] bool surface_is_elsewhere() const { return contact_disagreement > much_apart; }
  static constexpr double much_apart = 0.2;
};

// A parameter that a search is free to change.
struct SearchedParameter {
  std::string name;
  double scale = 1.0;  // of a step; a logarithmic one needs none
  // In the parameter's unit. Infinite: the catalogue's bound.
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool logarithmic = false;
  std::string above = {};    // what is sought is its excess over this parameter
  std::string carries = {};  // a parameter that keeps its distance to this one
  double step = 0.0;         // of derivatives, in units of `scale`, to both sides; 0: a small one to one side
  // What is sought is the part of several parameters along a direction, a unit vector; empty: the one of this name.
  std::map<std::string, double> along = {};
};

// How an effect enters a fit.
struct SearchPlan {
  std::vector<SearchedParameter> parameters;
  std::vector<std::map<std::string, double>> starts;  // complete entries
};

struct EffectTraits {
  // The effects that are special cases of it, by name: of two that do as well the smaller one is the finding, and one
  // model has not both.
  std::vector<std::string> contains;
  // Its parameters change where the tip meets the mesh, so that each value needs a search for contact of its own:
  // expensive in a fit.
  bool moves_contact = false;
  // Its force goes with a derivative of the motion, of which a tracker's noise is large: it damps, lags behind or
  // resists acceleration.
  bool follows_speed = false;
  // Its parameters are lengths or places along the surface: an indentation at one place shows nothing of it.
  bool along_surface = false;
  // Dry friction whose coefficient falls with speed, from mu_static to mu_dynamic with stribeck_velocity_m_per_s.
  bool velocity_weakening = false;
  // A wave over the surface: direction_rad + pi with another phase_rad is the same wave.
  bool is_wave = false;
  // Coefficients of friction along the object's x and y, by their parameters; empty: it has none.
  std::array<std::string, 2> along_axes;
  // A coefficient that is never negative, if it has one: the parameters at a small size of it, and what is wrong with
  // data in which it would be negative ("{}" stands for it).
  struct OneSided {
    std::map<std::string, double> small;
    double size = 0.0;
    std::string fault;
  };
  std::optional<OneSided> one_sided;
  // Of a field over the surface: what it is a map of, as a report's title says it.
  std::string map_title;
  // What it does to the surface, if that is all that it does.
  enum class Surface : std::uint8_t {
    stays,
    higher_by_amplitude,  // by amplitude_m
    higher_by_field,      // harness/rendering/smooth_field.h
    moved,                // as a whole (surface_frame.h)
  } surface = Surface::stays;
  // Where starts are searched for in what the model leaves, instead of being given by `plan`.
  enum class Peaks : std::uint8_t {
    none,
    stiffness,  // Gaussian bumps of the stiffness: amplitude, x_m, y_m, width_m
    height,     // of the surface: amplitude_m, x_m, y_m, width_m
    waves,      // amplitude_m, wavelength_m, direction_rad, phase_rad
  } peaks = Peaks::none;
  // nullptr: every declared parameter within its bounds, from its initial value.
  SearchPlan (*plan)(const RecordingScales& scales) = nullptr;
};

}  // namespace touchstone::rendering
