#include "harness/rendering/operations.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "harness/base/error.h"

namespace touchstone::rendering {
namespace {

// The value at that rank (from 0) of all steps.
std::uint64_t at_rank(const std::map<std::uint64_t, std::uint64_t>& steps_with, std::uint64_t rank) {
  std::uint64_t seen = 0;
  for (const auto& [operations, steps] : steps_with) {
    seen += steps;
    if (seen > rank) return operations;
  }
  return 0;
}

}  // namespace

OperationReport count_operations(Renderer& counted, const TipSource& source) {
  OperationReport report;
  std::map<std::uint64_t, std::uint64_t> steps_with;  // few distinct numbers however many steps
  counted.reset();
  TipState tip;
  while (source(tip)) {
    const OperationCounts before = operations_on_this_thread();
    const StepResult result = counted.step(tip);
    const OperationCounts here = operations_on_this_thread() - before;
    if (result.status == StepStatus::refused || !result.f_W_N.allFinite()) {
      throw BadData(
          fmt::format("sample {} (t = {} s): the renderer refused it or answered with a number that is not "
                      "finite",
                      report.steps, tip.t_s));
    }
    report.counts += here;
    ++steps_with[here.total()];
    ++report.steps;
  }
  if (report.steps == 0) return report;
  report.mean = static_cast<double>(report.total()) / static_cast<double>(report.steps);
  report.median =
      0.5 * static_cast<double>(at_rank(steps_with, (report.steps - 1) / 2) + at_rank(steps_with, report.steps / 2));
  report.max = steps_with.rbegin()->first;
  return report;
}

std::string operations_to_json(const OperationReport& report) {
  const OperationCounts& n = report.counts;
  return nlohmann::ordered_json{{"total", report.total()},
                                {"mean", report.mean},
                                {"median", report.median},
                                {"max", report.max},
                                {"add", n.add},
                                {"multiply", n.multiply},
                                {"divide", n.divide},
                                {"square_root", n.square_root},
                                {"compare", n.compare},
                                {"not_counted", report.not_counted},
                                {"searches", how_searches_are_counted}}
      .dump();
}

}  // namespace touchstone::rendering
