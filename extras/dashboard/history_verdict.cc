#include "history_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "harness/base/json_reader.h"
#include "harness/stats/quantile.h"

namespace touchstone::dashboard {
namespace {

Worse worse_of(JsonObject& object) {
  const auto word = object.optional_text("worse").value_or("any");
  if (word == "up") return Worse::up;
  if (word == "down") return Worse::down;
  if (word == "any") return Worse::any;
  object.fail_at("worse", fmt::format("is '{}', and should be up, down or any", word));
}

HistoryLimit read_limit(JsonObject& object) {
  HistoryLimit limit;
  const auto text = [&](const char* name) { return object.optional_text(name).value_or(""); };
  limit.series = {text("site"), text("build"), text("track"), text("test"), text("metric")};
  limit.worse = worse_of(object);
  limit.smallest_relative = object.optional_number("smallest_relative").value_or(limit.smallest_relative);
  limit.smallest_absolute = object.optional_number("smallest_absolute").value_or(limit.smallest_absolute);
  limit.maximum = object.optional_number("max");
  limit.minimum = object.optional_number("min");
  limit.most_rise = object.optional_number("max_rise");
  limit.most_fall = object.optional_number("max_fall");
  if (object.has("accepted")) {
    for (JsonObject& accepted : object.objects("accepted")) {
      limit.accepted.push_back({accepted.text("commit"), accepted.text("reason")});
      accepted.finish();
    }
  }
  object.finish();
  return limit;
}

class Judge {
 public:
  Judge(const HistorySeries& series, const HistoryLimit& limit, SeriesVerdict& verdict)
      : points_(series.points), limit_(limit), verdict_(verdict) {}

  void changes() {
    for (std::size_t i = 0; i < verdict_.report.changes.size(); ++i) change(i);
  }

  void gates() {
    const bool gated = limit_.maximum || limit_.minimum || limit_.most_rise || limit_.most_fall;
    if (!gated) return;
    if (points_.empty()) return fail("there is no value to hold against a limit");
    const HistoryPoint& newest = points_.back();
    if (limit_.maximum && !(newest.value <= *limit_.maximum))
      fail(fmt::format("{}: {:.6g} is above {:.6g}", newest.commit, newest.value, *limit_.maximum));
    if (limit_.minimum && !(newest.value >= *limit_.minimum))
      fail(fmt::format("{}: {:.6g} is below {:.6g}", newest.commit, newest.value, *limit_.minimum));
    if (!limit_.most_rise && !limit_.most_fall) return;
    if (points_.size() == 1) return fail("there is no earlier value to rise or fall from");
    std::vector<double> earlier;
    for (const auto& point : std::span(points_).first(points_.size() - 1)) earlier.push_back(point.value);
    const double usual = stats::median(std::move(earlier));
    const auto hold = [&](const std::optional<double>& most, double by, const char* word) {
      // Rounding is no rise, even from zero.
      if (!most || by <= std::max(*most * std::abs(usual), limit_.smallest_absolute)) return;
      fail(fmt::format("{}: {:.6g} is more than {:.3g} % {} {:.6g}, the median before", newest.commit, newest.value,
                       100.0 * *most, word, usual));
    };
    hold(limit_.most_rise, newest.value - usual, "above");
    hold(limit_.most_fall, usual - newest.value, "below");
  }

 private:
  void fail(std::string sentence) { verdict_.findings.push_back({std::move(sentence), true, std::nullopt}); }

  [[nodiscard]] bool is_worse(double before, double after) const {
    if (!(std::abs(after - before) > std::max(limit_.smallest_absolute, limit_.smallest_relative * std::abs(before))))
      return false;
    return limit_.worse == Worse::any || (after > before) == (limit_.worse == Worse::up);
  }

  [[nodiscard]] const AcceptedChange* acceptance(const change_points::Change& change) const {
    for (const AcceptedChange& accepted : limit_.accepted) {
      for (std::size_t i = change.first; i <= change.last; ++i) {
        if (!accepted.commit.empty() && points_[i].commit.starts_with(accepted.commit)) return &accepted;
      }
    }
    return nullptr;
  }

  // The commits that the change may have come with: after the last of the old level, up to the last that fits.
  [[nodiscard]] std::string range(const change_points::Change& change) const {
    const std::string& last = points_[change.last].commit;
    return change.first == 0 ? "up to " + last : fmt::format("{}..{}", points_[change.first - 1].commit, last);
  }

  void change(std::size_t i) {
    const change_points::Change& change = verdict_.report.changes[i];
    const double percent = 100.0 * (change.after - change.before) / std::abs(change.before);
    std::string sentence = fmt::format(
        "{}: {:.6g} -> {:.6g}{} in {}", change.kind == change_points::ChangeKind::step ? "step" : "drift",
        change.before, change.after, std::isfinite(percent) ? fmt::format(" ({:+.3g} %)", percent) : "", range(change));
    const double now = verdict_.report.levels.back().to;
    bool fails = false;
    if (!is_worse(change.before, change.after)) {
      sentence += limit_.worse == Worse::any ? ": too small to matter" : ": for the better";
    } else if (const auto* const accepted = acceptance(change)) {
      sentence += fmt::format(": accepted with {}: {}", accepted->commit, accepted->reason);
    } else if (!is_worse(change.before, now)) {
      sentence += ": over since then";
    } else {
      fails = true;
    }
    verdict_.findings.push_back({std::move(sentence), fails, i});
  }

  const std::vector<HistoryPoint>& points_;
  const HistoryLimit& limit_;
  SeriesVerdict& verdict_;
};

}  // namespace

const HistoryLimit& HistoryLimits::of(const SeriesKey& key) const {
  static const HistoryLimit none;
  const auto found =
      std::ranges::find_if(limits, [&](const HistoryLimit& limit) { return matches(limit.series, key); });
  return found == limits.end() ? none : *found;
}

HistoryLimits load_history_limits(const std::filesystem::path& file) {
  const nlohmann::json document = load_json(file);
  JsonObject object(document, file.string(), "");
  object.schema("touchstone-history/1");
  HistoryLimits limits;
  limits.false_alarms_per_year = object.optional_number("false_alarms_per_year").value_or(limits.false_alarms_per_year);
  if (!(limits.false_alarms_per_year > 0.0 && limits.false_alarms_per_year <= 1.0))
    object.fail_at("false_alarms_per_year", "should be above 0 and at most 1");
  for (JsonObject& limit : object.objects("limits")) limits.limits.push_back(read_limit(limit));
  object.finish();
  return limits;
}

bool SeriesVerdict::failed() const { return std::ranges::any_of(findings, &HistoryFinding::fails); }

SeriesVerdict judge_series(const HistorySeries& series, const HistoryLimit& limit, double false_alarms_per_year,
                           std::size_t series_together) {
  std::vector<double> values;
  values.reserve(series.points.size());
  for (const auto& point : series.points) values.push_back(point.value);
  SeriesVerdict verdict;
  verdict.report = change_points::find_changes(
      values,
      {.false_alarms_per_year = false_alarms_per_year / static_cast<double>(std::max<std::size_t>(series_together, 1)),
       .smallest_relative = limit.smallest_relative,
       .smallest_absolute = limit.smallest_absolute});
  Judge judge(series, limit, verdict);
  judge.changes();
  judge.gates();
  return verdict;
}

}  // namespace touchstone::dashboard
