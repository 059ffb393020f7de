#include "guess_clock.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "clock_reading.h"

namespace touchstone::importing {
namespace {

struct Clock {
  const NamedColumn* named;
  ClockReading reading;
};

// Those of tables whose other columns are used; where none are, and there are several, their names.
std::string keep_clocks_of_used_tables(const MapProposal& map, std::vector<Clock>& clocks) {
  if (map.tables.size() < 2 || clocks.size() < 2) return {};
  const auto used = [&](std::size_t t) {
    return std::ranges::any_of(map.used,
                               [&](const std::string& name) { return name.starts_with(map.tables[t].name + ":"); });
  };
  if (std::ranges::any_of(clocks, [&](const Clock& c) { return used(c.named->table); })) {
    std::erase_if(clocks, [&](const Clock& c) { return !used(c.named->table); });
    return {};
  }
  std::string names;
  for (const Clock& clock : clocks) names += (names.empty() ? "" : ", ") + map.tables[clock.named->table].name;
  return names;
}

std::string texts_named_as_times(const MapProposal& map) {
  std::string list;
  for (std::size_t t = 0; t < map.tables.size(); ++t) {
    for (std::size_t c = 0; c < map.tables[t].names.size(); ++c) {
      if (!map.tables[t].is_text(c) || !parse_column_name(map.tables[t].description(c)).is(Quantity::time)) continue;
      list += (list.empty() ? "" : ", ") + said_of(map.tables, t, c);
    }
  }
  return list.empty() ? ""
                      : list +
                            " holds text that is no time that can be read: give the rate of the rows, as "
                            "{\"row_rate_Hz\": ...}";
}

// Seconds in one column, nanoseconds within them in another, as ROS 2 has its stamps.
bool use_stamp_of_two(MapProposal& map) {
  const NamedColumn *whole = nullptr, *part = nullptr;
  for (const NamedColumn& named : map.named) {
    if (!named.name.is(Quantity::time) || !named.name.factor) continue;
    const auto& values = map.tables[named.table].columns[named.column];
    const bool below_a_second = std::ranges::all_of(values, [](double v) { return !(v >= 1e9) && !(v < 0.0); });
    const bool counts_seconds = std::ranges::all_of(values, [](double v) { return v == std::floor(v); });
    if (*named.name.factor == 1.0 && counts_seconds && whole == nullptr) whole = &named;
    if (*named.name.factor == 1e-9 && below_a_second && part == nullptr) part = &named;
  }
  const bool both = whole != nullptr && part != nullptr && whole->table == part->table;
  if (!both || whole->name.frame != part->name.frame) return false;
  const std::string s = map.reference(map.tables[whole->table], whole->column),
                    ns = map.reference(map.tables[part->table], part->column);
  map.used.push_back(ns);
  const Json terms = Json::array({Json{{"from", s}}, Json{{"from", ns}, {"scale", 1e-9}}});
  map.use("t_s", {{"sum", terms}}, s, fmt::format("seconds, with the nanoseconds of {} added", ns));
  return true;
}

// A counter of rows is no clock unless the lines above the table state the rate.
bool use_counted_rows(MapProposal& map) {
  if (!map.head.rate_Hz) {
    for (const NamedColumn& named : map.named) {
      if (!named.name.is(Quantity::count) || !counts_rows(map.tables[named.table].columns[named.column])) continue;
      map.ask("t_s", fmt::format("{} counts rows and no line states their rate: put it, as {{\"row_rate_Hz\": ...}}",
                                 said_of(map.tables, named.table, named.column)));
      return true;
    }
    return false;
  }
  map.columns["t_s"] = {{"row_rate_Hz", *map.head.rate_Hz}};
  map.from["t_s"] = "row numbers";
  map.reasons.push_back(
      fmt::format("t_s <- row numbers at {} Hz: '{}' stands above the table", *map.head.rate_Hz, map.head.rate_line));
  for (const NamedColumn& named : map.named) {
    const auto& values = map.tables[named.table].columns[named.column];
    if (!named.name.is(Quantity::count) || values.size() < 2 || !(values.back() > values.front())) continue;
    if (!std::ranges::is_sorted(values)) continue;
    const std::string from = map.reference(map.tables[named.table], named.column);
    map.use("t_s", {{"from", from}, {"scale", 1.0 / *map.head.rate_Hz}}, from,
            fmt::format("it counts the samples, and '{}' stands above the table", map.head.rate_line));
    break;
  }
  return true;
}

}  // namespace

bool clock_by_names(MapProposal& map) {
  std::vector<Clock> clocks;
  std::string doubts, standing;
  for (const NamedColumn& named : map.named) {
    if (!named.name.is(Quantity::time)) continue;
    const auto reading = named.name.doubt.empty()
                             ? read_clock(map.tables[named.table].columns[named.column], named.name, map.head)
                             : ClockReading{std::nullopt, named.name.doubt, false};
    if (reading.scale) clocks.push_back({&named, reading});
    std::string& list = reading.stands ? standing : doubts;
    if (reading.scale) continue;
    list += fmt::format("{}{}: {}", list.empty() ? "" : "; ", said_of(map.tables, named.table, named.column),
                        reading.reason);
  }
  if (use_stamp_of_two(map)) return false;
  if (const std::string tables = keep_clocks_of_used_tables(map, clocks); !tables.empty()) {
    map.ask("t_s", "there are clocks in " + tables + ": which is the recording?");
    return false;
  }
  // A message's own stamp is when it was measured; the other is when it was written.
  const auto stamp = std::ranges::find_if(
      clocks, [](const Clock& c) { return c.named->name.frame.find("header") != std::string::npos; });
  if (clocks.size() > 1 && stamp != clocks.end()) std::rotate(clocks.begin(), stamp, stamp + 1);
  if (clocks.empty()) {
    if (doubts.empty() && use_counted_rows(map)) return false;
    if (doubts.empty()) doubts = texts_named_as_times(map);
    if (doubts.empty()) doubts = standing;
    if (!doubts.empty()) map.ask("t_s", doubts);
    return doubts.empty();
  }
  const auto duration = [&](const Clock& c) {
    const auto& v = map.tables[c.named->table].columns[c.named->column];
    return (v.back() - v.front()) * *c.reading.scale;
  };
  const double first = duration(clocks.front());
  const bool same = std::ranges::all_of(clocks, [&](const Clock& c) {
    constexpr double apart = 0.01;
    return c.named->table != clocks.front().named->table || std::abs(duration(c) - first) <= apart * first;
  });
  if (!same) {
    std::string list;
    for (const Clock& c : clocks)
      list += (list.empty() ? "" : ", ") + said_of(map.tables, c.named->table, c.named->column);
    map.ask("t_s", list + " are clocks of different lengths: which is that of the samples?");
    return false;
  }
  const auto& [named, reading] = clocks.front();
  Json how{{"from", map.reference(map.tables[named->table], named->column)}};
  if (*reading.scale != 1.0) how["scale"] = *reading.scale;
  map.use("t_s", std::move(how), map.reference(map.tables[named->table], named->column), reading.reason);
  return false;
}

void clock_by_numbers(MapProposal& map, const ImportTable& table) {
  std::string rising;
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    const auto& values = table.columns[c];
    const bool used = std::ranges::find(map.used, map.reference(table, c)) != map.used.end();
    const auto falls = [](double a, double b) { return !(b > a); };
    if (used || values.size() < 2 || std::ranges::adjacent_find(values, falls) != values.end()) continue;
    if (is_since_1970(values)) {
      const ClockReading reading = read_clock(values, {}, map.head);
      if (!reading.scale) continue;
      Json how{{"from", map.reference(table, c)}};
      if (*reading.scale != 1.0) how["scale"] = *reading.scale;
      map.use("t_s", std::move(how), map.reference(table, c), reading.reason);
      return;
    }
    rising += (rising.empty() ? "" : ", ") + map.reference(table, c);
  }
  if (rising.empty()) return;
  map.ask("t_s", fmt::format("no name says which column is the clock; the numbers of {} only increase: put it, and its "
                             "scale to seconds",
                             rising));
}

// Whether a row's pose lies near the one before it: by the ratio of the mean square successive difference to the
// variance (von Neumann 1941), which is 2 for poses in no order and near 0 along a path.
bool moves_on(const MapProposal& map) {
  std::vector<std::string> parts;
  for (const auto& name :
       map.json.contains("quaternion") ? map.json["quaternion"]["from"] : map.json["rotation_rows"]) {
    parts.push_back(name);
  }
  double differences = 0.0, variance = 0.0;
  for (const ImportTable& table : map.tables) {
    for (std::size_t c = 0; c < table.names.size(); ++c) {
      const auto& v = table.columns[c];
      if (std::ranges::find(parts, map.reference(table, c)) == parts.end() || v.size() < 2) continue;
      const double mean = std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
      for (std::size_t i = 0; i < v.size(); ++i) {
        variance += (v[i] - mean) * (v[i] - mean);
        if (i > 0) differences += (v[i] - v[i - 1]) * (v[i] - v[i - 1]);
      }
    }
  }
  constexpr double ordered = 0.5;
  return differences < ordered * variance;
}

}  // namespace touchstone::importing
