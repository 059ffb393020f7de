// A metric over commits: read from a local file of lines, judged against thresholds, and searched for steps.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone {

struct HistoryPoint {
  std::string commit;  // or the build's name
  std::string time;    // as the source has it; may be empty
  double value = 0.0;  // finite
};
using History = std::vector<HistoryPoint>;  // oldest first

// One JSON object to a line: {"commit": "...", "test": "...", "metric": "...", "value": 1.5, "time": "..."}; lines of
// another metric, or of another test where one is asked for, are passed over. Throws BadData with file and line.
History load_history(const std::filesystem::path& file, std::string_view metric, std::string_view test);
// Adds one line; throws BadData for a value that is not finite.
void append_history(const std::filesystem::path& file, const HistoryPoint& point, std::string_view metric,
                    std::string_view test);

// A change of the mean, at the first point of the new level.
struct Step {
  std::size_t index;
  double before;  // mean of the level that ends
  double after;
  double score;  // difference of the means over its standard error
};

// Binary segmentation (Scott and Knott 1974): the best split is kept while the square of its score exceeds 3 ln n (the
// penalty of Zhang and Siegmund 2007 for a change of unknown place). The noise is that of successive differences
// (median absolute, so that steps do not count as noise); where there is none, any change beyond rounding is a step.
std::vector<Step> find_steps(const std::vector<double>& values);

struct HistoryGate {
  std::optional<double> maximum = std::nullopt;
  std::optional<double> minimum = std::nullopt;
  std::optional<double> most_rise = std::nullopt;  // of the newest over the median of those before, as a fraction
};
// One sentence for each threshold that the newest value breaks; a history without values breaks every gate.
std::vector<std::string> broken_gates(const History& history, const HistoryGate& gate);

}  // namespace touchstone
