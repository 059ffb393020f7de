#include "harness/report/history.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <span>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/json_reader.h"

namespace touchstone {
namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

double mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double noise_of(const std::vector<double>& values) {
  std::vector<double> differences;
  double largest = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    largest = std::max(largest, std::abs(values[i]));
    if (i > 0) differences.push_back(std::abs(values[i] - values[i - 1]));
  }
  // 1.4826: the median absolute deviation of a normal in standard deviations; sqrt(2): a difference of two.
  constexpr double rounding = 1e-12;
  return std::max(1.4826 * median(differences) / std::sqrt(2.0), rounding * largest);
}

void split(const std::vector<double>& values, std::size_t first, std::size_t last, double noise,
           std::vector<Step>& steps) {
  const std::size_t count = last - first;
  const double penalty = 3.0 * std::log(static_cast<double>(values.size()));
  Step best{0, 0.0, 0.0, 0.0};
  for (std::size_t at = first + 1; at < last; ++at) {
    const double before = mean(std::span(values).subspan(first, at - first));
    const double after = mean(std::span(values).subspan(at, last - at));
    const double error =
        noise * std::sqrt(1.0 / static_cast<double>(at - first) + 1.0 / static_cast<double>(last - at));
    const double score = error > 0.0 ? std::abs(after - before) / error : 0.0;
    if (score > best.score) best = {at, before, after, score};
  }
  if (count < 2 || !(best.score * best.score > penalty)) return;
  split(values, first, best.index, noise, steps);
  steps.push_back(best);
  split(values, best.index, last, noise, steps);
}

}  // namespace

History load_history(const std::filesystem::path& file, std::string_view metric, std::string_view test) {
  std::ifstream in(file);
  if (!in) throw BadData(fmt::format("{}: cannot be opened for reading", file.string()));
  History history;
  std::size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::string place = fmt::format("{}: line {}", file.string(), number);
    const nlohmann::json document = parse_json(line, place);
    JsonObject object(document, place, "");
    const auto of_test = object.optional_text("test");
    HistoryPoint point{object.text("commit"), object.optional_text("time").value_or(""), object.number("value")};
    const bool wanted = object.text("metric") == metric && (test.empty() || of_test == test);
    object.finish();
    if (wanted) history.push_back(std::move(point));
  }
  return history;
}

void append_history(const std::filesystem::path& file, const HistoryPoint& point, std::string_view metric,
                    std::string_view test) {
  if (!std::isfinite(point.value))
    throw BadData(fmt::format("{} of {} is {}: not recorded", metric, point.commit, point.value));
  nlohmann::json line{{"commit", point.commit}, {"metric", metric}, {"value", point.value}};
  if (!test.empty()) line["test"] = test;
  if (!point.time.empty()) line["time"] = point.time;
  const std::string before = std::filesystem::exists(file) ? read_file(file) : std::string();
  write_file(file, before + (before.empty() || before.ends_with('\n') ? "" : "\n") + line.dump() + "\n");
}

std::vector<Step> find_steps(const std::vector<double>& values) {
  std::vector<Step> steps;
  if (values.size() < 3) return steps;
  split(values, 0, values.size(), noise_of(values), steps);
  return steps;
}

std::vector<std::string> broken_gates(const History& history, const HistoryGate& gate) {
  if (history.empty()) return {"there is no value to hold against a threshold"};
  std::vector<std::string> broken;
  const HistoryPoint& newest = history.back();
  if (gate.maximum && !(newest.value <= *gate.maximum)) {
    broken.push_back(fmt::format("{}: {:.6g} is above {:.6g}", newest.commit, newest.value, *gate.maximum));
  }
  if (gate.minimum && !(newest.value >= *gate.minimum)) {
    broken.push_back(fmt::format("{}: {:.6g} is below {:.6g}", newest.commit, newest.value, *gate.minimum));
  }
  if (gate.most_rise && history.size() == 1) broken.push_back("there is no earlier value to rise from");
  if (gate.most_rise && history.size() > 1) {
    std::vector<double> earlier;
    for (const auto& point : std::span(history).first(history.size() - 1)) earlier.push_back(point.value);
    const double usual = median(earlier);
    if (!(newest.value - usual <= *gate.most_rise * std::abs(usual))) {
      broken.push_back(fmt::format("{}: {:.6g} is more than {:.3g} % above {:.6g}, the median before", newest.commit,
                                   newest.value, 100.0 * *gate.most_rise, usual));
    }
  }
  return broken;
}

}  // namespace touchstone
