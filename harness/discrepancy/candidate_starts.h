// How each effect enters a fit: which of its parameters are free, within what physical bounds, at what scale, and from
// where the search starts. Scales come from the recording, so that nothing depends on the unit or size of the object.
// An effect that this file does not know is fitted in all its declared parameters from generic starts.
#pragma once

#include <functional>
#include <vector>

#include "harness/base/rooms.h"
#include "harness/discrepancy/free_parameter.h"
#include "harness/rendering/predictor.h"

namespace touchstone::discrepancy {

// Typical sizes of a recording in contact.
struct RecordingScales {
  double force_N = 0.0;         // 90th percentile of the measured force's magnitude in contact
  double largest_axis_N = 0.0;  // of the sensor
  double depth_m = 0.0;         // 90th percentile
  double speed_m_per_s = 0.0;   // median tangential speed in contact
  double depth_rate_m_per_s = 0.0;
  double duration_s = 0.0;
  double position_noise_m = 0.0;  // declared
  double facet_m = 0.0;           // way along the surface from one normal to another one; at most the depth
  double touching_apart = 0.0;    // share of the samples in contact by force or by model that are so by one alone
  Vec3 low_W_m = Vec3::Zero();    // of the positions in contact
  Vec3 high_W_m = Vec3::Zero();
  [[nodiscard]] double extent_m() const { return (high_W_m - low_W_m).head<2>().norm(); }
  // Whether the contact went over the surface at all. An indentation at one place tells nothing of other places; there
  // the extent is at most what noise makes: peak to peak 2 * 3.9 deviations of 10,000 normal samples, on two axes.
  [[nodiscard]] bool over_surface() const {
    constexpr double peak_to_peak = 11.0;
    return extent_m() > peak_to_peak * position_noise_m && extent_m() > 1e-6 * depth_m;
  }
};

// `force_floor_N`: a measured force above it is contact, whatever the model says.
RecordingScales measure_scales(const Recording& recording, const Prediction& prediction, double force_floor_N,
                               double stiffness_N_per_m, double position_noise_m);

struct CandidateFit {
  Side side = Side::contact;
  std::vector<FreeParameter> parameters;  // free ones
  std::vector<NamedParameters> starts;    // complete entries to start from
};

// `residual_W_N` and `normal_N` per sample of the current model, for effects whose start must be searched for
// (texture). Without starts and parameters where the recording cannot tell anything of the effect: one along the
// surface, of an indentation at one place. Throws BadData if the catalogue does not declare a parameter that this file
// knows of the effect.
CandidateFit candidate_fit(const Candidate& candidate, const RecordingScales& scales, const Recording& recording,
                           const Prediction& current);

// By how much an effect moves the surface along its normals, for those that do nothing else: what the mesh's makers
// declare as its error is not missing. Of a registration the RMS over the samples in contact (`n_W`; zero when free): a
// mesh that is off by as much makes up for it, however far it goes along the surface. Infinite for all other effects.
double surface_displacement_m(const NamedParameters& entry, const MotionColumns& motion, const std::vector<Vec3>& n_W);

}  // namespace touchstone::discrepancy
