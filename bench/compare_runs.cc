// Two revisions' Google Benchmark results, run in turn, compared benchmark by benchmark.
//   compare_runs OUT.json BEFORE1.json AFTER1.json BEFORE2.json AFTER2.json ...
// Prints a table; OUT.json has the same as numbers. Exit status 0; 3 for files that cannot be used.
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/paired.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/json_reader.h"
#include "harness/stats/quantile.h"

namespace touchstone::bench {
namespace {

constexpr double confidence = 0.95;

struct Series {
  std::vector<double> before_ns;
  std::vector<double> after_ns;
};

double in_ns(const nlohmann::json& run) {
  static const std::map<std::string, double> units{{"ns", 1.0}, {"us", 1e3}, {"ms", 1e6}, {"s", 1e9}};
  // What keeps its own time (a whole program's) has it as its real time.
  const bool own = run.at("name").get<std::string>().find("/manual_time") != std::string::npos;
  return run.at(own ? "real_time" : "cpu_time").get<double>() * units.at(run.at("time_unit").get<std::string>());
}

void read(const std::string& file, bool after, std::map<std::string, Series>& series) {
  const nlohmann::json document = load_json(file);
  try {
    for (const auto& run : document.at("benchmarks")) {
      if (run.value("run_type", "iteration") != "iteration" || run.value("error_occurred", false)) continue;
      Series& one = series[run.at("name").get<std::string>()];
      (after ? one.after_ns : one.before_ns).push_back(in_ns(run));
    }
  } catch (const std::exception& error) {
    throw BadData(fmt::format("{}: is no result of Google Benchmark: {}", file, error.what()));
  }
}

int run(const std::vector<std::string>& words) {
  if (words.size() < 3 || words.size() % 2 == 0)
    throw UsageError("compare_runs OUT.json BEFORE1.json AFTER1.json BEFORE2.json AFTER2.json ...");
  std::map<std::string, Series> series;
  for (std::size_t i = 1; i < words.size(); ++i) read(words[i], i % 2 == 0, series);
  nlohmann::json out{{"schema", "touchstone-bench-compare/1"}, {"confidence", confidence}};
  out["benchmarks"] = nlohmann::json::array();
  fmt::print("{:<60} {:>12} {:>12} {:>8} {:>18} {:>8}\n", "benchmark", "before", "after", "ratio", "95 % interval",
             "p");
  for (const auto& [name, one] : series) {
    if (one.before_ns.size() != one.after_ns.size() || one.before_ns.empty()) {
      fmt::print("{:<60} only one of the two revisions has it\n", name);
      continue;
    }
    const auto found = compare_paired(one.before_ns, one.after_ns, confidence);
    const double before_ns = stats::upper_median(one.before_ns);
    const double after_ns = stats::upper_median(one.after_ns);
    fmt::print("{:<60} {:>9.4g} ns {:>9.4g} ns {:>8.3f} {:>8.3f} - {:<7.3f} {:>8.2g}\n", name, before_ns, after_ns,
               found.ratio, found.low, found.high, found.p);
    // JSON has no infinity: an interval that so few pairs cannot give is absent.
    nlohmann::json interval = nullptr;
    if (found.low > 0.0) interval = {found.low, found.high};
    out["benchmarks"].push_back({{"name", name},
                                 {"pairs", found.pairs},
                                 {"before_ns", before_ns},
                                 {"after_ns", after_ns},
                                 {"ratio", found.ratio},
                                 {"interval", interval},
                                 {"p", found.p}});
  }
  write_file(words[0], out.dump(1) + "\n");
  return 0;
}

}  // namespace
}  // namespace touchstone::bench

int main(int argc, char** argv) {
  try {
    return touchstone::bench::run({argv + 1, argv + argc});
  } catch (const touchstone::Error& error) {
    fmt::print(stderr, "compare_runs: {}\n", error.what());
    return static_cast<int>(error.status());
  }
}
