#include "experiments/body_scan.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "harness/base/random.h"
#include "harness/recording/combine.h"
#include "harness/rendering/in_trajectory.h"
#include "harness/rendering/replay.h"
#include "harness/surface/embree_surface.h"
#include "recipe.h"
#include "renderers/catalogue.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::experiments {
using recording::Recording;
using rendering::Model;

BodyScan make_body_scan(std::uint64_t seed, double mu) {
  datasets::Recipe recipe = datasets::recipe("duck");
  recipe.contact.mu = mu;
  const auto measured = datasets::measure(datasets::make_scan(recipe, seed), recipe.sensor, recipe.tracker, seed);
  BodyScan scan;
  scan.recording = measured.recording;
  scan.recording.source = "synthetic scan of the duck-like body";
  scan.tip_radius_m = recipe.contact.tip_radius_m;
  scan.stiffness_N_per_m = recipe.stiffness_N_per_m;
  scan.true_mu = mu;
  scan.sensor = recipe.sensor;
  scan.tracker = recipe.tracker;
  scan.finest = synthetic::make_mesh(recipe.surface, recipe.parameters, 140000).mesh;
  if (scan.finest.triangle_count() != finest_triangles) throw std::logic_error("kFinestTriangles is out of date");
  const auto surface = make_embree_surface(scan.finest);
  scan.out = rendering::make_out_trajectory(scan.recording, *surface, {.tip_radius_m = scan.tip_radius_m});
  scan.in = rendering::synthesize_in_trajectory(scan.out, scan.stiffness_N_per_m);
  return scan;
}

Recording measured_again(const Recording& recording, const datasets::ForceSensor& sensor,
                         const datasets::Tracker& tracker, std::uint64_t seed) {
  const MotionColumns& motion = recording.motion;
  const double start_s = motion.t_s.front();
  const double duration_s = motion.t_s.back() - start_s;
  const auto row = [&](double t_s) {
    return std::min(static_cast<std::size_t>(std::lround(t_s * tracker.rate_Hz)), motion.size() - 1);
  };
  const Random root(seed);
  const auto pose = tracker.measure(
      [&](double t_s) {
        const std::size_t i = row(t_s);
        return datasets::Tracker::Pose{motion.p_W_m[i], motion.q_WS[i]};
      },
      duration_s, root.stream(0).next_u64());
  if (pose.t_s.size() != motion.size()) throw std::logic_error("measured_again: not a recording at the tracker's rate");
  // The sensor's errors alone, brought to the tracker's times as a measured force is.
  const auto force = sensor.measure([](double) { return Vec3(0.0, 0.0, 0.0); }, duration_s, root.stream(1).next_u64());
  const auto noise =
      recording::combine({pose.t_s, pose.truth_W_m, pose.truth_WS}, {force.t_s, force.measured_S_N, {}}).recording;
  Recording again = recording;
  again.motion.p_W_m = pose.measured_W_m;
  again.motion.q_WS = pose.measured_WS;
  std::vector<Vec3> noise_S_N(motion.size(), Vec3::Zero());
  for (std::size_t i = 0; i < noise.size(); ++i) noise_S_N[row(noise.motion.t_s[i])] = noise.f_W_N[i];
  for (std::size_t i = 0; i < motion.size(); ++i) {
    again.f_W_N[i] = pose.measured_WS[i] * (motion.q_WS[i].conjugate() * recording.f_W_N[i] + noise_S_N[i]);
  }
  return again;
}

ForceError force_error(const BodyScan& scan, const Model& model, const std::shared_ptr<const surface::Surface>& surface,
                       Against against, std::size_t from, std::size_t to) {
  const auto renderer = renderers::make_renderer(model, surface);
  const recording::RenderedTrajectory rendered = replay(*renderer, scan.in);
  ForceError error;
  double squares = 0.0;
  for (std::size_t i = from; i < to; ++i) {
    if (!(scan.out.normal_force_N[i] > 0.0)) continue;
    const Vec3 expected =
        against == Against::recorded ? scan.recording.f_W_N[i] : Vec3(scan.out.normal_force_N[i] * scan.out.n_W[i]);
    const double off = (rendered.f_W_N[i] - expected).norm();
    error.mean_N += off;
    squares += off * off;
    ++error.samples;
  }
  const auto n = static_cast<double>(error.samples);
  error.mean_N /= n;
  error.rms_N = std::sqrt(squares / n);
  return error;
}

Model proxy_model(const BodyScan& scan, const std::string& renderer) {
  Model model;
  model.renderer = renderer;
  model.source = "experiment";
  model.parameters = {{"stiffness_N_per_m", scan.stiffness_N_per_m}, {"tip_radius_m", scan.tip_radius_m}};
  return model;
}

}  // namespace touchstone::experiments
