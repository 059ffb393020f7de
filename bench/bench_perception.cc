// Cost of the perceptual evaluation: conditions of 60,000 samples (a minute at 1 kHz), all steps. The demand is 1,000
// of them in 10 s on two cores with less than 1 GB; peak memory is printed as a counter.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <cmath>
#include <numbers>

#include "harness/base/freed_memory.h"
#include "harness/base/random.h"
#include "harness/perception/judge/judged_conditions.h"
#include "harness/perception/perceptual_evaluation.h"

namespace {

namespace pc = touchstone::perception;

constexpr std::size_t sample_count = 60000;

pc::PressSignal presses(double k, std::uint64_t seed) {
  pc::PressSignal signal;
  signal.name = "presses";
  touchstone::Random random(seed);
  signal.t_s.reserve(sample_count);
  signal.force_N.reserve(sample_count);
  signal.displacement_m.reserve(sample_count);
  for (std::size_t n = 0; n < sample_count; ++n) {
    const double t = 0.001 * static_cast<double>(n);
    const double depth = 0.005 * (1.0 - std::cos(2.0 * std::numbers::pi * t));
    signal.t_s.push_back(t);
    signal.displacement_m.push_back(depth);
    signal.force_N.push_back(k * depth + 0.01 * random.uniform(-1.0, 1.0));
  }
  return signal;
}

void evaluate(benchmark::State& state) {
  touchstone::keep_freed_memory();  // as the program does
  const auto count = static_cast<std::size_t>(state.range(0));
  const std::vector<pc::PressSignal> real{presses(500.0, 0)};
  // What a source costs (reading a file) is not what is measured: a few signals serve all conditions.
  std::vector<pc::PressSignal> pool;
  pool.reserve(8);
  for (std::uint64_t i = 0; i < 8; ++i) pool.push_back(presses(400.0 + 25.0 * static_cast<double>(i), i + 1));
  std::vector<pc::ConditionSource> conditions;
  conditions.reserve(count);
  for (std::size_t c = 0; c < count; ++c) {
    conditions.push_back(
        {std::to_string(c), [&pool, c] { return std::vector<pc::PressSignal>{pool[c % pool.size()]}; }});
  }
  for (auto _ : state) benchmark::DoNotOptimize(pc::evaluate(real, conditions, {}).conditions.front().distance);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  state.counters["peak_MB"] = static_cast<double>(usage.ru_maxrss) / 1024.0;
  state.counters["conditions_per_s"] =
      benchmark::Counter(static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate);
}

// The judge, from recordings in memory to the verdict.
void judge(benchmark::State& state) {
  touchstone::keep_freed_memory();
  const auto count = static_cast<std::size_t>(state.range(0));
  std::vector<touchstone::recording::Recording> pool;
  for (std::uint64_t i = 0; i < 9; ++i) {
    const auto signal = presses(400.0 + 25.0 * static_cast<double>(i), i);
    touchstone::recording::Recording recording;
    recording.source = "presses";
    recording.motion.t_s = signal.t_s;
    for (std::size_t n = 0; n < sample_count; ++n) {
      recording.motion.p_W_m.emplace_back(0.0, 0.0, -signal.displacement_m[n]);
      recording.f_W_N.emplace_back(0.0, 0.0, signal.force_N[n]);
    }
    pool.push_back(std::move(recording));
  }
  std::vector<pc::RecordingSource> conditions;
  for (std::size_t c = 0; c < count; ++c)
    conditions.push_back({std::to_string(c), [&pool, c] { return pool[1 + c % 8]; }});
  for (auto _ : state) {
    const auto judged = pc::judge_conditions(pool[0], {}, conditions, touchstone::Vec3::UnitZ(), {});
    benchmark::DoNotOptimize(judged.conditions.front().judgement.d_prime);
  }
  state.counters["conditions_per_s"] =
      benchmark::Counter(static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate);
}

BENCHMARK(judge)
    ->Name("perceive/judge_60000_samples")
    ->Arg(100)
    ->Arg(1000)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

BENCHMARK(evaluate)
    ->Name("perceive/60000_samples")
    ->Arg(10)
    ->Arg(100)
    ->Arg(1000)
    ->Unit(benchmark::kSecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime();

}  // namespace
