// The harness's own floor on a recording: what the law that is right would score, given that the harness sees the world
// through instruments and a mesh. No renderer can be told to be better than that.
//
// Source: parametric bootstrap (Efron and Tibshirani 1993, section 6.5), the world being made of the recording itself:
//  1. The law (a proxy with Coulomb friction at the data set's stiffness and coefficient) is run on the in-trajectory
//  of
//     the recording. Its contact points and forces are the truth of the simulated world: they obey the law exactly.
//  2. Of it a recording is made as the instruments would: the tracker's noise on the positions, the mesh's error along
//     the normals and in their direction (the force leans with the true normal), the sensor's noise and steps on the
//     forces (harness/discrepancy/instrument_description.h). A draw has all of them.
//  3. The harness makes its in-trajectory of that, the law renders it, and the error is scored as everybody's.
// What is left is due to instruments, mesh and the construction of the input.
#pragma once

#include <cstdint>
#include <memory>

#include "harness/discrepancy/instrument_description.h"
#include "harness/pipeline/board.h"
#include "harness/pipeline/evaluation/request.h"
#include "harness/pipeline/pipeline_rooms.h"
#include "harness/recording/trajectory.h"
#include "harness/rendering/catalogue.h"
#include "harness/surface/surface.h"

namespace touchstone::pipeline {

struct FloorWorld {
  std::string law;      // the renderer: a proxy with mu_static and mu_dynamic
  Recording recording;  // forces ON the probe
  std::shared_ptr<const Surface> surface;
  InTrajectoryMode in_trajectory = InTrajectoryMode::synthesize;
  double tip_radius_m = 0.0;
  double stiffness_N_per_m = 0.0;
  double mu = 0.0;
  double contact_threshold_N = 0.0;
  InstrumentDescription instrument;
};

inline constexpr std::size_t kFloorDraws = 12;

// The mean of the draws' RMS errors, and the interval that holds 95 % of such scores if they are normal. Deterministic
// in `seed`. Samples outside of `ranges` are rendered, not scored.
Floor floor_of(const Catalogue& catalogue, const FloorWorld& world, const TimeRanges& ranges, std::uint64_t seed,
               std::size_t draws = kFloorDraws);

// The world of a request whose recording has forces and whose model names the law; `instrument` "" estimates it from
// the recording. `mu` empty: 0.
FloorWorld floor_world(const Catalogue& catalogue, const EvaluationRequest& request,
                       const std::filesystem::path& instrument, std::optional<double> mu);

}  // namespace touchstone::pipeline
