// The harness's own floor on a recording: what the law that is right would score, given that the harness sees the world
// through instruments and a mesh. No renderer can be told to be better than that.
//
// Source: parametric bootstrap (Efron and Tibshirani 1993, section 6.5), the world being made of the recording itself:
//  1. The law (a proxy with Coulomb friction at the data set's stiffness and coefficient, of the probe's own radius) is
//     run on the in-trajectory of the recording, whose positions are smoothed by as much as the tracker's noise
//     (discrepancy/smooth_motion.h). Its contact points and forces are the truth of the simulated world. The tracker
//     measures the centre of a ball, a radius off the surface: a point there, moved below the surface by the tracker's
//     noise, would be nearer to a wall inside of the body, or to the other face of an edge, than any real recording is.
//  2. The world's surface is smooth, the mesh has facets: every force is turned from the facet's normal to that of the
//     smooth surface at the same place (SmoothNormals: the harness knows how its own facets lie to one another). At
//     edges of the body itself, which the mesh has as they are, a ball's force is not turned.
//  3. Of it a recording is made as the instruments would: the tracker's noise on the positions, its fast and its slow
//     part, the mesh's error along the normals, the sensor's noise and steps on the forces (instrument_description.h).
//     A draw has all of them.
//  4. The harness makes its in-trajectory of that, for the tip that every renderer gets, the law renders it with that
//     tip, and the error is scored as everybody's.
// The floor is the median of the draws, its interval their smallest and largest: one more score lies within them in
// (n - 1) / (n + 1) of cases whatever its law (Hahn and Meeker 1991, section 5.3.1), which is 95 % of 39. Where the
// surface has edges a few draws are large (the tip is assumed on the other face), and Student's interval
// reached below zero.
// The residual is due to instruments, mesh and the construction of the input. leaderboard_test.cc holds it against
// recordings whose law is known.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "harness/discrepancy/instrument_description.h"
#include "harness/pipeline/board.h"
#include "harness/pipeline/evaluation/request.h"
#include "harness/recording/trajectory.h"
#include "harness/rendering/catalogue.h"
#include "harness/rendering/in_trajectory.h"
#include "harness/surface/surface.h"

namespace touchstone::pipeline {

struct FloorWorld {
  std::string law;                 // the renderer: a proxy with mu_static and mu_dynamic
  recording::Recording recording;  // forces ON the probe
  std::shared_ptr<const surface::Surface> surface;
  recording::InTrajectoryMode in_trajectory = recording::InTrajectoryMode::synthesize;
  double tip_radius_m = 0.0;    // that every renderer gets
  double probe_radius_m = 0.0;  // of the ball that made the recording, where renderers get a point; else 0
  double stiffness_N_per_m = 0.0;
  double mu = 0.0;
  double contact_threshold_N = 0.0;
  discrepancy::InstrumentDescription instrument;
};

inline constexpr std::size_t floor_draws = 39;

// What a rendering of a simulated recording scores; `out` is that recording's way over the surface.
using FloorScore = std::function<double(const std::vector<Vec3>& rendered_W_N, const recording::Recording& recording,
                                        const recording::OutTrajectory& out)>;

// Deterministic in `seed`. One floor for each score, of the same draws.
std::vector<Floor> floors_of(const rendering::Catalogue& catalogue, const FloorWorld& world,
                             const std::vector<FloorScore>& scores, std::uint64_t seed,
                             std::size_t draws = floor_draws);
// Of the RMS error. Samples outside of `ranges` are rendered, not scored; throws BadData if none lies within.
Floor floor_of(const rendering::Catalogue& catalogue, const FloorWorld& world, const metrics::TimeRanges& ranges,
               std::uint64_t seed, std::size_t draws = floor_draws);

// The world of a request whose recording has forces and whose model names the law; `instrument` "" estimates it from
// the recording. `mu` empty: 0. Throws BadData for a recording without forces.
FloorWorld floor_world(const rendering::Catalogue& catalogue, const EvaluationRequest& request,
                       const std::filesystem::path& instrument, std::optional<double> mu);

}  // namespace touchstone::pipeline
