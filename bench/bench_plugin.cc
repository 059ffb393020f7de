// What the plug-in interface adds to a step: the same renderer in the program, through the interface in process, and in
// a child process.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>

#include "harness/plugin/plugin.h"
#include "harness/surface/embree_surface.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/catalogue.h"

namespace touchstone::bench {
namespace {

std::unique_ptr<rendering::Renderer> make(const std::string& suffix, bool in_process) {
  plugin::Plugins plugins;
  if (!suffix.empty()) {
    plugin::PluginOptions options;
    options.in_process = in_process;
    options.host = TOUCHSTONE_PLUGIN_HOST;
    plugins.load(TOUCHSTONE_TWIN_PLUGIN, options, {});
  }
  rendering::Model model;
  model.renderer = "spring-linear" + suffix;
  model.source = "bench";
  plugins.provide(model);
  return renderers::make_renderer(model, make_embree_surface(testing::ball(0.02, 4)));
}

void steps(benchmark::State& state, rendering::Renderer& renderer) {
  renderer.reset();
  double t_s = 0.0;
  for (auto _ : state) {
    t_s += 1e-3;
    benchmark::DoNotOptimize(renderer.step({t_s, {0.001, 0.002, 0.02 + 1e-3 * std::sin(t_s)}, Quat::Identity()}));
  }
}

void in_the_program(benchmark::State& state) { steps(state, *make("", true)); }
void plugin_in_process(benchmark::State& state) { steps(state, *make("-twin", true)); }
void plugin_in_child(benchmark::State& state) { steps(state, *make("-twin", false)); }
void make_in_child(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(make("-twin", false));
}

BENCHMARK(in_the_program);
BENCHMARK(plugin_in_process);
BENCHMARK(plugin_in_child)->UseRealTime();
BENCHMARK(make_in_child)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace touchstone::bench
