// The scan on which the experiments of Ruffaldi et al. 2006 (section 4) are repeated: the duck-like body dragged over
// by a ball-tipped probe with friction, measured by models of their instruments (synthetic/). What the renderers get is
// the measured recording alone.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "force_sensor.h"
#include "harness/recording/trajectory.h"
#include "harness/rendering/model.h"
#include "harness/surface/surface.h"
#include "tracker.h"

namespace touchstone::experiments {

// Of the finest mesh; make_body_scan() holds itself to it.
inline constexpr std::size_t finest_triangles = 141120;

struct BodyScan {
  recording::Recording recording;  // measured, at the tracker's 60 Hz
  recording::OutTrajectory out;    // made from it over the finest mesh
  recording::InTrajectory in;      // equation 2
  surface::TriangleMesh finest;
  double tip_radius_m = 0.0;
  double stiffness_N_per_m = 0.0;  // of the virtual probe, the paper's 0.5 N/mm
  double true_mu = 0.0;            // hidden from the renderers, for the answer
  datasets::ForceSensor sensor;    // what is known of the instruments
  datasets::Tracker tracker;
};

// `mu`: the body's friction.
BodyScan make_body_scan(std::uint64_t seed, double mu);

// What the instruments would have recorded had the tip been where `recording` has it, and felt what it has there: their
// errors a second time, drawn anew.
recording::Recording measured_again(const recording::Recording& recording, const datasets::ForceSensor& sensor,
                                    const datasets::Tracker& tracker, std::uint64_t seed);

// The samples in contact of one part of a scan.
struct ForceError {
  double mean_N = 0.0;  // equation 3 of the paper, which it calls RMS
  double rms_N = 0.0;
  std::size_t samples = 0;
};

enum class Against : std::uint8_t {
  recorded,     // the force as recorded
  normal_part,  // its normal part, from which the in-trajectory was made: what a frictionless renderer can give back
};

// Renders the in-trajectory and compares in [from, to) of the samples. Throws BadData for a renderer that refuses.
ForceError force_error(const BodyScan& scan, const rendering::Model& model,
                       const std::shared_ptr<const surface::Surface>& surface, Against against, std::size_t from,
                       std::size_t to);

// The model of a proxy-based renderer for the scan's tip and stiffness.
rendering::Model proxy_model(const BodyScan& scan, const std::string& renderer);

}  // namespace touchstone::experiments
