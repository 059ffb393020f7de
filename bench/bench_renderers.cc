// The cost of a servo tick: 10 s at 1 kHz over the bumpy body, point tip and 1 mm ball, at 1,000 to 140,000 triangles;
// and of building the structures. One iteration is a whole replay, so the counters are means over 10,000 steps.
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <vector>

#include "harness/surface/embree_surface.h"
#include "renderers/catalogue.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone {
namespace {

constexpr std::size_t kSteps = 10000;

// Three turns about the body on a path that crosses triangles in all directions, about 60 mm/s, pressed up to 1 mm deep
// by a point, or by the ball whose centre the positions are, with a tap into free space every second.
std::vector<Vec3> path(double tip_radius_m) {
  const auto body = synthetic::make_surface("bumpy");
  std::vector<Vec3> tips;
  for (std::size_t i = 0; i < kSteps; ++i) {
    const double t = static_cast<double>(i) * 1e-3;
    const double around = 2.0 * M_PI * t / 3.3;
    const double up = 0.9 * std::sin(2.0 * M_PI * t / 7.1);
    const Vec3 out(std::cos(around) * std::cos(up), std::sin(around) * std::cos(up), std::sin(up));
    const SurfacePoint foot = body->closest(0.03 * out);
    const double depth = 1e-3 * (0.45 + 0.55 * std::sin(2.0 * M_PI * t));
    tips.push_back(foot.p_W_m + (tip_radius_m - depth) * foot.n_W);
  }
  return tips;
}

const std::vector<Vec3>& cached_path(double tip_radius_m) {
  static std::map<double, std::vector<Vec3>> paths;
  auto& tips = paths[tip_radius_m];
  if (tips.empty()) tips = path(tip_radius_m);
  return tips;
}

std::shared_ptr<const Surface> cached_body(std::size_t triangles) {
  static std::map<std::size_t, std::shared_ptr<const Surface>> bodies;
  auto& body = bodies[triangles];
  if (!body) body = make_embree_surface(synthetic::make_mesh("bumpy", {}, triangles).mesh);
  return body;
}

std::unique_ptr<Renderer> god_object(std::size_t triangles, double tip_radius_m) {
  Model model;
  model.renderer = "god-object";
  model.parameters = {{"stiffness_N_per_m", 500.0}, {"tip_radius_m", tip_radius_m}};
  model.source = "benchmark";
  return make_renderer(model, cached_body(triangles));
}

void replay_bumpy(benchmark::State& state, double tip_radius_m) {
  const auto& tips = cached_path(tip_radius_m);
  const auto renderer = god_object(static_cast<std::size_t>(state.range(0)), tip_radius_m);
  std::size_t touching = 0;
  for (auto _ : state) {
    renderer->reset();
    touching = 0;
    for (std::size_t i = 0; i < tips.size(); ++i) {
      const StepResult result = renderer->step({static_cast<double>(i) * 1e-3, tips[i], Quat::Identity()});
      touching += result.contact ? 1U : 0U;
      benchmark::DoNotOptimize(result);
    }
  }
  const auto steps = static_cast<double>(state.iterations()) * static_cast<double>(kSteps);
  state.counters["per_step"] = benchmark::Counter(steps, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["in_contact"] = static_cast<double>(touching) / static_cast<double>(kSteps);
  state.counters["triangles"] =
      static_cast<double>(cached_body(static_cast<std::size_t>(state.range(0)))->mesh()->triangle_count());
}

void BM_GodObjectPoint(benchmark::State& state) { replay_bumpy(state, 0.0); }
void BM_GodObjectBall1mm(benchmark::State& state) { replay_bumpy(state, 1e-3); }
BENCHMARK(BM_GodObjectPoint)->Arg(1000)->Arg(10000)->Arg(140000)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_GodObjectBall1mm)->Arg(1000)->Arg(10000)->Arg(140000)->Unit(benchmark::kMillisecond);

// The structures of the surface and of the renderer over a mesh in memory.
void BM_Build(benchmark::State& state) {
  const TriangleMesh mesh = synthetic::make_mesh("bumpy", {}, static_cast<std::size_t>(state.range(0))).mesh;
  Model model;
  model.renderer = "god-object";
  model.source = "benchmark";
  for (auto _ : state) benchmark::DoNotOptimize(make_renderer(model, make_embree_surface(mesh)));
}
BENCHMARK(BM_Build)->Arg(10000)->Arg(140000)->Arg(1000000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace touchstone
