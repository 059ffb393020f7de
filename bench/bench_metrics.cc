// What one sample costs in each metric of the catalogue, and in all of them together.
#include <benchmark/benchmark.h>

#include <cmath>

#include "harness/metrics/catalogue.h"

namespace touchstone::bench {
using metrics::MetricSample;

namespace {

constexpr std::size_t samples = 10000;

std::vector<MetricSample> ten_seconds() {
  std::vector<MetricSample> all(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    MetricSample& sample = all[i];
    sample.t_s = static_cast<double>(i) * 1e-3;
    const double press_N = std::max(0.0, 2.0 * std::sin(6.0 * sample.t_s));
    sample.f_measured_W_N = {0.1 * press_N, 0.0, press_N};
    sample.f_rendered_W_N = {0.0, 0.0, 0.95 * press_N};
    sample.out_W_m = {0.02 * std::cos(sample.t_s), 0.02 * std::sin(sample.t_s), 0.0};
    sample.contact_W_m = sample.out_W_m + Vec3(1e-5, 0.0, 0.0);
    sample.cost_us = 0.1 + 0.01 * std::sin(static_cast<double>(i));
  }
  return all;
}

void feed(benchmark::State& state, const std::vector<std::string>& names) {
  const auto all = ten_seconds();
  for (auto _ : state) {
    metrics::MetricSet set(names, {}, {});
    for (const MetricSample& sample : all) set.add(sample);
    benchmark::DoNotOptimize(set.results());
  }
  state.counters["per_sample"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(samples),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

const bool registered = [] {
  benchmark::RegisterBenchmark("all", [](benchmark::State& state) { feed(state, {}); })->Unit(benchmark::kMillisecond);
  for (const metrics::MetricEntry& entry : metrics::metric_catalogue()) {
    benchmark::RegisterBenchmark(entry.name.c_str(), [name = entry.name](benchmark::State& state) {
      feed(state, {name});
    })->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace
}  // namespace touchstone::bench
