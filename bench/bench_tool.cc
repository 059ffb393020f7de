// The cost of a servo tick with a tool that has a shape, pressed and slid and turned in contact at 1 kHz: 2,000 points
// of a shell against the voxels of 100,000 triangles; 10,000 triangles against 10,000 with constraints. One iteration
// is a run of 4,000 steps; the counters are microseconds of single steps.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <vector>

#include "harness/tool/tool_path.h"
#include "renderers/tool/tool_catalogue.h"
#include "synthetic/tool/tool_meshes.h"

namespace touchstone::bench {
namespace {

using surface::TriangleMesh;
using tool::Pose;
using tool::Tool;
using tool::ToolSettings;

constexpr int kSteps = 4000;
constexpr double kDensity_kg_per_m3 = 1000.0;

Tool solid(const TriangleMesh& mesh) { return {mesh, tool::solid_mass_frame(mesh, kDensity_kg_per_m3)}; }

// From `touching`: 2 mm into the object, in circles of 5 mm, turning by 0.1 rad.
void run(benchmark::State& state, tool::ToolRenderer& renderer, const Pose& touching) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> times_us;
  std::size_t contacts = 0;
  std::size_t touched = 0;
  for (auto _ : state) {
    renderer.reset();
    for (int i = 0; i < kSteps; ++i) {
      const double t = 1e-3 * i;
      const double depth = i < 500 ? 0.003 - 0.005 * i / 500.0 : -0.002;
      const Pose handle =
          tool::moved(touching, {Vec3(0.005 * std::sin(3.0 * t), 0.005 * (1.0 - std::cos(3.0 * t)), depth),
                                 0.1 * Vec3(std::sin(2.0 * t), std::sin(3.1 * t), std::sin(1.3 * t))});
      const auto began = Clock::now();
      const tool::ToolResult result = renderer.step({t, handle});
      if (i >= 500) {  // free steps cost less
        times_us.push_back(std::chrono::duration<double, std::micro>(Clock::now() - began).count());
        contacts += result.contacts.size();
        touched += result.contact ? 1U : 0U;
      }
    }
  }
  std::ranges::sort(times_us);
  const auto at_share = [&](double share) {
    return times_us[static_cast<std::size_t>(share * double(times_us.size() - 1))];
  };
  state.counters["median_us"] = at_share(0.5);
  state.counters["p99_us"] = at_share(0.99);
  state.counters["p999_us"] = at_share(0.999);
  state.counters["contacts"] = touched == 0 ? 0.0 : double(contacts) / double(touched);
}

void BM_VoxmapPointshell(benchmark::State& state) {
  // An ellipsoid of 40 mm with a point per 1.45 mm: about 2,000 points.
  const Tool tool = solid(synthetic::ellipsoid_mesh(Vec3(0, 0, -0.03), Vec3(0.02, 0.018, 0.016), 40000));
  ToolSettings settings;
  constexpr double kSpacing_m = 1.45e-3;
  settings.parameters["point_spacing_m"] = kSpacing_m;
  const auto object = synthetic::ellipsoid_mesh(Vec3(0, 0, -0.05), Vec3(0.05, 0.05, 0.05), 100000);
  const auto renderer = renderers::make_tool_renderer("voxmap-pointshell", tool, object, settings);
  run(state, *renderer, {Vec3(0, 0, 0.046), Quat::Identity()});
  state.counters["points"] = double(tool::make_point_shell(tool.mesh_T, kSpacing_m).size());
}
BENCHMARK(BM_VoxmapPointshell)->Unit(benchmark::kMillisecond);

void BM_GodObjectBallOnBall(benchmark::State& state) {
  const Tool tool = solid(synthetic::ellipsoid_mesh(Vec3(0, 0, -0.03), Vec3(0.02, 0.018, 0.016), 10000));
  const auto object = synthetic::ellipsoid_mesh(Vec3(0, 0, -0.05), Vec3(0.05, 0.05, 0.05), 10000);
  const auto renderer = renderers::make_tool_renderer("god-object-tool", tool, object, {});
  run(state, *renderer, {Vec3(0, 0, 0.046), Quat::Identity()});
}
BENCHMARK(BM_GodObjectBallOnBall)->Unit(benchmark::kMillisecond);

// Hundreds of candidate pairs: the finely divided faces of a cube and a slab.
void BM_GodObjectBoxOnSlab(benchmark::State& state) {
  const Tool tool = solid(synthetic::box_mesh(Vec3(-0.01, -0.01, -0.03), Vec3(0.01, 0.01, -0.01), 29));
  const auto object = synthetic::box_mesh(Vec3(-0.04, -0.04, -0.02), Vec3(0.04, 0.04, 0.0), 29);
  const auto renderer = renderers::make_tool_renderer("god-object-tool", tool, object, {});
  run(state, *renderer, {Vec3(0, 0, 0.03), Quat::Identity()});
}
BENCHMARK(BM_GodObjectBoxOnSlab)->Unit(benchmark::kMillisecond);

void BM_PenaltyBallOnBall(benchmark::State& state) {
  const Tool tool = solid(synthetic::ellipsoid_mesh(Vec3(0, 0, -0.03), Vec3(0.02, 0.018, 0.016), 10000));
  const auto object = synthetic::ellipsoid_mesh(Vec3(0, 0, -0.05), Vec3(0.05, 0.05, 0.05), 10000);
  const auto renderer = renderers::make_tool_renderer("penalty-coupling", tool, object, {});
  run(state, *renderer, {Vec3(0, 0, 0.046), Quat::Identity()});
}
BENCHMARK(BM_PenaltyBallOnBall)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace touchstone::bench
