#include "text_heads.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "column_name.h"
#include "foreign_unit.h"
#include "text_dialect.h"

namespace touchstone::importing {
namespace {

// What the head of one segment says of its channels, by tag; and how the file writes X.
struct LabviewSegment {
  std::map<std::string, TextFields, std::less<>> tags;

  [[nodiscard]] std::string_view of(std::string_view tag, std::size_t channel) const {
    const auto found = tags.find(tag);
    return found == tags.end() || channel >= found->second.size() ? std::string_view{} : found->second[channel];
  }
};

std::vector<LabviewSegment> labview_segments(const std::vector<std::string_view>& lines, char separator,
                                             std::string& x_columns) {
  std::vector<LabviewSegment> segments;
  bool within = false;
  for (const std::string_view line : lines) {
    const TextFields fields = text_fields(line, separator);
    if (fields.empty()) continue;
    if (fields.front() == "X_Columns" && fields.size() > 1) x_columns = fields[1];
    if (fields.front() == "Channels") {
      segments.emplace_back();
      within = true;
    }
    if (fields.front().starts_with("***End_of_Header***")) within = false;
    if (within) segments.back().tags[std::string(fields.front())] = TextFields(fields.begin() + 1, fields.end());
  }
  return segments;
}

// X0 and Delta_X, where all channels of the segment have the same.
std::optional<std::pair<double, double>> even_x(const LabviewSegment& segment, std::size_t channels, char decimal) {
  std::optional<std::pair<double, double>> all;
  for (std::size_t c = 0; c < channels; ++c) {
    const auto start = text_value(segment.of("X0", c), decimal), step = text_value(segment.of("Delta_X", c), decimal);
    if (!start || !step || std::isnan(*step)) return std::nullopt;
    const std::pair<double, double> one{std::isnan(*start) ? 0.0 : *start, *step};
    if (all && *all != one) return std::nullopt;
    all = one;
  }
  return all;
}

}  // namespace

bool is_unit_field(std::string_view field) {
  if (field.empty() || field == "-" || field == "[]" || field == "()") return true;
  const bool brackets = (field.front() == '(' && field.back() == ')') || (field.front() == '[' && field.back() == ']');
  return brackets || is_foreign_unit(field);
}

std::string name_with_unit(const std::string& name, std::string_view unit, bool time_of_day) {
  if (time_of_day) {
    const auto before = without_blanks(std::string_view(name).substr(0, name.find_first_of("([{")));
    return fmt::format("{} (s)", parse_column_name(before).is(Quantity::time) ? before : "time");
  }
  while (!unit.empty() && (unit.front() == '(' || unit.front() == '[')) unit.remove_prefix(1);
  while (!unit.empty() && (unit.back() == ')' || unit.back() == ']')) unit.remove_suffix(1);
  return unit.empty() || unit == "-" ? "" : fmt::format("{} ({})", name, unit);
}

bool is_labview_measurement(const std::vector<std::string_view>& lines) {
  return !lines.empty() && without_blanks(lines.front()).starts_with("LabVIEW Measurement");
}

void drop_labview_comments(std::vector<std::string_view>& lines) {
  char separator = '\t';
  std::size_t columns = 0;  // of numbers; 0 within a header
  for (std::string_view& line : lines) {
    const auto fields = text_fields(line, separator);
    if (fields.front() == "Separator,Comma") separator = ',';
    if (fields.front() == "Channels") columns = 0;
    if (fields.front() == "X_Value" && fields.back() == "Comment") columns = fields.size() - 1;
    if (columns == 0 || fields.size() <= columns) continue;
    std::size_t end = line.find(separator);
    for (std::size_t c = 1; c < columns; ++c) end = line.find(separator, end + 1);
    line = line.substr(0, end);
  }
}

void apply_labview_heads(const std::vector<std::string_view>& lines, char separator, char decimal,
                         const std::vector<double>& segment, ImportTable& table) {
  std::string x_columns;
  const auto segments = labview_segments(lines, separator, x_columns);
  const bool multi = x_columns == "Multi";
  if (segments.empty() || table.names.empty() || table.names.front() != "X_Value") return;
  table.described.resize(table.names.size());
  const std::size_t channels = multi ? table.names.size() / 2 : table.names.size() - 1;
  for (std::size_t channel = 0; channel < channels; ++channel) {
    const std::size_t x = multi ? 2 * channel : 0, y = multi ? 2 * channel + 1 : channel + 1;
    const std::string_view unit = segments.front().of("Y_Unit_Label", channel),
                           dimension = segments.front().of("X_Dimension", channel);
    if (!unit.empty()) table.described[y] = fmt::format("{} ({})", table.names[y], unit);
    // The specification's default is the time, in seconds.
    table.described[x] = dimension.empty() || dimension == "Time" ? "Time (s)" : fmt::format("{} of X", dimension);
  }
  if (x_columns != "No") return;
  std::size_t row_of_segment = 0;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    row_of_segment = i > 0 && segment[i] == segment[i - 1] ? row_of_segment + 1 : 0;
    const auto s = static_cast<std::size_t>(segment[i]);
    const auto x = s < segments.size() ? even_x(segments[s], channels, decimal) : std::nullopt;
    if (!x) {
      table.notes.push_back(fmt::format(
          "{}: segment {} has no X column, and no Delta_X that all its channels share: its rows have no time",
          table.source, s + 1));
      return;
    }
    table.columns.front()[i] = x->first + static_cast<double>(row_of_segment) * x->second;
  }
  table.notes.push_back(fmt::format("{}: the file has no X column: X_Value is X0 + i Delta_X", table.source));
}

std::size_t motive_names_line(const std::vector<std::string_view>& lines) {
  constexpr std::size_t longest_head = 20;
  const bool motive =
      !lines.empty() && (lines.front().starts_with("Format Version,") || lines.front().starts_with("\xef\xbb\xbf"
                                                                                                   "Format Version,"));
  for (std::size_t i = 0; motive && i < std::min(lines.size(), longest_head); ++i) {
    const TextFields fields = text_fields(lines[i], ',');
    if (fields.size() > 2 && fields[0] == "Frame" && fields[1].starts_with("Time")) return i;
  }
  return lines.size();
}

void name_motive_columns(const std::vector<std::string_view>& lines, std::size_t names_line, ImportTable& table) {
  const TextFields head = text_fields(lines.front(), ','), names = text_fields(lines[names_line], ',');
  std::string length, rotation;
  for (std::size_t i = 0; i + 1 < head.size(); i += 2) {
    if (head[i] == "Length Units") length = head[i + 1];
    if (head[i] == "Rotation Type") rotation = head[i + 1];
  }
  TextFields types, owners, kinds;
  for (std::size_t i = 1; i < names_line; ++i) {
    TextFields fields = text_fields(lines[i], ',');
    if (fields.size() < 2) continue;
    if (fields[1] == "Type" || fields[0] == "Type") types = fields;
    if (fields[1] == "Name" || fields[0] == "Name") owners = fields;
    kinds = std::move(fields);  // of the last line above the names: Rotation, Position, ...
  }
  const auto at = [](const TextFields& fields, std::size_t c) {
    return c < fields.size() ? fields[c] : std::string_view{};
  };
  for (std::size_t c = 0; c < names.size(); ++c) {
    if (at(owners, c).empty() || c < 2) {
      table.names.emplace_back(names[c]);
      table.described.emplace_back();
      continue;
    }
    const std::string_view kind = at(kinds, c);
    table.names.push_back(fmt::format("{}.{}{}{}", at(owners, c), kind, names[c].empty() ? "" : ".", names[c]));
    const bool of_marker = at(types, c).find("Marker") != std::string_view::npos;
    const bool turned = kind == "Rotation", euler = turned && rotation != "Quaternion";
    table.described.push_back(fmt::format("{}{} {}{}{}", at(owners, c), of_marker ? " marker" : "",
                                          euler ? "euler " : "", std::string(kind) + " " + std::string(names[c]),
                                          kind == "Position" && !length.empty() ? " (" + length + ")" : ""));
  }
  table.names_from_file = true;
}

void name_echoed_message(std::string_view frame, ImportTable& table) {
  constexpr std::size_t stamp = 3, wrench_values = 6, pose_values = 7;
  const std::size_t width = table.names.size();
  const bool shape = width > stamp && !table.is_text(0) && !table.is_text(1) && table.is_text(2) &&
                     std::ranges::count(table.text, 1) == 1 && table.rows() > 0;
  constexpr double earliest_s = 1e9, latest_s = 4e9, second_ns = 1e9;
  if (!shape || !(table.columns[0].front() >= earliest_s) || !(table.columns[0].front() < latest_s)) return;
  if (std::ranges::any_of(table.columns[1], [](double v) { return !(v >= 0.0 && v < second_ns); })) return;
  table.names = {"header.stamp.sec", "header.stamp.nanosec", "header.frame_id"};
  const std::string said = table.source + " " + std::string(frame);
  const bool wrench = said.find("wrench") != std::string::npos || said.find("force") != std::string::npos ||
                      frame.find("ft") != std::string::npos;
  std::vector<const char*> rest;
  if (width == stamp + wrench_values && wrench) {
    rest = {"wrench.force.x",  "wrench.force.y",  "wrench.force.z",
            "wrench.torque.x", "wrench.torque.y", "wrench.torque.z"};
  }
  if (width == stamp + pose_values) {
    rest = {"pose.position.x",    "pose.position.y",    "pose.position.z",   "pose.orientation.x",
            "pose.orientation.y", "pose.orientation.z", "pose.orientation.w"};
  }
  for (std::size_t c = stamp; c < width; ++c) {
    table.names.push_back(rest.empty() ? fmt::format("c{}", c + 1) : rest[c - stamp]);
  }
  table.names_from_file = true;
  table.notes.push_back(fmt::format("{}: `ros2 topic echo --csv`, a message with a header: its columns are named {}",
                                    table.source,
                                    rest.empty() ? "as far as the header goes" : "as such a message has them"));
}

}  // namespace touchstone::importing
