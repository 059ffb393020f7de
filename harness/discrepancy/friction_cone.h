// What the force alone tells of dry friction. A tip that slides pulls with mu(v) times its load, one that sticks with
// less, so that no force leaves the cone of the largest coefficient (Coulomb 1785). A tracker's noise hides where to
// and when a slow tip goes, but not how large its force is beside its load: forces far outside of the cone of the
// coefficient with which the tip slides fast show that it falls with speed, whatever became of the path.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "harness/discrepancy/evidence.h"

namespace touchstone::discrepancy {

struct ConeSample {
  double ratio = 0.0;               // to the load of the force along the surface that friction must make
  double speed_m_per_s = 0.0;       // along the surface, on the smoothed trajectory
  Vec3 direction_W = Vec3::Zero();  // of that motion; zero at rest
  double along = 0.0;               // of the ratio, the part along the direction: negative where friction resists
};

// What friction is read from: the forces of all but friction at the recorded positions, the blocks of the part that
// counts, and the smoothed trajectory. A verdict must hold for all.
struct ConeEvidence {
  rendering::Prediction others;
  const std::vector<ResidualBlock>* blocks = nullptr;
  const MotionColumns* likely = nullptr;
  double force_floor_N = 0.0;  // loads below it are left out
};
// `blocks`: of the evidence; `others`: the model without its friction.
ConeEvidence cone_evidence(const FitData& blocks, const NoiseModel& noise, const rendering::Model& others,
                           double force_floor_N);

// Of the part's samples in contact, given what the sensor showed at every sample. Small loads are left out.
std::vector<ConeSample> cone_samples(const ConeEvidence& evidence, const std::vector<Vec3>& shown_W_N);

struct Cone {
  double sliding = 0.0;  // the coefficient of the fastest 15 % of the samples: their median ratio
  double widest = 0.0;   // the ratio that 2 % of the samples exceed
  // How far forces leave the cone of the coefficient of fast sliding, as a share of it.
  [[nodiscard]] double excess() const { return widest / sliding - 1.0; }
};

// None of fewer than 300 samples, or where nothing pulls on a tip that slides fast.
std::optional<Cone> cone_of(const std::vector<ConeSample>& samples);

// The coefficient with which the force pulls a tip along that slides fast, which friction never does: the median part
// of the ratio along the motion of the fastest 15 % of the samples. None unless nine in ten of them are pulled along,
// to different sides, by a twentieth of the load or more.
std::optional<double> pulls_along(const std::vector<ConeSample>& samples);

// The excess where the model is the truth, in every simulated world of the noise (parametric bootstrap: Efron and
// Tibshirani 1993, chapter 6.5). `nominal`: the model's prediction at the recorded positions.
std::vector<double> null_excesses(const ConeEvidence& evidence, NoiseModel& noise, const rendering::Model& model,
                                  const rendering::Prediction& nominal);

// mu(v) = dynamic + (static - dynamic) exp(-(v / velocity)^2), as the effect stribeck-friction has it.
struct FallingCoefficient {
  double mu_static = 0.0;
  double mu_dynamic = 0.0;
  double velocity_m_per_s = 0.0;
};

// Read from the ratios: the dynamic one as of the cone, the others by regression of a quantile (Koenker and Bassett
// 1978, equation 3.1) over the samples that are fast enough to slide. Above the median, since a bristle that turns
// pulls with less; the static one is at least what was seen. None where `cone_of` has none.
inline constexpr double read_quantile = 0.6;
std::optional<FallingCoefficient> read_falling(const std::vector<ConeSample>& samples, double quantile = read_quantile);

// Read from runs of neighbouring samples drawn with replacement (Kuensch 1989), by a quantile that differs from draw to
// draw: how far the values depend on the samples and on what counts as sliding. The same for the same `draw`.
std::optional<FallingCoefficient> read_again(const std::vector<ConeSample>& samples, std::size_t draw);

void set_falling(rendering::Model& model, const std::string& friction, const FallingCoefficient& read);
// Whether `set_falling` sets the parameter.
bool is_of_falling(const std::string& parameter);

}  // namespace touchstone::discrepancy
