// Excel workbooks (.xlsx: Office Open XML, ECMA-376 part 1, chapters 12.3 and 18: workbook, sheets, shared strings,
// styles) as testing machines and people write them. Each sheet goes through the reader of text tables as lines of
// fields, so that names, rows of units, text and missing values are found as in CSV. Cells in a style of dates or times
// are counted in days; they become times.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <set>
#include <string_view>

#include "harness/base/error.h"
#include "import_table.h"
#include "zip_entries.h"

namespace touchstone::importing {
namespace {

// Parsed XML takes several times its size.
constexpr std::uintmax_t largest_workbook_bytes = std::uintmax_t{512} << 20;
constexpr std::size_t widest_sheet = 16384, longest_sheet = 1048576;  // of a sheet, by the specification

// Without the prefix of a namespace, which a program may choose.
std::string_view bare_name(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  return name.substr(name.find(':') == std::string_view::npos ? 0 : name.find(':') + 1);
}

class Workbook {
 public:
  explicit Workbook(const std::filesystem::path& path) : source_(path.string()) {
    std::map<std::string, std::string> parts;
    for_each_zip_entry(
        path, largest_workbook_bytes,
        [](const std::string& name) {
          return name.starts_with("xl/") && (name.ends_with(".xml") || name.ends_with(".rels")) &&
                 !name.starts_with("xl/charts") && !name.starts_with("xl/theme");
        },
        [&](const std::string& name, std::string bytes) { parts[name] = std::move(bytes); });
    read_strings(parts["xl/sharedStrings.xml"]);
    read_styles(parts["xl/styles.xml"]);
    std::map<std::string, std::string> targets;
    const auto relations = parsed(parts["xl/_rels/workbook.xml.rels"]);
    for (const pugi::xml_node& node : relations->document_element()) {
      const std::string target = node.attribute("Target").value();
      targets[node.attribute("Id").value()] = target.starts_with('/') ? target.substr(1) : "xl/" + target;
    }
    const auto workbook = parsed(parts["xl/workbook.xml"]);
    for (const pugi::xml_node& node : workbook->document_element()) {
      if (bare_name(node) == "workbookPr") since_1904_ = node.attribute("date1904").as_bool();
      if (bare_name(node) != "sheets") continue;
      for (const pugi::xml_node& sheet : node) {
        std::string id;
        for (const pugi::xml_attribute& attribute : sheet.attributes()) {
          if (std::string_view(attribute.name()).ends_with(":id")) id = attribute.value();
        }
        const std::string& part = targets[id];
        if (part.starts_with("xl/worksheets/")) read_sheet(sheet.attribute("name").value(), parts[part]);
      }
    }
  }

  std::vector<ImportTable> finish() {
    if (tables_.empty()) {
      throw BadData(fmt::format("{}: no sheet of this workbook holds a table of numbers: {}", source_,
                                refused_.empty() ? "it has no sheet" : refused_));
    }
    std::ranges::stable_sort(tables_, std::greater<>(), [](const ImportTable& t) { return t.rows(); });
    // One table has no name, as that of a text file.
    if (tables_.size() == 1) tables_.front().name.clear();
    return std::move(tables_);
  }

 private:
  std::unique_ptr<pugi::xml_document> parsed(const std::string& xml) const {
    auto document = std::make_unique<pugi::xml_document>();
    const auto result =
        document->load_buffer(xml.data(), xml.size(), pugi::parse_default | pugi::parse_ws_pcdata_single);
    if (!xml.empty() && !result) {
      throw BadData(fmt::format("{}: damaged workbook: its XML ends at byte {}: {}", source_, result.offset,
                                result.description()));
    }
    return document;
  }

  // All the text below a node: a string may be in pieces of different fonts. What separates fields is a blank.
  static std::string text_below(const pugi::xml_node& node) {
    std::string text;
    for (const pugi::xml_node& child : node) {
      if (bare_name(child) == "t") text += child.text().get();
      if (bare_name(child) == "r") text += text_below(child);
    }
    return text;
  }

  void read_strings(const std::string& xml) {
    const auto document = parsed(xml);
    for (const pugi::xml_node& node : document->document_element()) strings_.push_back(text_below(node));
  }

  // Which styles show a number as a date or a time: built-in formats 14 to 22 and 45 to 47 (18.8.30), and those whose
  // code has letters of a date outside of quotes and brackets.
  void read_styles(const std::string& xml) {
    std::set<int> formats{14, 15, 16, 17, 18, 19, 20, 21, 22, 45, 46, 47};
    const auto document = parsed(xml);
    for (const pugi::xml_node& group : document->document_element()) {
      if (bare_name(group) != "numFmts") continue;
      for (const pugi::xml_node& format : group) {
        bool quoted = false, bracket = false, date = false;
        for (const char c : std::string_view(format.attribute("formatCode").value())) {
          quoted = quoted != (c == '"');
          bracket = (bracket || c == '[') && c != ']';
          date = date || (!quoted && !bracket && std::strchr("yYdDhHsS", c) != nullptr);
        }
        if (date) formats.insert(format.attribute("numFmtId").as_int());
      }
    }
    for (const pugi::xml_node& group : document->document_element()) {
      if (bare_name(group) != "cellXfs") continue;
      for (const pugi::xml_node& style : group)
        dates_.push_back(formats.contains(style.attribute("numFmtId").as_int()));
    }
  }

  // A number of days as text that is read as a time: of the day below one, since 1970 else.
  [[nodiscard]] std::string date_text(double days) const {
    constexpr double day_us = 86400e6, most_days = 2958466.0;  // the year 9999
    if (!(days >= 0.0) || !(days < most_days)) return "";
    const auto us = std::chrono::microseconds(std::llround(days * day_us));
    const auto whole = std::chrono::floor<std::chrono::seconds>(us);
    const auto part = (us - whole).count();
    if (days < 1.0) return fmt::format("{:%T}.{:06}", whole, part);
    constexpr std::chrono::days from_1900{25569}, from_1904{24107};
    const std::chrono::sys_seconds since_1970{whole - (since_1904_ ? from_1904 : from_1900)};
    return fmt::format("{:%FT%T}.{:06}Z", since_1970, part);
  }

  [[nodiscard]] std::string cell_text(const pugi::xml_node& cell) const {
    const std::string_view type = cell.attribute("t").value();
    std::string value;
    for (const pugi::xml_node& child : cell) {
      if (bare_name(child) == "v") value = child.text().get();
      if (bare_name(child) == "is") value = text_below(child);
    }
    if (type == "e") return "";  // #N/A and its like
    if (type == "s") {
      std::size_t number = 0;
      const auto [end, status] = std::from_chars(value.data(), value.data() + value.size(), number);
      if (status != std::errc{} || end != value.data() + value.size() || number >= strings_.size()) {
        throw BadData(fmt::format("{}: cell {} names the shared string '{}' of {}: the workbook is damaged", source_,
                                  cell.attribute("r").value(), value, strings_.size()));
      }
      value = strings_[number];
    } else if (type.empty() || type == "n") {
      const auto style = cell.attribute("s").as_uint();
      if (style < dates_.size() && dates_[style]) return date_text(cell_number(value));
    }
    std::ranges::replace_if(
        value, [](char c) { return c == '\t' || c == '\n' || c == '\r' || c == '"'; }, ' ');
    return value;
  }

  static double cell_number(const std::string& text) {
    double value = std::nan("");
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
  }

  // "BC17" -> 55; the column after the last one if there is no reference.
  [[nodiscard]] std::size_t column_of(const pugi::xml_node& cell, std::size_t next) const {
    const std::string_view reference = cell.attribute("r").value();
    std::size_t column = 0;
    for (const char c : reference) {
      if (c < 'A' || c > 'Z') break;
      column = 26 * column + static_cast<std::size_t>(c - 'A' + 1);
      if (column > widest_sheet) break;
    }
    if (reference.empty()) column = next + 1;
    if (column == 0 || column > widest_sheet) {
      throw BadData(fmt::format("{}: '{}' is no cell of a sheet: the workbook is damaged", source_, reference));
    }
    return column - 1;
  }

  void read_sheet(const std::string& name, const std::string& xml) {
    std::map<std::size_t, std::map<std::size_t, std::string>> rows;
    std::size_t first = widest_sheet;
    const auto document = parsed(xml);
    for (const pugi::xml_node& data : document->document_element()) {
      if (bare_name(data) != "sheetData") continue;
      std::size_t number = 0;
      for (const pugi::xml_node& row : data) {
        number = row.attribute("r").as_uint(static_cast<unsigned>(number + 1));
        if (number == 0 || number > longest_sheet) {
          throw BadData(
              fmt::format("{}: sheet {}: row {} is none of a sheet: the workbook is damaged", source_, name, number));
        }
        std::size_t next = 0;
        for (const pugi::xml_node& cell : row) {
          const std::size_t column = column_of(cell, next);
          next = column + 1;
          std::string text = cell_text(cell);
          if (text.empty()) continue;
          first = std::min(first, column);
          rows[number][column] = std::move(text);
        }
      }
    }
    // The table is as wide as most rows: remarks beside it are not.
    std::map<std::size_t, std::size_t> widths;
    for (const auto& [number, cells] : rows) ++widths[cells.rbegin()->first];
    const auto usual = std::ranges::max_element(widths, {}, [](const auto& width) { return width.second; });
    const std::size_t last = usual == widths.end() ? 0 : usual->first;
    // Line by line, so that a message names the sheet's own row.
    std::string lines;
    std::size_t line = 1;
    for (const auto& [number, cells] : rows) {
      for (; line < number; ++line) lines += '\n';
      std::size_t column = first;
      for (const auto& [at, text] : cells) {
        for (; column < at; ++column) lines += '\t';
        lines += text;
      }
      for (; column < last; ++column) lines += '\t';
    }
    lines += '\n';
    if (rows.empty()) return;
    try {
      TextLayout layout;
      layout.separator = "tab", layout.decimal = "point";
      ImportTable table = read_text_lines(fmt::format("{} (sheet {})", source_, name), lines, layout);
      table.format = "Excel workbook";
      table.name = name;
      tables_.push_back(std::move(table));
    } catch (const BadData& error) {
      refused_ += (refused_.empty() ? "" : "; ") + std::string(error.what());
    }
  }

  std::string source_, refused_;
  std::vector<std::string> strings_;
  std::vector<bool> dates_;  // of each style
  bool since_1904_ = false;
  std::vector<ImportTable> tables_;
};

}  // namespace

std::vector<ImportTable> read_excel_workbook(const std::filesystem::path& path) { return Workbook(path).finish(); }

}  // namespace touchstone::importing
