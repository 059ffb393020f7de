#include "harness/golden/check_tally.h"

#include <fmt/format.h>

#include <filesystem>

#include "harness/golden/felt_verdict.h"

namespace touchstone::golden {
namespace {

report::CheckedTest for_others(const GoldenCase& golden, const std::string& model, const CheckResult& result, bool good,
                               double seconds) {
  report::CheckedTest test{golden.name,  model, good, seconds, std::string(to_string(result.comparison.verdict)),
                           result.table, {},    {}};
  if (good) return test;
  if (result.drift_fails && passes(result.comparison.verdict)) test.verdict = "drift, asked to fail";
  test.file = std::filesystem::path(golden.folder / "case.json").lexically_proximate(std::filesystem::current_path());
  for (const char* const name : {"golden.png", "obtained.png", "difference.png"}) {
    if (!result.left_in.empty() && std::filesystem::exists(result.left_in / name))
      test.pictures.push_back(result.left_in / name);
  }
  return test;
}

}  // namespace

std::string CheckTally::add(const GoldenCase& golden, const std::string& model, const CheckResult& result,
                            double seconds, const FeltTolerance& felt) {
  if (!result.skipped.empty()) {
    ++skipped_;
    tests_.push_back({golden.name, model, false, 0.0, "", "", golden.folder / "case.json", {}, result.skipped});
    return fmt::format("skipped  {} {}: {}\n", golden.name, model, result.skipped);
  }
  const Comparison& comparison = result.comparison;
  const bool drift = comparison.drift > 0;
  const bool good = result.passed();
  drifted_ += drift ? 1 : 0;
  ++(good ? passed_ : failed_);
  tests_.push_back(for_others(golden, model, result, good, seconds));
  std::string text = result.felt ? fmt::format("{:<8} {} {}: {}\n", good ? "felt" : "noticed", golden.name, model,
                                               to_sentence(*result.felt, felt))
                     : comparison.expected_rows == 0
                         ? fmt::format("{:<8} {} {}: there is no golden to compare with yet\n",
                                       to_string(comparison.verdict), golden.name, model)
                         : fmt::format("{:<8} {} {}: uses {:.3g}% of the tolerance, bits differ in {} of {} rows{}\n",
                                       to_string(comparison.verdict), golden.name, model,
                                       100.0 * comparison.tolerance_used(), comparison.drift, comparison.expected_rows,
                                       result.drift_fails ? " (drift, asked to fail)" : "");
  if (!good) text += fmt::format("{}  left in {}\n", result.table, result.left_in.string());
  return text;
}

std::string CheckTally::add_unusable(const std::string& group, const std::string& model,
                                     const std::filesystem::path& folder, const std::string& why) {
  ++unusable_;
  const auto file = std::filesystem::exists(folder / "case.json") ? folder / "case.json" : folder;
  const auto place = file.lexically_proximate(std::filesystem::current_path());
  tests_.push_back({group, model, false, 0.0, "cannot be run", why, place, {}, {}});
  return fmt::format("unusable {} {}: {}: {}\n", group, model, place.string(), why);
}

std::string CheckTally::counts_text() const {
  return fmt::format("{} passed, {} failed, {} drifted{}{}\n", passed_, failed_, drifted_,
                     skipped_ > 0 ? fmt::format(", {} skipped", skipped_) : "",
                     unusable_ > 0 ? fmt::format(", {} could not be run", unusable_) : "");
}

}  // namespace touchstone::golden
