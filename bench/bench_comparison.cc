// Comparing a result of 60,000 rows with its golden: from columns in memory, and from HDF5 and text files as
// `touchstone compare` does it (without the start of the program; bench/compare-peers has the whole beside its peers).
#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>

#include "harness/golden/comparison/column_file.h"
#include "harness/golden/comparison/compare.h"
#include "harness/golden/golden_file.h"

namespace touchstone::bench {
namespace {

constexpr std::size_t rows = 60000;

// A minute at 1 kHz; `offset_N` is what the second of two differs by.
recording::RenderedTrajectory minute(double offset_N) {
  recording::RenderedTrajectory rendered;
  for (std::size_t i = 0; i < rows; ++i) {
    const double t_s = static_cast<double>(i) * 1e-3;
    const double depth_m = 1e-3 * std::sin(6.0 * t_s);
    const Vec3 tip(0.02 * std::cos(t_s), 0.02 * std::sin(t_s), -depth_m);
    const bool touching = depth_m > 0.0;
    rendered.t_s.push_back(t_s);
    rendered.tip_W_m.push_back(tip);
    rendered.contact_W_m.emplace_back(tip.x(), tip.y(), touching ? 0.0 : tip.z());
    rendered.f_W_N.emplace_back(0.0, 0.0, touching ? 500.0 * depth_m + offset_N : 0.0);
    rendered.contact.push_back(touching ? 1 : 0);
  }
  return rendered;
}

golden::Tolerance tolerance() {
  golden::Tolerance tolerance;
  tolerance.reason = "benchmark";
  return tolerance;
}

void per_row(benchmark::State& state) { state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(rows)); }

void in_memory(benchmark::State& state) {
  const golden::TrajectoryColumns golden = golden::columns_of(minute(0.0), "golden");
  const golden::TrajectoryColumns obtained = golden::columns_of(minute(1e-9), "obtained");
  for (auto _ : state) benchmark::DoNotOptimize(compare(golden, obtained, tolerance()));
  per_row(state);
}

void from_files(benchmark::State& state) {
  const auto folder = std::filesystem::temp_directory_path();
  const auto golden = folder / "touchstone-bench-golden.h5";
  const auto obtained = folder / "touchstone-bench-obtained.h5";
  golden::write_golden(golden, minute(0.0), golden::build_provenance());
  golden::write_golden(obtained, minute(1e-9), golden::build_provenance());
  for (auto _ : state)
    benchmark::DoNotOptimize([&] {
      const auto [a, b] = golden::load_columns(golden, obtained);
      return compare(a, b, tolerance());
    }());
  per_row(state);
  std::filesystem::remove(golden);
  std::filesystem::remove(obtained);
}

BENCHMARK(in_memory)->Unit(benchmark::kMillisecond);
BENCHMARK(from_files)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace touchstone::bench
