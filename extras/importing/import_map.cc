#include "import_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <numbers>

#include "harness/base/json_reader.h"
#include "harness/base/json_values.h"

namespace touchstone::importing {
namespace {

// A column's name or number, as text.
std::string column_name(JsonObject& object, std::string_view key, const nlohmann::json& value) {
  if (value.is_string() && !value.get<std::string>().empty()) return value.get<std::string>();
  // Not read as an int: a number beyond its range would come out as another column's.
  if (value.is_number_unsigned() && value != 0) return value.dump();
  object.fail_at(key, "the name of a column or its number, counted from 1, was expected");
}

ImportTerm read_term(JsonObject object) {
  ImportTerm term;
  term.column = column_name(object, "from", object.raw("from"));
  term.scale = object.optional_number("scale").value_or(1.0);
  object.finish();
  return term;
}

ImportColumn read_column(std::string name, JsonObject object) {
  ImportColumn column;
  column.name = std::move(name);
  int ways = 0;
  const double scale = object.optional_number("scale").value_or(1.0);
  for (const char* const key : {"from", "integrate"}) {
    if (!object.has(key)) continue;
    column.terms.push_back({column_name(object, key, object.raw(key)), scale});
    column.integrate = std::string_view(key) == "integrate";
    ++ways;
  }
  if (object.has("sum")) {
    for (JsonObject& term : object.objects("sum")) column.terms.push_back(read_term(std::move(term)));
    if (column.terms.empty()) object.fail_at("sum", "at least one term was expected");
    ++ways;
  }
  if (const auto constant = object.optional_number("constant")) column.offset = *constant, ++ways;
  if (const auto rate = object.optional_number("row_rate_Hz")) {
    if (!(*rate > 0.0)) object.fail_at("row_rate_Hz", "must be above zero");
    column.row_rate_Hz = rate, ++ways;
  }
  column.offset += object.optional_number("offset").value_or(0.0);
  column.offset += object.optional_number("start").value_or(0.0);
  object.finish();
  if (ways != 1) object.fail("one of from, sum, integrate, constant and row_rate_Hz was expected");
  return column;
}

TextLayout read_layout(JsonObject& parent) {
  TextLayout layout;
  if (!parent.has("table")) return layout;
  JsonObject object = parent.object("table");
  layout.separator = object.optional_text("separator").value_or("");
  layout.decimal = object.optional_text("decimal").value_or("");
  layout.comment = object.optional_text("comment").value_or("");
  const auto one_of = [&](const std::string& key, const std::string& value, const std::vector<std::string>& known) {
    if (value.empty() || std::ranges::find(known, value) != known.end()) return;
    std::string list;
    for (const std::string& k : known) list += (list.empty() ? "" : ", ") + k;
    object.fail_at(key, fmt::format("'{}' is not known; {} are", value, list));
  };
  one_of("separator", layout.separator, {"comma", "semicolon", "tab", "space"});
  one_of("decimal", layout.decimal, {"point", "comma"});
  if (object.has("names")) layout.names = texts_of(object, "names");
  object.finish();
  return layout;
}

std::vector<std::string> names_at(JsonObject& object, std::string_view key, std::size_t count) {
  const auto& list = object.raw(key);
  if (!list.is_array() || list.size() != count) {
    object.fail_at(key, fmt::format("{} columns were expected", count));
  }
  std::vector<std::string> names;
  for (const auto& value : list) names.push_back(column_name(object, key, value));
  return names;
}

void read_orientation(JsonObject& root, ImportMap& map) {
  int ways = 0;
  if (root.has("rotation_rows")) map.rotation_rows = names_at(root, "rotation_rows", 9), ++ways;
  if (root.has("quaternion")) {
    JsonObject object = root.object("quaternion");
    auto names = names_at(object, "from", 4);
    const std::string order = object.text("order");
    if (order == "xyzw") {
      std::rotate(names.begin(), names.begin() + 3, names.end());
    } else if (order != "wxyz") {
      object.fail_at("order", "wxyz or xyzw was expected");
    }
    map.quaternion = std::move(names);
    object.finish();
    ++ways;
  }
  if (root.has("euler")) {
    JsonObject object = root.object("euler");
    map.euler = names_at(object, "from", 3);
    map.euler_order = object.text("order");
    const bool axes = map.euler_order.size() == 3 && map.euler_order.find_first_not_of("xyz") == std::string::npos;
    if (!axes)
      object.fail_at("order", "three of the letters x, y, z were expected: the axes, each turned with the body");
    const std::string unit = object.text("unit");
    if (unit != "deg" && unit != "rad") object.fail_at("unit", "deg or rad was expected");
    map.euler_scale = unit == "deg" ? std::numbers::pi / 180.0 : 1.0;
    object.finish();
    ++ways;
  }
  if (ways > 1) root.fail("rotation_rows, quaternion and euler say the same; give one of them");
}

ImportStatus read_status(JsonObject object) {
  ImportStatus status;
  status.column = column_name(object, "from", object.raw("from"));
  const auto device = find_status_device(object.text("device"));
  if (!device) object.fail_at("device", "net-ft or ethernet-axia was expected");
  status.device = *device;
  const std::string bad = object.optional_text("bad_samples").value_or("refuse");
  if (bad == "leave out") {
    status.bad_samples = BadSamples::leave_out;
  } else if (bad == "keep") {
    status.bad_samples = BadSamples::keep;
  } else if (bad != "refuse") {
    object.fail_at("bad_samples", "refuse, leave out or keep was expected");
  }
  object.finish();
  return status;
}

void read_parts(JsonObject& root, ImportMap& map) {
  for (JsonObject& part : root.objects("stack")) {
    ImportMap::Part columns;
    for (const std::string& key : part.keys()) {
      if (key == "reverse") {
        columns.reverse = part.optional_flag("reverse").value_or(false);
      } else if (key == "padded") {
        columns.padded = part.optional_text("padded").value_or("");
      } else {
        columns.columns[key] = column_name(part, key, part.raw(key));
      }
    }
    if (!columns.padded.empty() && !columns.columns.contains(columns.padded)) {
      part.fail_at("padded", "a column that the part names was expected");
    }
    part.finish();
    const auto same = [&](const auto& a) { return a.second.empty() || !map.stack.front().columns.contains(a.first); };
    if (!map.stack.empty() &&
        (columns.columns.size() != map.stack.front().columns.size() || std::ranges::any_of(columns.columns, same))) {
      part.fail("every part must name the same columns");
    }
    map.stack.push_back(std::move(columns));
  }
}

// A clock alone, or with an orientation, is no measurement of anything.
bool measures_something(const std::vector<ImportColumn>& columns) {
  return std::ranges::any_of(columns, [](const ImportColumn& column) {
    constexpr std::array<std::string_view, 11> quantities{"x_",  "y_",  "z_",  "fx_", "fy_",    "fz_",
                                                          "tx_", "ty_", "tz_", "q_",  "torque_"};
    return std::ranges::any_of(quantities, [&](std::string_view start) { return column.name.starts_with(start); });
  });
}

}  // namespace

ImportMap parse_import_map(const nlohmann::json& json, const std::string& source) {
  JsonObject root(json, source, "");
  root.schema("touchstone-import/1");
  ImportMap map;
  map.source = source;
  map.about = root.optional_text("about").value_or("");
  if (root.has("decide")) {
    const auto open = texts_of(root, "decide");
    if (!open.empty()) {
      root.fail_at("decide",
                   fmt::format("{} {} not decided: {}. Put the answer into the map, then take the line out",
                               open.size(), open.size() == 1 ? "question is" : "questions are", open.front()));
    }
  }
  if (root.has("reasons")) texts_of(root, "reasons");
  map.layout = read_layout(root);
  if (root.has("files")) {
    JsonObject files = root.object("files");
    for (const std::string& name : files.keys()) {
      JsonObject object = files.object(name);
      ImportFile file;
      file.name = name;
      file.file = object.text("file");
      file.layout = read_layout(object);
      if (object.has("time")) file.time = read_term(object.object("time"));
      object.finish();
      map.files.push_back(std::move(file));
    }
    files.finish();
  }
  if (root.has("stack")) read_parts(root, map);
  if (root.has("rows")) {
    JsonObject rows = root.object("rows");
    map.from_s = rows.optional_number("from_s");
    map.to_s = rows.optional_number("to_s");
    if (rows.has("at")) map.rows_at = column_name(rows, "at", rows.raw("at"));
    if (rows.has("where")) {
      JsonObject where = rows.object("where");
      for (const std::string& key : where.keys()) map.where[key] = where.number(key);
      where.finish();
    }
    rows.finish();
  }
  JsonObject columns = root.object("columns");
  for (const std::string& name : columns.keys()) map.columns.push_back(read_column(name, columns.object(name)));
  columns.finish();
  if (map.columns.empty()) root.fail_at("columns", "at least one column was expected");
  if (!measures_something(map.columns)) {
    root.fail_at(
        "columns",
        "neither a position (x_m, y_m, z_m) nor a force (fx_N, fy_N, fz_N) is among them: a recording needs one; "
        "say which columns of the file hold it");
  }
  read_orientation(root, map);
  map.force_sign = root.optional_number("force_sign").value_or(1.0);
  if (map.force_sign != 1.0 && map.force_sign != -1.0) root.fail_at("force_sign", "1 or -1 was expected");
  map.shift_force_s = root.optional_number("shift_force_s").value_or(0.0);
  const std::string frame = root.optional_text("force_frame").value_or("object");
  if (frame == "sensor") {
    map.force_frame = ForceFrameReading::sensor;
  } else if (frame == "inverse") {
    map.force_frame = ForceFrameReading::inverse;
  } else if (frame == "transposed") {
    map.force_frame = ForceFrameReading::transposed;
  } else if (frame != "object") {
    root.fail_at("force_frame", "object, sensor, inverse or transposed was expected");
  }
  if (root.has("status")) map.status = read_status(root.object("status"));
  root.finish();
  return map;
}

ImportMap load_import_map(const std::filesystem::path& path) {
  return parse_import_map(load_json(path), path.string());
}

}  // namespace touchstone::importing
