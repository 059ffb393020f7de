// Is what a metric does over builds as it should be? Limits on the newest value, and changes of level and drifts that
// nobody accepted (harness/stats/change_points.h).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "change_points/change_points.h"
#include "history.h"

namespace touchstone::dashboard {

enum class Worse : unsigned char { up, down, any };

struct AcceptedChange {
  std::string commit;  // or the beginning of its name
  std::string reason;
};

struct HistoryLimit {
  SeriesKey series{};  // which it is for, as matches() takes it
  Worse worse = Worse::any;
  double smallest_relative = change_points::ChangeOptions{}.smallest_relative;
  double smallest_absolute = change_points::ChangeOptions{}.smallest_absolute;
  std::optional<double> maximum = std::nullopt;
  std::optional<double> minimum = std::nullopt;
  // Of the newest value against the median of those before, as a fraction of that median's size.
  std::optional<double> most_rise = std::nullopt;
  std::optional<double> most_fall = std::nullopt;
  std::vector<AcceptedChange> accepted{};
};

struct HistoryLimits {
  double false_alarms_per_year = change_points::ChangeOptions{}.false_alarms_per_year;  // of all series judged together
  std::vector<HistoryLimit> limits;                                                     // the first that matches counts
  [[nodiscard]] const HistoryLimit& of(const SeriesKey& key) const;
};

// {"schema": "touchstone-history/1", "false_alarms_per_year": 0.01, "limits": [{"metric", "test", "site", "build",
//  "track", "worse": "up|down|any", "smallest_relative", "smallest_absolute", "max", "min", "max_rise", "max_fall",
//  "accepted": [{"commit", "reason"}]}]}
HistoryLimits load_history_limits(const std::filesystem::path& file);

struct HistoryFinding {
  std::string sentence;
  bool fails = false;
  std::optional<std::size_t> change;  // its place in the report
};

struct SeriesVerdict {
  change_points::ChangeReport report;
  std::vector<HistoryFinding> findings;
  [[nodiscard]] bool failed() const;
};

// A change fails if it is for the worse, not accepted, and the newest level is still worse than the one before it. The
// false-alarm rate is shared among `series_together` series (Bonferroni). A series without values fails any limit.
SeriesVerdict judge_series(const HistorySeries& series, const HistoryLimit& limit, double false_alarms_per_year,
                           std::size_t series_together);

}  // namespace touchstone::dashboard
