// The cost of a servo tick: 10 s at 1 kHz over the bumpy body, point tip and 1 mm ball, at 1,000 to 140,000 triangles;
// and of building the structures. One iteration is a whole replay, so the counters are means over 10,000 steps.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <numeric>
#include <vector>

#include "experiments/renderer_cost.h"
#include "harness/rendering/operations.h"
#include "harness/surface/embree_surface.h"
#include "renderers/catalogue.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::bench {
using rendering::Model;
using surface::Surface;

namespace {

constexpr std::size_t step_count = 10000;
constexpr std::size_t most_counted = 500000;  // triangles: larger meshes of counting numbers take long to make

const std::vector<Vec3>& cached_path(double tip_radius_m) {
  static std::map<double, std::vector<Vec3>> paths;
  auto& tips = paths[tip_radius_m];
  if (tips.empty()) tips = experiments::path_over_the_bumpy_body(tip_radius_m, step_count);
  return tips;
}

std::shared_ptr<const Surface> cached_body(std::size_t triangles) {
  static std::map<std::size_t, std::shared_ptr<const Surface>> bodies;
  auto& body = bodies[triangles];
  if (!body) body = make_embree_surface(synthetic::make_mesh("bumpy", {}, triangles).mesh);
  return body;
}

Model model_of(const std::string& name, double tip_radius_m, double mu) {
  Model model;
  model.renderer = name;
  if (name != "spring-quadratic") model.parameters["stiffness_N_per_m"] = 500.0;
  if (tip_radius_m > 0.0) model.parameters["tip_radius_m"] = tip_radius_m;
  if (mu > 0.0) model.parameters["mu_static"] = model.parameters["mu_dynamic"] = mu;
  model.source = "benchmark";
  return model;
}

// Floating-point operations of a step, mean and most; none where they are not counted.
void count(benchmark::State& state, const Model& model, const std::shared_ptr<const Surface>& body,
           const std::vector<Vec3>& tips) {
  const rendering::CountedRenderer counted = renderers::make_counted_renderer(model, body);
  if (!counted.renderer) return;
  const rendering::OperationReport report =
      count_operations(*counted.renderer, [&, i = std::size_t{0}](rendering::TipState& tip) mutable {
        if (i == tips.size()) return false;
        tip.t_s = static_cast<double>(i) * 1e-3;
        tip.p_W_m = tips[i++];
        return true;
      });
  state.counters["operations"] = report.mean;
  state.counters["most_operations"] = static_cast<double>(report.max);
}

// Of each step the least time of five runs, the clock's own taken off: what the slowest of them take for their own
// part. Each run by a renderer of its own, which has been nowhere yet.
void slowest(benchmark::State& state, const Model& model, const std::shared_ptr<const Surface>& body,
             const std::vector<Vec3>& tips) {
  using Clock = std::chrono::steady_clock;
  constexpr int runs = 5;
  const auto microseconds = [](Clock::duration d) { return std::chrono::duration<double, std::micro>(d).count(); };
  double clock_us = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 1000; ++i) {
    const auto before = Clock::now();
    clock_us = std::min(clock_us, microseconds(Clock::now() - before));
  }
  std::vector<double> least(tips.size(), std::numeric_limits<double>::infinity());
  for (int run = 0; run < runs; ++run) {
    const auto renderer = renderers::make_renderer(model, body);
    renderer->reset();
    for (std::size_t i = 0; i < tips.size(); ++i) {
      const auto before = Clock::now();
      benchmark::DoNotOptimize(renderer->step({static_cast<double>(i) * 1e-3, tips[i], Quat::Identity()}));
      least[i] = std::min(least[i], microseconds(Clock::now() - before) - clock_us);
    }
  }
  std::sort(least.begin(), least.end());
  state.counters["mean_us"] = std::accumulate(least.begin(), least.end(), 0.0) / static_cast<double>(least.size());
  state.counters["median_us"] = least[least.size() / 2];
  state.counters["p999_us"] = least[least.size() * 999 / 1000];
  state.counters["max_us"] = least.back();
}

void replay_bumpy(benchmark::State& state, const std::string& name, double tip_radius_m, double mu = 0.0) {
  const auto& tips = cached_path(tip_radius_m);
  const auto body = cached_body(static_cast<std::size_t>(state.range(0)));
  const Model model = model_of(name, tip_radius_m, mu);
  const auto renderer = renderers::make_renderer(model, body);
  std::size_t touching = 0;
  for (auto _ : state) {
    renderer->reset();
    touching = 0;
    for (std::size_t i = 0; i < tips.size(); ++i) {
      const rendering::StepResult result = renderer->step({static_cast<double>(i) * 1e-3, tips[i], Quat::Identity()});
      touching += result.contact ? 1U : 0U;
      benchmark::DoNotOptimize(result);
    }
  }
  const auto steps = static_cast<double>(state.iterations()) * static_cast<double>(step_count);
  state.counters["per_step"] = benchmark::Counter(steps, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["in_contact"] = static_cast<double>(touching) / static_cast<double>(step_count);
  state.counters["triangles"] = static_cast<double>(body->mesh()->triangle_count());
  if (const auto bytes = renderer->memory_bytes()) state.counters["bytes"] = static_cast<double>(*bytes);
  slowest(state, model, body, tips);
  if (body->mesh()->triangle_count() < most_counted) count(state, model, body, tips);
}

#define TOUCHSTONE_BENCH(...) \
  BENCHMARK_CAPTURE(replay_bumpy, __VA_ARGS__)->Arg(1000)->Arg(10000)->Arg(140000)->Unit(benchmark::kMillisecond)
#define TOUCHSTONE_BENCH_TO_1M(...)            \
  BENCHMARK_CAPTURE(replay_bumpy, __VA_ARGS__) \
      ->Arg(1000)                              \
      ->Arg(10000)                             \
      ->Arg(140000)                            \
      ->Arg(1000000)                           \
      ->Unit(benchmark::kMillisecond)
TOUCHSTONE_BENCH_TO_1M(god_object_point, "god-object", 0.0);
TOUCHSTONE_BENCH(friction_cone_point, "friction-cone", 0.0, 0.3);
TOUCHSTONE_BENCH_TO_1M(force_shading_point, "force-shading", 0.0);
TOUCHSTONE_BENCH(force_shading_friction_point, "force-shading", 0.0, 0.3);
TOUCHSTONE_BENCH_TO_1M(god_object_ball_1mm, "god-object", 1e-3);
TOUCHSTONE_BENCH(friction_cone_ball_1mm, "friction-cone", 1e-3, 0.3);
TOUCHSTONE_BENCH(force_shading_ball_1mm, "force-shading", 1e-3);
TOUCHSTONE_BENCH(penalty_point, "penalty", 0.0);
TOUCHSTONE_BENCH(spring_linear, "spring-linear", 0.0);
TOUCHSTONE_BENCH(spring_quadratic, "spring-quadratic", 0.0);
TOUCHSTONE_BENCH(voxel_64, "voxel", 0.0);
TOUCHSTONE_BENCH(voxel_sparse_64, "voxel-sparse", 0.0);
TOUCHSTONE_BENCH(implicit_64, "implicit", 0.0);
#undef TOUCHSTONE_BENCH
#undef TOUCHSTONE_BENCH_TO_1M

// The structures of the surface and of the renderer over a mesh in memory.
void make_renderer(benchmark::State& state, double tip_radius_m) {
  const surface::TriangleMesh mesh = synthetic::make_mesh("bumpy", {}, static_cast<std::size_t>(state.range(0))).mesh;
  const Model model = model_of("god-object", tip_radius_m, 0.0);
  for (auto _ : state) benchmark::DoNotOptimize(renderers::make_renderer(model, make_embree_surface(mesh)));
}
#define TOUCHSTONE_BENCH_MAKING(...)            \
  BENCHMARK_CAPTURE(make_renderer, __VA_ARGS__) \
      ->Arg(1000)                               \
      ->Arg(10000)                              \
      ->Arg(140000)                             \
      ->Arg(1000000)                            \
      ->MeasureProcessCPUTime()                 \
      ->UseRealTime()                           \
      ->Unit(benchmark::kMillisecond)
TOUCHSTONE_BENCH_MAKING(point, 0.0);
TOUCHSTONE_BENCH_MAKING(ball_1mm, 1e-3);
#undef TOUCHSTONE_BENCH_MAKING

}  // namespace
}  // namespace touchstone::bench
