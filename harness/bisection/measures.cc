#include "harness/bisection/measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/bisection/logged_program.h"
#include "harness/golden/comparison/column_file.h"
#include "harness/golden/comparison/comparison_report.h"
#include "harness/golden/comparison/error_regimes.h"

namespace touchstone::bisection {
namespace {

namespace fs = std::filesystem;

// What is measured of a replay, by the word that --metric gives.
enum class MetricKind { operations, time, comparison };

MetricKind kind_of(const std::string& metric) {
  if (metric == "operations") return MetricKind::operations;
  return metric == "time" ? MetricKind::time : MetricKind::comparison;
}

class Replayer {
 public:
  explicit Replayer(const ReplayMeasure& request) : request_(request), kind_(kind_of(request.metric)) {
    for (const fs::path& needed : {file("mesh.obj"), file("trajectory.csv"), file(request_.model + ".json")}) {
      if (!fs::exists(needed))
        throw UsageError(
            fmt::format("{}: is needed in the reference; `touchstone golden export` writes it", needed.string()));
    }
    for (const char* const extension : {".h5", ".golden.csv"}) {
      if (golden_.empty() && fs::exists(file(request_.model + extension))) golden_ = file(request_.model + extension);
    }
  }

  std::optional<double> measure(const BuiltCommit& built, const std::atomic<bool>& stop) {
    const fs::path program = request_.plugin.empty() ? built.build / request_.program : request_.self;
    if (!fs::exists(program)) return std::nullopt;
    // One measures at a time: two would slow one another, and the HDF5 library is not for several threads.
    const std::lock_guard lock(mutex_);
    if (kind_ == MetricKind::time) return relative_time(built, program, stop);
    if (kind_ == MetricKind::operations) return operations(built, program, stop);
    const fs::path rendered = built.work / "rendered.csv";
    if (!replay(built, program, rendered, {}, stop)) return std::nullopt;
    if (golden_.empty()) {
      golden_ = request_.out / "good-rendered.csv";
      if (!fs::exists(golden_)) fs::copy_file(rendered, golden_);
    }
    return compared(rendered);
  }

 private:
  [[nodiscard]] fs::path file(const std::string& name) const { return request_.reference / name; }

  bool replay(const BuiltCommit& built, const fs::path& program, const fs::path& rendered, const fs::path& timing,
              const std::atomic<bool>& stop) const {
    OtherProgram command = logged_program(built.log, stop);
    command.words = {program.string(), "replay",
                     "--model",        file(request_.model + ".json").string(),
                     "--mesh",         file("mesh.obj").string(),
                     "--trajectory",   file("trajectory.csv").string(),
                     "--out",          rendered.string()};
    if (!request_.plugin.empty()) {
      command.words.push_back("--plugin");
      command.words.push_back((built.build / request_.plugin).string());
    }
    if (!timing.empty()) {
      command.words.push_back("--timing");
      command.words.push_back(timing.string());
    }
    command.environment = built.environment;
    return succeeds(command) && fs::exists(rendered);
  }

  [[nodiscard]] std::optional<double> compared(const fs::path& rendered) const {
    const auto [expected, obtained] = golden::load_columns(golden_, rendered);
    const auto metrics = metrics_of(compare(expected, obtained, golden::default_tolerance()));
    const auto found = std::ranges::find(metrics, request_.metric, &std::pair<std::string, double>::first);
    if (found != metrics.end()) return found->second;
    std::string known = "operations, time";
    for (const auto& [name, value] : metrics) known += ", " + name;
    throw UsageError(fmt::format("--metric {}: unknown; this case has {}", request_.metric, known));
  }

  std::optional<nlohmann::json> timing_of(const BuiltCommit& built, const fs::path& program,
                                          const std::atomic<bool>& stop) const {
    const fs::path timing = built.work / "timing.json";
    if (!replay(built, program, built.work / "rendered.csv", timing, stop)) return std::nullopt;
    auto json = nlohmann::json::parse(read_file(timing), nullptr, false);
    if (!json.is_object()) return std::nullopt;
    return json;
  }

  // Another commit's program wrote it: its fields may have been other ones.
  static std::optional<double> number_at(const nlohmann::json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
  }

  std::optional<double> operations(const BuiltCommit& built, const fs::path& program,
                                   const std::atomic<bool>& stop) const {
    const auto json = timing_of(built, program, stop);
    if (!json || !json->contains("operations")) return std::nullopt;
    const auto& counted = (*json)["operations"];
    if (counted.is_number()) return counted.get<double>();
    if (counted.is_object()) return number_at(counted, "mean");
    return std::nullopt;
  }

  std::optional<double> relative_time(const BuiltCommit& built, const fs::path& program,
                                      const std::atomic<bool>& stop) {
    const fs::path kept = request_.out / "good-program";
    if (!fs::exists(kept)) {
      fs::create_directories(kept);
      fs::copy_file(program, kept / program.filename());
    }
    const auto own = timing_of(built, program, stop);
    const auto good = timing_of(built, request_.plugin.empty() ? kept / program.filename() : program, stop);
    if (!own || !good) return std::nullopt;
    const auto own_us = number_at(*own, "mean_us");
    const auto good_us = number_at(*good, "mean_us");
    if (!own_us || !good_us || !(*good_us > 0.0)) return std::nullopt;
    return *own_us / *good_us;
  }

  ReplayMeasure request_;
  MetricKind kind_;
  fs::path golden_;
  std::mutex mutex_;
};

}  // namespace

std::string where_it_differs(const ReplayMeasure& request, const std::string& commit) {
  if (kind_of(request.metric) != MetricKind::comparison) return "";
  const fs::path rendered = request.out / "commits" / commit.substr(0, 10) / "rendered.csv";
  for (const fs::path& golden :
       {request.reference / (request.model + ".h5"), request.reference / (request.model + ".golden.csv"),
        request.out / "good-rendered.csv"}) {
    if (!fs::exists(golden) || !fs::exists(rendered)) continue;
    const auto [expected, obtained] = golden::load_columns(golden, rendered);
    return to_table(locate_error(expected, obtained));
  }
  return "";
}

Measure replay_measure(const ReplayMeasure& request) {
  if (kind_of(request.metric) == MetricKind::time && !request.plugin.empty())
    throw UsageError("--metric time: of a plug-in, measure it by a command of its own (--measure)");
  const auto replayer = std::make_shared<Replayer>(request);
  return [replayer](const BuiltCommit& built, const std::atomic<bool>& stop) { return replayer->measure(built, stop); };
}

Measure command_measure(const std::string& command) {
  return [command](const BuiltCommit& built, const std::atomic<bool>& stop) -> std::optional<double> {
    const fs::path out = built.work / "measured.txt";
    OtherProgram child = shell_command(command, built, stop);
    child.out_file = out;
    if (!succeeds(child)) return std::nullopt;
    std::string text = read_file(out);
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ' || text.back() == '\r')) text.pop_back();
    text = text.substr(text.find_last_of("\n ") == std::string::npos ? 0 : text.find_last_of("\n ") + 1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
      throw UsageError(fmt::format("--measure: the last word that it prints is '{}'; a number was expected", text));
    return value;
  };
}

}  // namespace touchstone::bisection
