#include "apps/experiments/body_scan.h"

#include <cmath>
#include <stdexcept>

#include "harness/rendering/in_trajectory.h"
#include "harness/rendering/replay.h"
#include "harness/surface/embree_surface.h"
#include "renderers/catalogue.h"
#include "synthetic/datasets/recipe.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::experiments {

BodyScan make_body_scan(std::uint64_t seed, double mu) {
  synthetic::Recipe recipe = synthetic::recipe("duck");
  recipe.contact.mu = mu;
  const auto measured = synthetic::measure(synthetic::make_scan(recipe, seed), recipe.sensor, recipe.tracker, seed);
  BodyScan scan;
  scan.recording = measured.recording;
  scan.recording.source = "synthetic scan of the duck-like body";
  scan.tip_radius_m = recipe.contact.tip_radius_m;
  scan.stiffness_N_per_m = recipe.stiffness_N_per_m;
  scan.true_mu = mu;
  scan.finest = synthetic::make_mesh(recipe.surface, recipe.parameters, 140000).mesh;
  if (scan.finest.triangle_count() != kFinestTriangles) throw std::logic_error("kFinestTriangles is out of date");
  const auto surface = make_embree_surface(scan.finest);
  scan.out = make_out_trajectory(scan.recording, *surface, {.tip_radius_m = scan.tip_radius_m});
  scan.in = synthesize_in_trajectory(scan.out, scan.stiffness_N_per_m);
  return scan;
}

ForceError force_error(const BodyScan& scan, const Model& model, const std::shared_ptr<const Surface>& surface,
                       Against against, std::size_t from, std::size_t to) {
  const auto renderer = make_renderer(model, surface);
  const RenderedTrajectory rendered = replay(*renderer, scan.in);
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
