#include "harness/pipeline/evaluation/input_floor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/base/rotations.h"
#include "harness/discrepancy/smooth_motion.h"
#include "harness/pipeline/evaluation/inputs.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/in_trajectory.h"
#include "harness/rendering/replay.h"
#include "harness/report/quantity.h"
#include "harness/stats/quantile.h"
#include "harness/surface/facet_angle.h"

namespace touchstone::pipeline {
using recording::InTrajectory;
using recording::InTrajectoryMode;
using recording::OutTrajectory;
using recording::Recording;
using rendering::Catalogue;
using surface::SmoothNormals;

namespace {

// For a tip of `radius_m`.
InTrajectory in_trajectory_of(const FloorWorld& world, double radius_m, const Recording& recording,
                              OutTrajectory& out) {
  out = rendering::make_out_trajectory(recording, *world.surface, {radius_m, world.contact_threshold_N});
  switch (world.in_trajectory) {
    case InTrajectoryMode::whole_force:
      return rendering::whole_force_in_trajectory(out, recording.f_W_N, world.stiffness_N_per_m);
    case InTrajectoryMode::measured:
      return rendering::measured_in_trajectory(recording);
    case InTrajectoryMode::synthesize:
      break;
  }
  return rendering::synthesize_in_trajectory(out, world.stiffness_N_per_m);
}

std::unique_ptr<rendering::Renderer> law_of(const Catalogue& catalogue, const FloorWorld& world, double radius_m) {
  rendering::Model model;
  model.renderer = world.law;
  model.source = "the floor's law";
  model.parameters = {{"stiffness_N_per_m", world.stiffness_N_per_m},
                      {"tip_radius_m", radius_m},
                      {"mu_static", world.mu},
                      {"mu_dynamic", world.mu}};
  return catalogue.make(model, world.surface);
}

// The tracker's noise at every sample: anew for each of the tracker's own samples, which straight lines join, and a
// slow part (an Ornstein-Uhlenbeck process).
std::vector<Vec3> tracker_noise(const MotionColumns& motion, const discrepancy::InstrumentDescription& instrument,
                                Random& random) {
  const auto draw = [&random] { return Vec3(random.normal(), random.normal(), random.normal()); };
  const double total = instrument.position_noise_m;
  const double slow = instrument.position_wander_m;
  const double fast = std::sqrt(std::max(0.0, total * total - slow * slow));
  const double start_s = motion.t_s.front();
  const double rate_Hz = instrument.position_rate_Hz;
  std::vector<Vec3> samples;
  const auto count = static_cast<std::size_t>((motion.t_s.back() - start_s) * rate_Hz) + 2;
  const double stay = std::exp(-1.0 / (rate_Hz * instrument.position_wander_time_constant_s));
  Vec3 wander = slow * draw();
  for (std::size_t i = 0; i < count; ++i) {
    samples.push_back(fast * draw() + wander);
    wander = stay * wander + slow * std::sqrt(1.0 - stay * stay) * draw();
  }
  std::vector<Vec3> noise;
  for (const double t_s : motion.t_s) {
    const double place = (t_s - start_s) * rate_Hz;
    const auto before = std::min(static_cast<std::size_t>(place), count - 2);
    const double share = place - static_cast<double>(before);
    noise.push_back((1.0 - share) * samples[before] + share * samples[before + 1]);
  }
  return noise;
}

// The world that is measured: where the tip was, the mesh's normals there, and the force on it.
struct TrueWorld {
  MotionColumns where;
  std::vector<Vec3> n_W;
  std::vector<Vec3> f_W_N;
};

// How the smooth surface at a contact lies to the mesh there: turns the mesh's normal to that of the smooth surface.
struct ContactNormal {
  Vec3 n_W;  // the direction in which the mesh pushes the tip
  Quat to_smooth;
};

// `at`: the surface point closest to `tip_W_m`, the centre of a ball of `radius_m`.
ContactNormal contact_normal(const surface::TriangleMesh& mesh, const SmoothNormals& smooth,
                             const surface::SurfacePoint& at, const Vec3& tip_W_m, double radius_m) {
  const Vec3 facet = mesh.scaled_normal(static_cast<std::size_t>(at.triangle)).normalized();
  const Vec3 body = smooth.at(at.triangle, at.p_W_m);
  const bool edge = at.feature == surface::Feature::edge || at.feature == surface::Feature::vertex;
  // A ball in contact with an edge is pushed along the line from there to its centre (out_trajectory.h, rule 4).
  if (radius_m == 0.0 || !edge || !(at.signed_distance_m > 0.0)) return {at.n_W, shortest_rotation(facet, body)};
  const Vec3 n = (tip_W_m - at.p_W_m) / at.distance_m;
  // An edge of the body is no error of the mesh: the ball rolls about it, in the world as on the mesh. At an edge of
  // the tessellation the smooth normal lies between the facets as the pseudo-normal does; at one of the body it is that
  // of the one side, half of the edge's angle away, and an edge is of the body from SmoothNormals' angle on.
  const bool of_the_body = at.n_W.dot(body) < std::cos(0.5 * SmoothNormals::sharp_rad);
  return {n, of_the_body ? Quat::Identity() : shortest_rotation(n, body)};
}

// The law's answer for a probe of `radius_m`, turned from the facets to the smooth surface.
TrueWorld true_world(const FloorWorld& world, double radius_m, const recording::RenderedTrajectory& truth,
                     const InTrajectory& in) {
  TrueWorld out;
  // A rigid probe is where its contact point is; one in a compliant object where it was measured.
  out.where = in.motion;
  const surface::TriangleMesh& mesh = *world.surface->mesh();
  const SmoothNormals smooth(mesh);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (world.in_trajectory != InTrajectoryMode::measured) out.where.p_W_m[i] = truth.contact_W_m[i];
    const Vec3& tip = truth.contact_W_m[i];
    const ContactNormal normal = contact_normal(mesh, smooth, world.surface->closest(tip), tip, radius_m);
    out.n_W.push_back(normal.n_W);
    out.f_W_N.push_back(normal.to_smooth * truth.f_W_N[i]);
  }
  return out;
}

// One recording of it, as the instruments would have made it.
Recording measured_once(const FloorWorld& world, const TrueWorld& truth, Random& random) {
  Recording out = world.recording;
  out.motion = with_geometry_error(truth.where, truth.n_W, world.instrument, random);
  const std::vector<Vec3> moved = tracker_noise(truth.where, world.instrument, random);
  const std::vector<Vec3> noise = force_noise(truth.where, world.instrument, random);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out.motion.p_W_m[i] += moved[i];
    out.f_W_N[i] = truth.f_W_N[i] + noise[i];
  }
  return out;
}

double rms_of(const std::vector<Vec3>& rendered, const Recording& recording, const metrics::TimeRanges& ranges) {
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

std::vector<Floor> floors_of(const Catalogue& catalogue, const FloorWorld& world, const std::vector<FloorScore>& scores,
                             std::uint64_t seed, std::size_t draws) {
  const double probe_m = world.tip_radius_m > 0.0 ? world.tip_radius_m : world.probe_radius_m;
  const auto law = law_of(catalogue, world, world.tip_radius_m);
  Recording smoothed = world.recording;
  discrepancy::InstrumentDescription fast = world.instrument;
  fast.position_noise_m = std::sqrt(
      std::max(0.0, std::pow(world.instrument.position_noise_m, 2) - std::pow(world.instrument.position_wander_m, 2)));
  smoothed.motion = smoothed_motion(smoothed.motion, fast);
  OutTrajectory out;
  const InTrajectory in = in_trajectory_of(world, probe_m, smoothed, out);
  const TrueWorld truth = true_world(world, probe_m, replay(*law_of(catalogue, world, probe_m), in), in);
  std::vector<std::vector<double>> drawn(scores.size());
  const Random root(seed);
  for (std::size_t d = 0; d < draws; ++d) {
    Random random = root.stream(d);
    const Recording recording = measured_once(world, truth, random);
    OutTrajectory again;
    const std::vector<Vec3> rendered =
        replay(*law, in_trajectory_of(world, world.tip_radius_m, recording, again)).f_W_N;
    for (std::size_t s = 0; s < scores.size(); ++s) drawn[s].push_back(scores[s](rendered, recording, again));
  }
  std::vector<Floor> floors;
  for (std::vector<double>& own : drawn) {
    Floor floor;
    const auto [smallest, largest] = std::ranges::minmax(own);
    floor.low95_N = smallest;
    floor.high95_N = largest;
    floor.rms_N = stats::median(std::move(own));
    floor.how = fmt::format(
        "{} simulated recordings of a world that obeys a proxy with friction {:.3g}, with {} instruments, the mesh's "
        "facets and error ({}) and this input",
        draws, world.mu, world.instrument.declared ? "the declared" : "estimated",
        report::display_setting(world.instrument.geometry_error_m, "m"));
    floors.push_back(std::move(floor));
  }
  return floors;
}

Floor floor_of(const Catalogue& catalogue, const FloorWorld& world, const metrics::TimeRanges& ranges,
               std::uint64_t seed, std::size_t draws) {
  const FloorScore score = [&ranges](const std::vector<Vec3>& rendered, const Recording& recording,
                                     const OutTrajectory&) { return rms_of(rendered, recording, ranges); };
  return floors_of(catalogue, world, {score}, seed, draws).front();
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
  world.probe_radius_m = request.probe_radius_m;
  world.stiffness_N_per_m = inputs.stiffness_N_per_m;
  world.mu = mu.value_or(0.0);
  world.contact_threshold_N = request.contact_threshold_N;
  world.instrument =
      instrument.empty() ? discrepancy::estimate_instrument(world.recording) : discrepancy::load_instrument(instrument);
  world.instrument.mesh_extent_m = inputs.mesh.bounds().diagonal().norm();
  return world;
}

}  // namespace touchstone::pipeline
