#include "harness/pipeline/leaderboard/input_floor.h"

#include <fmt/format.h>

#include <cmath>

#include "harness/base/error.h"
#include "harness/pipeline/evaluation/inputs.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/in_trajectory.h"
#include "harness/rendering/replay.h"
#include "harness/report/quantity.h"
#include "harness/stats/distributions.h"
#include "harness/stats/summary.h"
#include "harness/surface/facet_angle.h"

namespace touchstone::pipeline {
namespace {

InTrajectory in_trajectory_of(const FloorWorld& world, const Recording& recording, OutTrajectory& out) {
  out = make_out_trajectory(recording, *world.surface, {world.tip_radius_m, world.contact_threshold_N});
  switch (world.in_trajectory) {
    case InTrajectoryMode::whole_force:
      return whole_force_in_trajectory(out, recording.f_W_N, world.stiffness_N_per_m);
    case InTrajectoryMode::measured:
      return measured_in_trajectory(recording);
    case InTrajectoryMode::synthesize:
      break;
  }
  return synthesize_in_trajectory(out, world.stiffness_N_per_m);
}

std::unique_ptr<Renderer> law_of(const Catalogue& catalogue, const FloorWorld& world) {
  Model model;
  model.renderer = world.law;
  model.source = "the floor's law";
  model.parameters = {{"stiffness_N_per_m", world.stiffness_N_per_m},
                      {"tip_radius_m", world.tip_radius_m},
                      {"mu_static", world.mu},
                      {"mu_dynamic", world.mu}};
  return catalogue.make(model, world.surface);
}

// One recording of the true world, as the instruments would have made it.
Recording measured_once(const FloorWorld& world, const RenderedTrajectory& truth, const std::vector<Vec3>& n_W,
                        const MotionColumns& where, Random& random) {
  Recording out = world.recording;
  out.motion = with_position_noise(where, world.instrument, random);
  out.motion = with_geometry_error(out.motion, n_W, world.instrument, random);
  const std::vector<Vec3> tilts = normal_tilts(where, n_W, world.instrument, random);
  const std::vector<Vec3> noise = force_noise(where, world.instrument, random);
  for (std::size_t i = 0; i < out.size(); ++i) {
    // The true normal leans against the mesh's, and the whole contact force with it.
    const Vec3 axis = n_W[i].cross(tilts[i]);
    out.f_W_N[i] = truth.f_W_N[i] + axis.cross(truth.f_W_N[i]) + noise[i];
  }
  return out;
}

double rms_of(const std::vector<Vec3>& rendered, const Recording& recording, const TimeRanges& ranges) {
  double sum = 0.0;
  std::size_t samples = 0;
  for (std::size_t i = 0; i < rendered.size(); ++i) {
    if (!ranges.contains(recording.motion.t_s[i], recording.motion.t_s.front())) continue;
    sum += (rendered[i] - recording.f_W_N[i]).squaredNorm();
    ++samples;
  }
  if (samples == 0) throw BadData(recording.source + ": no sample lies in the time range that is scored");
  return std::sqrt(sum / static_cast<double>(samples));
}

}  // namespace

Floor floor_of(const Catalogue& catalogue, const FloorWorld& world, const TimeRanges& ranges, std::uint64_t seed,
               std::size_t draws) {
  const auto law = law_of(catalogue, world);
  OutTrajectory out;
  const InTrajectory in = in_trajectory_of(world, world.recording, out);
  const RenderedTrajectory truth = replay(*law, in);
  // A rigid probe is where its contact point is; one in a compliant object where it was measured.
  MotionColumns where = in.motion;
  std::vector<Vec3> n_W;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (world.in_trajectory != InTrajectoryMode::measured) where.p_W_m[i] = truth.contact_W_m[i];
    n_W.push_back(world.surface->closest(truth.contact_W_m[i]).n_W);
  }
  std::vector<double> scores;
  const Random root(seed);
  for (std::size_t d = 0; d < draws; ++d) {
    Random random = root.stream(d);
    const Recording recording = measured_once(world, truth, n_W, where, random);
    OutTrajectory again;
    scores.push_back(rms_of(replay(*law, in_trajectory_of(world, recording, again)).f_W_N, recording, ranges));
  }
  const auto n = static_cast<double>(draws);
  Floor floor;
  floor.rms_N = stats::mean(scores);
  // Of one more draw, whose mean and spread are known from so many.
  const double spread = stats::standard_deviation(scores) * std::sqrt(n / (n - 1.0)) * std::sqrt(1.0 + 1.0 / n);
  const double half = stats::student_t_975(n - 1.0) * spread;
  floor.low95_N = std::max(0.0, floor.rms_N - half);
  floor.high95_N = floor.rms_N + half;
  floor.how = fmt::format(
      "{} simulated recordings of a world that obeys a proxy with friction {:.3g}, with {} instruments, the mesh's "
      "error "
      "({}) and this input",
      draws, world.mu, world.instrument.declared ? "the declared" : "estimated",
      display_setting(world.instrument.geometry_error_m, "m"));
  return floor;
}

FloorWorld floor_world(const Catalogue& catalogue, const EvaluationRequest& request,
                       const std::filesystem::path& instrument, std::optional<double> mu) {
  const EvaluationInputs inputs = load_inputs(catalogue, request);
  FloorWorld world;
  world.law = request.model.renderer;
  world.recording = load_recording(request.recording, request.clock).value;
  if (world.recording.f_W_N.size() != world.recording.size())
    throw BadData(request.recording.string() + ": a floor needs measured forces");
  if (request.flip_force) {
    for (Vec3& f : world.recording.f_W_N) f = -f;
  }
  world.surface = inputs.surface;
  world.in_trajectory = request.in_trajectory;
  world.tip_radius_m = inputs.tip_radius_m;
  world.stiffness_N_per_m = inputs.stiffness_N_per_m;
  world.mu = mu.value_or(0.0);
  world.contact_threshold_N = request.contact_threshold_N;
  world.instrument = instrument.empty() ? estimate_instrument(world.recording) : load_instrument(instrument);
  std::vector<std::int32_t> touched;
  const std::size_t stride = std::max<std::size_t>(1, world.recording.size() / 1000);
  for (std::size_t i = 0; i < world.recording.size(); i += stride)
    touched.push_back(world.surface->closest(world.recording.motion.p_W_m[i]).triangle);
  world.instrument.normal_error_rad = median_facet_angle_rad(inputs.mesh, touched);
  world.instrument.mesh_extent_m = inputs.mesh.bounds().diagonal().norm();
  return world;
}

}  // namespace touchstone::pipeline
