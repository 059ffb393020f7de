// Tables of text as loggers and instruments write them: CSV without a header, decimal commas, comments, metadata before
// the numbers, blank lines after them, LabVIEW measurements (.lvm), JPK and AFM Workshop curves, logs of the Net F/T
// demo. The layout is found from the lines that hold numbers.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/importing/import_table.h"

namespace touchstone::importing {
namespace {

struct Style {
  char separator;  // ' ': any run of blanks
  char decimal;
  const char* separator_name;
};
// In the order of preference among those that give as many columns.
constexpr std::array styles{Style{'\t', '.', "tab"},      Style{'\t', ',', "tab"},  Style{';', '.', "semicolon"},
                            Style{';', ',', "semicolon"}, Style{',', '.', "comma"}, Style{' ', '.', "space"},
                            Style{' ', ',', "space"}};
constexpr std::array<std::string_view, 4> comment_signs{"#", "%", "//", "!"};

std::string_view stripped(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const auto from = text.find_first_not_of(blanks);
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(blanks) - from + 1);
}

std::vector<std::string_view> fields_of(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  if (separator == ' ') {
    while (!(line = stripped(line)).empty()) {
      const auto end = std::min(line.find_first_of(" \t"), line.size());
      fields.push_back(line.substr(0, end));
      line.remove_prefix(end);
    }
    return fields;
  }
  for (;;) {
    const auto at = line.find(separator);
    fields.push_back(stripped(line.substr(0, at)));
    if (at == std::string_view::npos) return fields;
    line.remove_prefix(at + 1);
  }
}

// A number, a truth value, or nothing (NaN); no value where the field is text.
std::optional<double> value_of(std::string_view field, char decimal) {
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
  if (field.empty()) return std::numeric_limits<double>::quiet_NaN();
  if (field == "True" || field == "true" || field == "TRUE") return 1.0;
  if (field == "False" || field == "false" || field == "FALSE") return 0.0;
  if (field.starts_with("0x") || field.starts_with("0X")) {
    std::uint64_t bits = 0;
    const auto [end, status] = std::from_chars(field.data() + 2, field.data() + field.size(), bits, 16);
    if (status == std::errc{} && end == field.data() + field.size()) return static_cast<double>(bits);
    return std::nullopt;
  }
  std::string text(field);
  if (decimal == ',') {
    if (text.find('.') != std::string::npos) return std::nullopt;
    std::ranges::replace(text, ',', '.');
  }
  const char* const start = text.data() + (text.front() == '+' ? 1 : 0);
  double value = 0.0;
  const auto [end, status] = std::from_chars(start, text.data() + text.size(), value);
  if (end != text.data() + text.size() || (status != std::errc{} && status != std::errc::result_out_of_range)) {
    return std::nullopt;
  }
  return value;
}

// How many columns a line has in a style; 0 where a field is text or all are empty.
std::size_t columns_of(std::string_view line, const Style& style) {
  auto fields = fields_of(line, style.separator);
  bool any = false;
  for (const auto field : fields) {
    const auto value = value_of(field, style.decimal);
    if (!value) return 0;
    any = any || !std::isnan(*value);
  }
  return any ? fields.size() : 0;
}

std::string_view comment_of(std::string_view line, const std::string& given) {
  if (!given.empty()) return line.starts_with(given) ? std::string_view(given) : std::string_view{};
  for (const auto sign : comment_signs) {
    if (line.starts_with(sign)) return sign;
  }
  return {};
}

std::string shown_field(std::string_view text) {
  std::string result;
  for (const char c : text.substr(0, 40)) {
    result += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  }
  return text.size() > 40 ? result + "..." : result;
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const auto end = text.find('\n');
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
  return lines;
}

// LabVIEW measurements (NI's specification of .lvm): a head, then segments of a header ("Channels" to
// "***End_of_Header***"), a line of names whose last is "Comment", and rows. A row may have a comment of any text, or
// no field for it; without them rows are numbers. Lines before the first names are left as they are.
void drop_lvm_comments(std::vector<std::string_view>& lines) {
  char separator = '\t';
  std::size_t columns = 0;  // of numbers; 0 within a header
  for (std::string_view& line : lines) {
    const auto fields = fields_of(line, separator);
    if (fields.front() == "Separator,Comma") separator = ',';
    if (fields.front() == "Channels") columns = 0;
    if (fields.front() == "X_Value" && fields.back() == "Comment") columns = fields.size() - 1;
    if (columns == 0 || fields.size() <= columns) continue;
    std::size_t end = line.find(separator);
    for (std::size_t c = 1; c < columns; ++c) end = line.find(separator, end + 1);
    line = line.substr(0, end);
  }
}

class Reader {
 public:
  Reader(std::string source, std::string_view text, const TextLayout& layout)
      : source_(std::move(source)), lines_(lines_of(text)), layout_(layout) {
    labview_ = !lines_.empty() && stripped(lines_.front()).starts_with("LabVIEW Measurement");
    if (labview_) drop_lvm_comments(lines_);
    cut_ = !text.ends_with('\n');
  }

  ImportTable read() {
    choose_style();
    ImportTable table;
    table.source = source_;
    table.columns.resize(width_);
    table.format = fmt::format("{}: separator {}, decimal {}", labview_ ? "LabVIEW measurement" : "text table",
                               style_.separator_name, style_.decimal == ',' ? "comma" : "point");
    name_columns(table);
    read_rows(table);
    if (cut_) {
      table.notes.push_back(fmt::format(
          "{}: line {}, the last, has no end: if the file was cut short, its last number is", source_, lines_.size()));
    }
    if (first_ > 0) table.notes.push_back(fmt::format("{}: {} lines before the numbers were skipped", source_, first_));
    if (skipped_ > 0) table.notes.push_back(fmt::format("{}: {} comment lines among the numbers", source_, skipped_));
    if (segments_ > 1) {
      table.names.emplace_back("segment");
      table.columns.push_back(std::move(segment_));
      table.notes.push_back(fmt::format("{}: {} segments, counted in the column 'segment'", source_, segments_));
    }
    return table;
  }

 private:
  [[nodiscard]] bool fits(const Style& style) const {
    const bool separator = layout_.separator.empty() || layout_.separator == style.separator_name;
    const bool decimal = layout_.decimal.empty() || (layout_.decimal == "comma") == (style.decimal == ',');
    return separator && decimal;
  }

  // The style and place at which the most lines in a row hold numbers, of equally many columns.
  void choose_style() {
    constexpr std::size_t enough = 50;
    std::size_t best = 0;
    for (const Style& style : styles) {
      if (!fits(style)) continue;
      std::size_t run = 0, width = 0, begin = 0;
      for (std::size_t i = 0; i < lines_.size() && run < enough; ++i) {
        const std::string_view line = stripped(lines_[i]);
        if (line.empty() || !comment_of(line, layout_.comment).empty()) continue;
        const std::size_t columns = columns_of(lines_[i], style);
        if (columns == 0 || columns != width) run = 0, width = columns, begin = i;
        if (columns > 0) ++run;
        if (run > 0 && run * 1000 + width > best && run >= std::min<std::size_t>(2, lines_.size())) {
          best = run * 1000 + width;
          style_ = style, width_ = width, first_ = begin;
        }
      }
    }
    if (best == 0) refuse_without_table();
    begin_at_first_rows();
  }

  // No two lines go together. Where one line is a row all the same (of several numbers, in the style that gives the
  // most), its place is said, and that of the line behind it.
  [[noreturn]] void refuse_without_table() const {
    std::size_t most = 1, at = 0;
    const Style* found = nullptr;
    for (const Style& style : styles) {
      for (std::size_t i = 0; fits(style) && i < lines_.size(); ++i) {
        if (!comment_of(stripped(lines_[i]), layout_.comment).empty()) continue;
        const std::size_t columns = columns_of(lines_[i], style);
        if (columns > most) most = columns, at = i, found = &style;
      }
    }
    std::string message = fmt::format(
        "{}: holds no table of numbers: no two lines of text have the same count of numbers, separated by tabs, "
        "semicolons, commas or blanks",
        source_);
    if (found != nullptr) {
      message += fmt::format("; line {} has {} (separator {})", at + 1, most, found->separator_name);
      std::size_t next = at + 1;
      while (next < lines_.size() && stripped(lines_[next]).empty()) ++next;
      if (next < lines_.size()) {
        message += fmt::format(", line {} has {} values", next + 1, fields_of(lines_[next], found->separator).size());
      } else {
        message += ", and is the last";
      }
      message += ": was the file cut short?";
    }
    throw BadData(message);
  }

  // A line that is no row may cut the rows in two, of which the second is longer: the table begins with the first rows,
  // and that line is then refused with its place.
  void begin_at_first_rows() {
    std::size_t rows = 0, begin = 0;
    for (std::size_t i = 0; i < first_; ++i) {
      if (stripped(lines_[i]).empty() || !comment_of(lines_[i], layout_.comment).empty()) continue;
      if (columns_of(lines_[i], style_) != width_) {
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

  // From the line before the numbers, a comment or not, where it has as many fields.
  void name_columns(ImportTable& table) {
    if (!layout_.names.empty()) {
      if (layout_.names.size() != width_) {
        throw BadData(fmt::format("{}: line {} has {} columns where the map names {}", source_, first_ + 1, width_,
                                  layout_.names.size()));
      }
      table.names = layout_.names;
      return;
    }
    for (std::size_t i = first_, seen = 0; i-- > 0 && seen < 12;) {
      std::string_view line = stripped(lines_[i]);
      if (line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);
      if (line.empty()) continue;
      ++seen;
      const auto sign = comment_of(line, layout_.comment);
      line = stripped(line.substr(sign.size()));
      if (line.starts_with("columns:")) line = stripped(line.substr(8));  // JPK
      auto fields = fields_of(line, style_.separator);
      if (split_from_row(fields)) {
        table.notes.push_back(fmt::format(
            "{}: line {} holds the names and, without a break between them, a row, which is left out", source_, i + 1));
      }
      const bool text =
          std::ranges::all_of(fields, [&](std::string_view f) { return !f.empty() && !value_of(f, style_.decimal); });
      if (fields.size() != width_ || !text) {
        // JPK's own lines, which stand between its names and the numbers, and LabVIEW's.
        if (!sign.empty()) continue;
        break;
      }
      for (const auto field : fields) table.names.emplace_back(field);
      table.names_from_file = true;
      return;
    }
    for (std::size_t c = 0; c < width_; ++c) table.names.push_back(fmt::format("c{}", c + 1));
    table.notes.push_back(fmt::format("{}: no line names the columns; they are c1 to c{}", source_, width_));
  }

  // A writer that forgot the end of the line of names: "force<tab>time0.5<tab>7" has its last name and the first number
  // in one field. Keeps the names alone.
  bool split_from_row(std::vector<std::string_view>& fields) const {
    if (width_ < 2 || fields.size() != 2 * width_ - 1) return false;
    for (std::size_t c = 0; c < fields.size(); ++c) {
      const bool number = !fields[c].empty() && value_of(fields[c], style_.decimal).has_value();
      if (c != width_ - 1 && number != (c >= width_)) return false;
    }
    std::string_view& glued = fields[width_ - 1];
    const auto number_at = glued.find_first_of("+-0123456789");
    if (number_at == 0 || number_at == std::string_view::npos || !value_of(glued.substr(number_at), style_.decimal)) {
      return false;
    }
    glued = glued.substr(0, number_at);
    fields.resize(width_);
    return true;
  }

  void read_rows(ImportTable& table) {
    bool broken = false;  // comment lines or a header since the last row
    segments_ = 1;
    for (std::size_t i = first_; i < lines_.size(); ++i) {
      const std::string_view line = stripped(lines_[i]);
      if (line.empty()) continue;
      if (!comment_of(line, layout_.comment).empty()) {
        ++skipped_;
        broken = true;
        continue;
      }
      if (labview_ && fields_of(lines_[i], style_.separator).front() == "Channels") {
        i = end_of_segment_header(i);
        broken = true;
        continue;
      }
      if (broken) ++segments_;
      broken = false;
      add_row(table, i);
      segment_.push_back(static_cast<double>(segments_ - 1));
    }
  }

  // The line of names that ends the header of a LabVIEW segment, which begins at line `begin`.
  [[nodiscard]] std::size_t end_of_segment_header(std::size_t begin) const {
    std::size_t i = begin;
    while (i < lines_.size() && !stripped(lines_[i]).starts_with("***End_of_Header***")) ++i;
    for (++i; i < lines_.size(); ++i) {
      if (!stripped(lines_[i]).empty()) return i;
    }
    throw BadData(
        fmt::format("{}: line {}: the header of a segment begins here and does not end: was the file cut short?",
                    source_, begin + 1));
  }

  void add_row(ImportTable& table, std::size_t i) {
    const auto fields = fields_of(lines_[i], style_.separator);
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
      const auto value = value_of(fields[c], style_.decimal);
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
  bool cut_ = false;  // the last line has no end
  Style style_{',', '.', "comma"};
  std::size_t width_ = 0, first_ = 0, skipped_ = 0, segments_ = 1;
  std::vector<double> segment_;
};

}  // namespace

ImportTable read_text_table(const std::filesystem::path& path, const TextLayout& layout) {
  const std::string text = read_file(path);
  if (text.empty()) throw BadData(fmt::format("{}: is empty; a table of numbers was expected", path.string()));
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
    throw BadData(fmt::format("{}: is UTF-16 text; save it as UTF-8 or ASCII", path.string()));
  }
  if (std::string_view(text).substr(0, 4096).find('\0') != std::string_view::npos) {
    throw BadData(
        fmt::format("{}: is a binary file of no kind that can be read: text tables, MATLAB .mat, ROS bags "
                    "(.bag, .db3) and HDF5 can",
                    path.string()));
  }
  return Reader(path.string(), text, layout).read();
}

}  // namespace touchstone::importing
