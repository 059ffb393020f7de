// How fast recordings are read, checked and written, in values (numbers) per second, per format; and the largest memory
// in use while a long one streams through.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "harness/recording/column.h"
#include "harness/recording/recording_file.h"
#include "harness/recording/recording_stream.h"
#include "harness/recording/recording_writer.h"

namespace touchstone::bench {
using recording::SampleBlock;

namespace {

constexpr std::int64_t columns = 7;  // t, x, y, z, fx, fy, fz

std::filesystem::path scratch(const std::string& name) { return std::filesystem::temp_directory_path() / name; }

// A 1 kHz scan; `digits` as a sensor gives them (positions to 0.1 um, forces to 1 mN), or all 17.
void write_scan(const std::filesystem::path& file, std::int64_t samples, bool full_precision) {
  const auto rounded = [&](double value, double step) {
    return full_precision ? value : std::round(value / step) * step;
  };
  recording::RecordingWriter writer(file, {recording::ColumnGroup::force});
  SampleBlock block;
  for (std::int64_t i = 0; i < samples; ++i) {
    const double t_s = static_cast<double>(i) / 1000.0;
    block.motion.t_s.push_back(t_s);
    block.motion.p_W_m.emplace_back(rounded(0.05 * std::sin(t_s), 1e-7), rounded(0.05 * std::cos(0.7 * t_s), 1e-7),
                                    rounded(1e-3 * std::sin(3.0 * t_s), 1e-7));
    block.f_W_N.emplace_back(rounded(std::sin(5.0 * t_s), 1e-3), rounded(std::cos(5.0 * t_s), 1e-3),
                             rounded(2.0 + std::sin(7.0 * t_s), 1e-3));
    if (block.size() < 8192 && i + 1 < samples) continue;
    writer.append(block);
    block.clear();
  }
  writer.commit();
}

void count(benchmark::State& state, const std::filesystem::path& file, std::int64_t samples) {
  state.SetItemsProcessed(state.iterations() * samples * columns);
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(std::filesystem::file_size(file)));
  state.SetLabel("items are values");
}

void read(benchmark::State& state, const std::string& extension, bool full_precision) {
  const std::int64_t samples = 200000;
  const auto file = scratch("touchstone-bench-read" + extension);
  write_scan(file, samples, full_precision);
  for (auto _ : state) {
    auto stream = recording::RecordingStream::open(file, {.need_force = true});
    SampleBlock block;
    while (stream.next(block)) benchmark::DoNotOptimize(block.f_W_N.data());
  }
  count(state, file, samples);
  std::filesystem::remove(file);
}
BENCHMARK_CAPTURE(read, csv_as_sensors_give, std::string(".csv"), false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read, csv_full_precision, std::string(".csv"), true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read, csv_gz_full_precision, std::string(".csv.gz"), true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read, hdf5_full_precision, std::string(".h5"), true)->Unit(benchmark::kMillisecond);

void load_whole(benchmark::State& state, const std::string& extension) {
  const std::int64_t samples = 200000;
  const auto file = scratch("touchstone-bench-load" + extension);
  write_scan(file, samples, true);
  for (auto _ : state) benchmark::DoNotOptimize(recording::load_recording(file).size());
  count(state, file, samples);
  std::filesystem::remove(file);
}
BENCHMARK_CAPTURE(load_whole, csv, std::string(".csv"))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(load_whole, hdf5, std::string(".h5"))->Unit(benchmark::kMillisecond);

void write(benchmark::State& state, const std::string& extension) {
  const std::int64_t samples = 100000;
  const auto file = scratch("touchstone-bench-write" + extension);
  for (auto _ : state) write_scan(file, samples, true);
  count(state, file, samples);
  std::filesystem::remove(file);
}
BENCHMARK_CAPTURE(write, csv, std::string(".csv"))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(write, hdf5, std::string(".h5"))->Unit(benchmark::kMillisecond);

// 10,000,000 samples through the reader: the counter is the growth of the process's largest resident size.
void stream_ten_million(benchmark::State& state, const std::string& extension) {
  const std::int64_t samples = 10'000'000;
  const auto file = scratch("touchstone-bench-long" + extension);
  write_scan(file, samples, false);
  const auto largest_MB = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
  };
  const double before = largest_MB();
  for (auto _ : state) {
    auto stream = recording::RecordingStream::open(file, {.need_force = true});
    SampleBlock block;
    while (stream.next(block)) benchmark::DoNotOptimize(block.f_W_N.data());
    if (stream.samples() != 10'000'000) state.SkipWithError("samples were lost");
  }
  state.counters["growth_MB"] = largest_MB() - before;
  state.counters["largest_MB"] = largest_MB();
  count(state, file, samples);
  std::filesystem::remove(file);
}
BENCHMARK_CAPTURE(stream_ten_million, csv, std::string(".csv"))->Unit(benchmark::kSecond)->Iterations(1);
BENCHMARK_CAPTURE(stream_ten_million, hdf5, std::string(".h5"))->Unit(benchmark::kSecond)->Iterations(1);

}  // namespace
}  // namespace touchstone::bench
