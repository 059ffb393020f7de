// Tables of text as loggers and instruments write them: CSV without a header, decimal commas, comments, metadata before
// the numbers, a row of units below the names, columns of text among the numbers, blank lines after them, LabVIEW
// measurements (.lvm), exports of Motive, JPK and AFM Workshop curves, logs of the Net F/T demo, `topic echo`. The
// layout is found from the lines that hold numbers.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "clock_reading.h"
#include "column_name.h"
#include "harness/base/error.h"
#include "import_table.h"
#include "text_dialect.h"
#include "text_heads.h"
#include "text_style.h"

namespace touchstone::importing {
namespace {

class Reader {
 public:
  Reader(std::string source, std::string_view text, const TextLayout& layout)
      : source_(std::move(source)), lines_(text_lines(text)), layout_(layout) {
    labview_ = is_labview_measurement(lines_);
    if (labview_) drop_labview_comments(lines_);
    motive_line_ = motive_names_line(lines_);
    cut_ = !text.ends_with('\n') && !text.ends_with('\r');
  }

  ImportTable read() {
    const TextRows rows = choose_text_style(source_, lines_, layout_, motive_line_ < lines_.size());
    style_ = rows.style, width_ = rows.width, first_ = rows.first, mixed_ = rows.mixed;
    begin_at_first_rows();
    ImportTable table;
    table.source = source_;
    table.columns.resize(width_);
    table.format = fmt::format("{}: separator {}, decimal {}",
                               labview_                       ? "LabVIEW measurement"
                               : motive_line_ < lines_.size() ? "Motive export"
                                                              : "text table",
                               style_.separator_name, style_.decimal == ',' ? "comma" : "point");
    find_text_columns();
    name_columns(table);
    read_rows(table);
    note_text_columns(table);
    if (cut_) {
      table.notes.push_back(fmt::format(
          "{}: line {}, the last, has no end: if the file was cut short, its last number is", source_, lines_.size()));
    }
    if (first_ > 0) table.notes.push_back(fmt::format("{}: {} lines before the numbers were skipped", source_, first_));
    if (skipped_ > 0) table.notes.push_back(fmt::format("{}: {} comment lines among the numbers", source_, skipped_));
    keep_head(table);
    if (labview_) apply_labview_heads(lines_, style_.separator, style_.decimal, segment_, table);
    if (!table.names_from_file) {
      const TextFields first = text_fields(lines_[first_], style_.separator);
      name_echoed_message(width_ > 2 ? first[2] : std::string_view{}, table);
    }
    drop_empty_last_column(table);
    if (segments_ > 1) {
      table.names.emplace_back("segment");
      table.columns.push_back(std::move(segment_));
      if (!table.described.empty()) table.described.emplace_back();
      if (!table.text.empty()) table.text.push_back(0);
      table.notes.push_back(fmt::format("{}: {} segments, counted in the column 'segment'", source_, segments_));
    }
    return table;
  }

 private:
  [[nodiscard]] bool is_row(std::size_t i) const {
    const LineShape shape = line_shape(lines_[i], style_);
    return shape.width == width_ && shape.numbers > 0 && (mixed_ || !shape.has_text());
  }

  // A line that is no row may cut the rows in two, of which the second is longer: the table begins with the first rows,
  // and that line is then refused with its place.
  void begin_at_first_rows() {
    std::size_t rows = 0, begin = 0;
    for (std::size_t i = 0; i < first_ && !mixed_; ++i) {
      if (without_blanks(lines_[i]).empty() || !comment_of(lines_[i], layout_.comment).empty()) continue;
      if (!is_row(i)) {
        rows = 0;
        continue;
      }
      if (rows++ == 0) begin = i;
      if (rows == 2) {
        first_ = begin;
        return;
      }
    }
  }

  [[nodiscard]] std::optional<double> value_of(std::string_view field) const {
    return text_value(field, style_.decimal, style_.thousands);
  }

  // A column is of text where most of its fields are; a word in a column of numbers is refused with its place.
  void find_text_columns() {
    text_.assign(width_, 0);
    constexpr std::size_t looked_at = 1000;
    std::vector<std::size_t> words(width_, 0), numbers(width_, 0);
    for (std::size_t i = first_, rows = 0; mixed_ && i < lines_.size() && rows < looked_at; ++i) {
      const LineShape shape = line_shape(lines_[i], style_);
      if (shape.width != width_) continue;
      ++rows;
      for (std::size_t c = 0; c < width_; ++c) {
        words[c] += shape.kinds[c] == 't' ? 1 : 0;
        numbers[c] += shape.kinds[c] == 'n' ? 1 : 0;
      }
    }
    for (std::size_t c = 0; c < width_; ++c) text_[c] = words[c] > numbers[c] ? 1 : 0;
  }

  void note_text_columns(ImportTable& table) const {
    std::string list;
    for (std::size_t c = 0; c < width_; ++c) {
      if (text_[c] != 0) list += fmt::format("{}{} (column {})", list.empty() ? "" : ", ", table.names[c], c + 1);
    }
    if (list.empty()) return;
    table.text.assign(text_.begin(), text_.end());
    table.notes.push_back(fmt::format("{}: text, left out: {}", source_, list));
  }

  // Names: as many fields as the rows, none of them a number. The first or some others may be empty, as the column of
  // row numbers is that many programs write. One name less than columns where the first counts the rows (R).
  [[nodiscard]] bool are_names(const TextFields& fields) const {
    std::size_t named = 0;
    for (const auto field : fields) {
      if (field.empty()) continue;
      const auto value = value_of(field);
      if (value && !std::isnan(*value)) return false;
      ++named;
    }
    return 2 * named >= fields.size() && named > 0;
  }

  [[nodiscard]] TextFields names_in(std::string_view line) const {
    TextFields fields = text_fields(line, style_.separator);
    if (fields.size() == width_) return fields;
    // They may be listed with blanks or commas above rows that are separated otherwise: where most of them are words
    // that columns have.
    for (const char separator : {',', ';', '\t', ' '}) {
      TextFields other = text_fields(line, separator);
      if (other.size() == width_ && separator != style_.separator && most_are_column_names(other)) return other;
    }
    return fields;
  }

  // From the line before the numbers, a comment or not, where it has as many fields; units may stand between.
  void name_columns(ImportTable& table) {
    if (!layout_.names.empty()) {
      if (layout_.names.size() != width_) {
        throw BadData(fmt::format("{}: line {} has {} columns where the map names {}", source_, first_ + 1, width_,
                                  layout_.names.size()));
      }
      table.names = layout_.names;
      return;
    }
    if (motive_line_ < lines_.size()) {
      name_motive_columns(lines_, motive_line_, table);
      if (table.names.size() == width_) return;
      table.names.clear(), table.described.clear();
    }
    skip_numbered_names(table);
    bool adjacent = true;  // nothing but comments stands between
    TextFields units;      // of the line below the names, or of JPK's own
    for (std::size_t i = first_, seen = 0; i-- > 0 && seen < 12;) {
      std::string_view line = without_blanks(lines_[i]);
      if (line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);
      if (line.empty()) continue;
      ++seen;
      const auto sign = comment_of(line, layout_.comment);
      if (!sign.empty()) line = without_blanks(line.substr(sign.size()));
      if (sign.empty()) line = lines_[i].starts_with("\xef\xbb\xbf") ? line : lines_[i];  // a tab at its begin counts
      if (line.starts_with("columns:")) line = without_blanks(line.substr(8));            // JPK
      if (line.starts_with("units:")) {
        units = text_fields(without_blanks(line.substr(6)), style_.separator);
        continue;
      }
      TextFields fields = names_in(line);
      if (split_from_row(fields)) {
        table.notes.push_back(fmt::format(
            "{}: line {} holds the names and, without a break between them, a row, which is left out", source_, i + 1));
      }
      if (sign.empty() && fields.size() + 1 == width_ && is_counted(0)) fields.insert(fields.begin(), "row");
      if (fields.size() + 1 == width_ && is_empty(width_ - 1)) fields.emplace_back();
      if (fields.size() != width_ || !are_names(fields)) {
        if (sign.empty() && 2 * fields.size() == width_ && style_.separator == ',' && are_names(fields)) {
          throw BadData(
              fmt::format("{}: line {} names {} columns, but line {} has {} fields: are its decimal signs "
                          "commas, as its separators are? Write points, or semicolons between the columns",
                          source_, i + 1, fields.size(), first_ + 1, width_));
        }
        // JPK's own lines, which stand between its names and the numbers, and other instruments'.
        adjacent = adjacent && !sign.empty();
        continue;
      }
      if (!adjacent && !most_are_column_names(fields)) continue;
      if (units.empty() && std::ranges::all_of(fields, is_unit_field) && names_above(i)) {
        units = fields;
        continue;
      }
      take_names(fields, units, i, table);
      return;
    }
    for (std::size_t c = 0; c < width_; ++c) table.names.push_back(fmt::format("c{}", c + 1));
    table.notes.push_back(fmt::format("{}: no line names the columns; they are c1 to c{}", source_, width_));
  }

  void take_names(const TextFields& fields, const TextFields& units, std::size_t line, ImportTable& table) {
    names_line_ = line;
    for (std::size_t c = 0; c < width_; ++c) {
      table.names.push_back(fields[c].empty() ? fmt::format("c{}", c + 1) : std::string(fields[c]));
      const std::string_view unit = units.size() == width_ ? units[c] : std::string_view{};
      table.described.push_back(name_with_unit(table.names.back(), unit, is_time_of_day(c)));
    }
    table.names_from_file = true;
  }

  [[nodiscard]] bool names_above(std::size_t line) const {
    if (line == 0) return false;
    const std::string_view above = lines_[line - 1];
    const auto sign = comment_of(without_blanks(above), layout_.comment);
    const TextFields fields =
        names_in(sign.empty() ? above : without_blanks(without_blanks(above).substr(sign.size())));
    return fields.size() == width_ && are_names(fields);
  }

  // A first row of 0, 1, 2, ... names columns by their numbers, as pandas does where they have no names.
  void skip_numbered_names(ImportTable& table) {
    const TextFields fields = text_fields(lines_[first_], style_.separator);
    constexpr std::size_t fewest = 4;
    const std::size_t begin = fields.front().empty() ? 1 : 0;
    if (width_ < fewest) return;
    for (std::size_t c = begin; c < width_; ++c) {
      if (fields[c] != std::to_string(c - begin)) return;
    }
    table.notes.push_back(fmt::format("{}: line {} numbers the columns and is no row", source_, first_ + 1));
    ++first_;
  }

  [[nodiscard]] std::vector<std::size_t> first_rows() const {
    std::vector<std::size_t> rows;
    constexpr std::size_t enough = 20;
    for (std::size_t i = first_; i < lines_.size() && rows.size() < enough; ++i) {
      if (text_fields(lines_[i], style_.separator).size() == width_) rows.push_back(i);
    }
    return rows;
  }

  [[nodiscard]] bool is_counted(std::size_t c) const {
    std::vector<double> values;
    for (const std::size_t i : first_rows()) {
      values.push_back(value_of(text_fields(lines_[i], style_.separator)[c]).value_or(0.0));
    }
    return counts_rows(values) && (values.front() == 0.0 || values.front() == 1.0);
  }

  [[nodiscard]] bool is_time_of_day(std::size_t c) const {
    const std::string_view field = text_fields(lines_[first_], style_.separator)[c];
    return text_[c] == 0 && text_time_s(field, style_.decimal).has_value();
  }

  [[nodiscard]] bool is_empty(std::size_t c) const {
    return std::ranges::all_of(first_rows(),
                               [&](std::size_t i) { return text_fields(lines_[i], style_.separator)[c].empty(); });
  }

  // A comma at each line's end makes a column of nothing.
  void drop_empty_last_column(ImportTable& table) const {
    const bool unnamed = table.names.back() == fmt::format("c{}", width_);
    if (width_ < 2 || !unnamed || !table.names_from_file || !is_empty(width_ - 1)) return;
    if (std::ranges::any_of(table.columns.back(), [](double v) { return !std::isnan(v); })) return;
    table.names.pop_back();
    table.columns.pop_back();
    if (!table.described.empty()) table.described.pop_back();
    if (!table.text.empty()) table.text.pop_back();
  }

  // A writer that forgot the end of the line of names: "force<tab>time0.5<tab>7" has its last name and the first number
  // in one field. Keeps the names alone.
  bool split_from_row(TextFields& fields) const {
    if (width_ < 2 || fields.size() != 2 * width_ - 1) return false;
    for (std::size_t c = 0; c < fields.size(); ++c) {
      const bool number = !fields[c].empty() && value_of(fields[c]).has_value();
      if (c != width_ - 1 && number != (c >= width_)) return false;
    }
    std::string_view& glued = fields[width_ - 1];
    const auto number_at = glued.find_first_of("+-0123456789");
    if (number_at == 0 || number_at == std::string_view::npos || !value_of(glued.substr(number_at))) {
      return false;
    }
    glued = glued.substr(0, number_at);
    fields.resize(width_);
    return true;
  }

  void keep_head(ImportTable& table) const {
    constexpr std::size_t most_lines = 200, longest = 2000;
    for (std::size_t i = 0; i < std::min(first_, most_lines); ++i) {
      if (i != names_line_) table.head.emplace_back(lines_[i].substr(0, longest));
    }
  }

  void read_rows(ImportTable& table) {
    bool broken = false;  // comment lines or a header since the last row
    segments_ = 1;
    for (std::size_t i = first_; i < lines_.size(); ++i) {
      const std::string_view line = without_blanks(lines_[i]);
      if (line.empty()) continue;
      if (!comment_of(line, layout_.comment).empty()) {
        ++skipped_;
        broken = true;
        continue;
      }
      if (labview_ && text_fields(lines_[i], style_.separator).front() == "Channels") {
        i = end_of_segment_header(i);
        broken = true;
        continue;
      }
      // A logger that was started again writes its names again.
      if (names_line_ < first_ && lines_[i] == lines_[names_line_]) {
        broken = true;
        continue;
      }
      if (line_shape(lines_[i], style_).numbers == 0 && nothing_follows(i)) {
        table.notes.push_back(fmt::format("{}: the table ends before line {}; {} lines behind it are left out", source_,
                                          i + 1, lines_.size() - i));
        break;
      }
      if (broken) ++segments_;
      broken = false;
      add_row(table, i);
      segment_.push_back(static_cast<double>(segments_ - 1));
    }
  }

  // Whether no line from here on holds a number: what a program writes behind its table.
  [[nodiscard]] bool nothing_follows(std::size_t i) const {
    for (; i < lines_.size(); ++i) {
      if (line_shape(lines_[i], style_).numbers > 0) return false;
    }
    return true;
  }

  // The line of names that ends the header of a LabVIEW segment, which begins at line `begin`.
  [[nodiscard]] std::size_t end_of_segment_header(std::size_t begin) const {
    std::size_t i = begin;
    while (i < lines_.size() && !without_blanks(lines_[i]).starts_with("***End_of_Header***")) ++i;
    for (++i; i < lines_.size(); ++i) {
      if (!without_blanks(lines_[i]).empty()) return i;
    }
    throw BadData(
        fmt::format("{}: line {}: the header of a segment begins here and does not end: was the file cut short?",
                    source_, begin + 1));
  }

  void add_row(ImportTable& table, std::size_t i) {
    const auto fields = text_fields(lines_[i], style_.separator);
    if (fields.size() != width_) {
      throw BadData(fmt::format("{}: line {} has {} values where the lines before have {}{}", source_, i + 1,
                                fields.size(), width_,
                                i + 1 == lines_.size() ? "; was the file cut short?" : "; what does it hold?"));
    }
    if (cut_ && i + 1 == lines_.size() && fields.back().empty()) {
      throw BadData(fmt::format("{}: line {}, the last, ends before column {} ({}): was the file cut short?", source_,
                                i + 1, width_, table.names.back()));
    }
    for (std::size_t c = 0; c < width_; ++c) {
      const auto value = text_[c] != 0 ? std::optional(std::numeric_limits<double>::quiet_NaN()) : value_of(fields[c]);
      if (!value) {
        throw BadData(fmt::format("{}: line {}, column {} ({}): '{}' is not a number", source_, i + 1, c + 1,
                                  table.names[c], shown_field(fields[c])));
      }
      table.columns[c].push_back(*value);
    }
  }

  std::string source_;
  std::vector<std::string_view> lines_;
  const TextLayout& layout_;
  bool labview_ = false;
  bool mixed_ = false;  // the rows hold text among the numbers
  bool cut_ = false;    // the last line has no end
  TextStyle style_{',', '.', "comma"};
  std::size_t width_ = 0, first_ = 0, skipped_ = 0, segments_ = 1;
  std::size_t motive_line_ = 0;
  std::size_t names_line_ = std::numeric_limits<std::size_t>::max();
  std::vector<char> text_;  // of each column
  std::vector<double> segment_;
};

}  // namespace

ImportTable read_text_lines(const std::string& source, std::string_view lines, const TextLayout& layout) {
  return Reader(source, lines, layout).read();
}

}  // namespace touchstone::importing
