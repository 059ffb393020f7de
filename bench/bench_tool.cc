// The cost of a servo tick with a tool that has a shape, pressed and slid and turned in contact at 1 kHz: 2,000 points
// of a shell against the voxels of 100,000 triangles; 10,000 triangles against 10,000 with constraints. One iteration
// is a run of 4,000 steps; the counters are microseconds of single steps, of the clock of the thread, so that what else
// the machine does counts little.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <numbers>
#include <vector>

#include "contacts/tool_meshes.h"
#include "harness/tool/tool_path.h"
#include "tool_renderers/tool_catalogue.h"

namespace touchstone::bench {
namespace {

using surface::TriangleMesh;
using tool::Pose;
using tool::Tool;
using tool::ToolSettings;

constexpr int steps = 4000;
constexpr double material_density_kg_per_m3 = 1000.0;

Tool solid(const TriangleMesh& mesh) { return {mesh, tool::solid_mass_frame(mesh, material_density_kg_per_m3)}; }

// Of this thread alone.
double now_us() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e6 * double(time.tv_sec) + 1e-3 * double(time.tv_nsec);
}

// From `touching`: 2 mm into the object, in circles of 5 mm, turning by 0.1 rad.
void run(benchmark::State& state, tool::ToolRenderer& renderer, const Pose& touching, double aside = 1.0) {
  std::vector<double> times_us;
  std::size_t contacts = 0;
  std::size_t touched = 0;
  for (auto _ : state) {
    renderer.reset();
    for (int i = 0; i < steps; ++i) {
      const double t = 1e-3 * i;
      const double depth = i < 500 ? 0.003 - 0.005 * i / 500.0 : -0.002;
      const Pose handle = tool::moved(
          touching, {Vec3(aside * 0.005 * std::sin(3.0 * t), aside * 0.005 * (1.0 - std::cos(3.0 * t)), depth),
                     0.1 * Vec3(std::sin(2.0 * t), std::sin(3.1 * t), std::sin(1.3 * t))});
      const double began = now_us();
      const tool::ToolResult result = renderer.step({t, handle});
      const double took = now_us() - began;
      if (i >= 500) {  // free steps cost less
        times_us.push_back(took);
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
  const Tool tool = solid(contacts::ellipsoid_mesh(Vec3(0, 0, -0.03), Vec3(0.02, 0.018, 0.016), 40000));
  ToolSettings settings;
  constexpr double point_spacing_m = 1.45e-3;
  settings.parameters["point_spacing_m"] = point_spacing_m;
  const auto object = contacts::ellipsoid_mesh(Vec3(0, 0, -0.05), Vec3(0.05, 0.05, 0.05), 100000);
  const auto renderer = tool_renderers::make_tool_renderer("voxmap-pointshell", tool, object, settings);
  run(state, *renderer, {Vec3(0, 0, 0.046), Quat::Identity()});
  state.counters["points"] = double(tool::make_point_shell(tool.mesh_T, point_spacing_m).size());
}
BENCHMARK(BM_VoxmapPointshell)->Unit(benchmark::kMillisecond);

void BM_GodObjectBallOnBall(benchmark::State& state) {
  const Tool tool = solid(contacts::ellipsoid_mesh(Vec3(0, 0, -0.03), Vec3(0.02, 0.018, 0.016), 10000));
  const auto object = contacts::ellipsoid_mesh(Vec3(0, 0, -0.05), Vec3(0.05, 0.05, 0.05), 10000);
  const auto renderer = tool_renderers::make_tool_renderer("god-object-tool", tool, object, {});
  run(state, *renderer, {Vec3(0, 0, 0.046), Quat::Identity()});
}
BENCHMARK(BM_GodObjectBallOnBall)->Unit(benchmark::kMillisecond);

// Hundreds of candidate pairs: the finely divided faces of a cube and a slab.
void BM_GodObjectBoxOnSlab(benchmark::State& state) {
  const Tool tool = solid(contacts::box_mesh(Vec3(-0.01, -0.01, -0.03), Vec3(0.01, 0.01, -0.01), 29));
  const auto object = contacts::box_mesh(Vec3(-0.04, -0.04, -0.02), Vec3(0.04, 0.04, 0.0), 29);
  const auto renderer = tool_renderers::make_tool_renderer("god-object-tool", tool, object, {});
  run(state, *renderer, {Vec3(0, 0, 0.03), Quat::Identity()});
}
BENCHMARK(BM_GodObjectBoxOnSlab)->Unit(benchmark::kMillisecond);

// A ball of 10,000 triangles on a ring of ten balls, together as many: ten places at which it nearly touches.
void BM_GodObjectTenContacts(benchmark::State& state) {
  constexpr double ring_m = 0.012, ball_m = 0.004, tool_m = 0.014;
  TriangleMesh ring;
  for (int k = 0; k < 10; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 10.0;
    const TriangleMesh ball = contacts::ellipsoid_mesh(
        Vec3(ring_m * std::cos(angle), ring_m * std::sin(angle), -ball_m), Vec3::Constant(ball_m), 1000);
    ring = k == 0 ? ball : contacts::joined(ring, ball);
  }
  const Tool tool = solid(contacts::ellipsoid_mesh(Vec3::Zero(), Vec3::Constant(tool_m), 10000));
  const auto renderer = tool_renderers::make_tool_renderer("god-object-tool", tool, ring, {});
  const double height = std::sqrt((tool_m + ball_m) * (tool_m + ball_m) - ring_m * ring_m) - ball_m;
  constexpr double share_set_aside = 0.1;  // of the other runs: it stays in the ring
  run(state, *renderer, {Vec3(0, 0, height), Quat::Identity()}, share_set_aside);
}
BENCHMARK(BM_GodObjectTenContacts)->Unit(benchmark::kMillisecond);

void BM_PenaltyBallOnBall(benchmark::State& state) {
  const Tool tool = solid(contacts::ellipsoid_mesh(Vec3(0, 0, -0.03), Vec3(0.02, 0.018, 0.016), 10000));
  const auto object = contacts::ellipsoid_mesh(Vec3(0, 0, -0.05), Vec3(0.05, 0.05, 0.05), 10000);
  const auto renderer = tool_renderers::make_tool_renderer("penalty-coupling", tool, object, {});
  run(state, *renderer, {Vec3(0, 0, 0.046), Quat::Identity()});
}
BENCHMARK(BM_PenaltyBallOnBall)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace touchstone::bench
