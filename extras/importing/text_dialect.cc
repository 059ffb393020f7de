#include "text_dialect.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <system_error>

namespace touchstone::importing {
namespace {

// Of spreadsheets, R, databases, Visual C (1.#QNAN) and testers' exports.
constexpr std::array<std::string_view, 24> missing_words{
    "NA",     "N/A",     "n/a",     "#N/A",    "NULL",    "null",     "None",    "none",
    "nil",    "-",       "--",      "---",     "1.#QNAN", "-1.#QNAN", "1.#IND",  "-1.#IND",
    "1.#INF", "-1.#INF", "#VALUE!", "#DIV/0!", "Nan",     "NaN(ind)", "missing", "?"};

constexpr std::array<std::string_view, 4> comment_signs{"#", "%", "//", "!"};

bool is_digit_sign(char c) { return c >= '0' && c <= '9'; }

// Digits in groups of three, "1.234.567": true if `text` up to `end` is that.
bool grouped(std::string_view text, char mark) {
  std::size_t begin = !text.empty() && (text.front() == '-' || text.front() == '+') ? 1 : 0;
  constexpr std::size_t group = 3;
  std::size_t at = text.find(mark);
  if (at == begin || at == std::string_view::npos || at - begin > group) return false;
  for (std::size_t i = begin; i < text.size(); ++i) {
    if (!is_digit_sign(text[i]) && text[i] != mark) return false;
  }
  while (at != std::string_view::npos) {
    const std::size_t next = std::min(text.find(mark, at + 1), text.size());
    if (next - at - 1 != group) return false;
    at = next == text.size() ? std::string_view::npos : next;
  }
  return true;
}

// A number with both signs, or (`whole`) the other alone: the one that groups is taken out. False where they stand
// otherwise.
bool without_thousands(std::string& text, char decimal, bool whole) {
  const char mark = decimal == ',' ? '.' : ',';
  if (text.find(mark) == std::string::npos) return true;
  const auto point = text.find(decimal);
  if (point == std::string::npos && !whole) return false;
  if (!grouped(std::string_view(text).substr(0, point), mark)) return false;
  std::erase(text, mark);
  return true;
}

// "3/5/2024 " or "05.03.24 ", whose order of day and month is not known, away.
std::string_view without_local_date(std::string_view field) {
  constexpr std::size_t longest_date = 10, longest_day = 2;
  const auto blank = field.find(' ');
  if (blank > longest_date) return field;  // there is none, or it is none of a date
  const std::string_view date = field.substr(0, blank);
  const auto first = date.find_first_of("/.-");
  if (first > longest_day || std::ranges::count(date, date[first]) != 2) return field;
  const bool numbers = std::ranges::all_of(date, [&](char c) { return is_digit_sign(c) || c == date[first]; });
  return numbers ? without_blanks(field.substr(blank)) : field;
}

}  // namespace

std::vector<std::string_view> text_lines(std::string_view text) {
  const char end_of_line = text.find('\n') == std::string_view::npos ? '\r' : '\n';
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const auto end = text.find(end_of_line);
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
  return lines;
}

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const auto from = text.find_first_not_of(blanks);
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(blanks) - from + 1);
}

TextFields text_fields(std::string_view line, char separator) {
  TextFields fields;
  const bool blanks = separator == ' ';
  if (blanks) line = without_blanks(line);
  while (!blanks || !line.empty()) {
    const auto begin = line.find_first_not_of(separator == '\t' ? " " : " \t");
    if (begin != std::string_view::npos && line[begin] == '"') {
      // A quote that ends before a separator encloses the field; within it two stand for one.
      std::size_t close = line.find('"', begin + 1);
      while (close != std::string_view::npos && close + 1 < line.size() && line[close + 1] == '"') {
        close = line.find('"', close + 2);
      }
      const auto rest =
          close == std::string_view::npos ? close : line.find_first_not_of(separator == '\t' ? " " : " \t", close + 1);
      const bool encloses = close != std::string_view::npos &&
                            (rest == std::string_view::npos || line[rest] == separator || (blanks && rest > close + 1));
      if (encloses) {
        fields.push_back(without_blanks(line.substr(begin + 1, close - begin - 1)));
        if (rest == std::string_view::npos) return fields;
        line.remove_prefix(blanks ? rest : rest + 1);
        continue;
      }
    }
    const auto at = blanks ? line.find_first_of(" \t") : line.find(separator);
    fields.push_back(without_blanks(line.substr(0, at)));
    if (at == std::string_view::npos) return fields;
    line.remove_prefix(at + 1);
    if (blanks) line = without_blanks(line);
  }
  return fields;
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

std::optional<double> text_time_s(std::string_view field, char decimal) {
  field = without_local_date(field);
  const bool after_noon = field.ends_with("PM") || field.ends_with("pm");
  const bool twelve_hours = after_noon || field.ends_with("AM") || field.ends_with("am");
  if (twelve_hours) field = without_blanks(field.substr(0, field.size() - 2));
  const auto number = [&](std::size_t from, std::size_t size, int& out) {
    if (from + size > field.size()) return false;
    const auto [end, status] = std::from_chars(field.data() + from, field.data() + from + size, out);
    return status == std::errc{} && end == field.data() + from + size && out >= 0;
  };
  int year = 0, month = 0, day = 0;
  double days = 0.0;
  if (field.size() > 18 && field[4] == '-' && field[7] == '-' && (field[10] == 'T' || field[10] == ' ')) {
    if (!number(0, 4, year) || !number(5, 2, month) || !number(8, 2, day)) return std::nullopt;
    const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                           std::chrono::day(static_cast<unsigned>(day))};
    if (!date.ok()) return std::nullopt;
    days = std::chrono::sys_days(date).time_since_epoch().count();
    field.remove_prefix(11);
  }
  const std::size_t hours_size = field.size() > 1 && field[1] == ':' ? 1 : 2;
  int hours = 0, minutes = 0, seconds = 0;
  constexpr int most_hours = 24, sixty = 60;
  const std::size_t behind = hours_size + 6;
  if (field.size() < behind || field[hours_size] != ':' || field[hours_size + 3] != ':') return std::nullopt;
  if (!number(0, hours_size, hours) || !number(hours_size + 1, 2, minutes) || !number(hours_size + 4, 2, seconds)) {
    return std::nullopt;
  }
  if (hours >= most_hours || minutes >= sixty || seconds > sixty) return std::nullopt;
  constexpr int noon = 12;
  if (twelve_hours && (hours < 1 || hours > noon)) return std::nullopt;
  if (twelve_hours) hours = hours % noon + (after_noon ? noon : 0);
  field.remove_prefix(behind);
  double part = 0.0;
  if (!field.empty() && (field.front() == '.' || field.front() == decimal)) {
    double unit = 0.1;
    for (field.remove_prefix(1); !field.empty() && is_digit_sign(field.front()); field.remove_prefix(1), unit /= 10.0) {
      part += unit * (field.front() - '0');
    }
  }
  if (field == "Z") field.remove_prefix(1);
  int offset_hours = 0, offset_minutes = 0;
  if (year > 0 && field.size() == 6 && (field[0] == '+' || field[0] == '-') && field[3] == ':') {
    if (!number(1, 2, offset_hours) || !number(4, 2, offset_minutes)) return std::nullopt;
    if (field[0] == '-') offset_hours = -offset_hours, offset_minutes = -offset_minutes;
    field = {};
  }
  if (!field.empty()) return std::nullopt;
  return 86400.0 * days + 3600.0 * (hours - offset_hours) + 60.0 * (minutes - offset_minutes) + seconds + part;
}

bool may_be_thousands(std::string_view field, char mark) {
  const auto first = field.find_first_of("0123456789");
  return first != std::string_view::npos && field[first] != '0' && grouped(field, mark);
}

std::optional<double> text_value(std::string_view field, char decimal, bool thousands) {
  if (field.empty() || std::ranges::find(missing_words, field) != missing_words.end()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  if (field == "True" || field == "true" || field == "TRUE") return 1.0;
  if (field == "False" || field == "false" || field == "FALSE") return 0.0;
  if (field.starts_with("0x") || field.starts_with("0X")) {
    std::uint64_t bits = 0;
    const auto [end, status] = std::from_chars(field.data() + 2, field.data() + field.size(), bits, 16);
    if (status == std::errc{} && end == field.data() + field.size()) return static_cast<double>(bits);
    return std::nullopt;
  }
  if (field.find(':') != std::string_view::npos) return text_time_s(field, decimal);
  std::string text(field);
  constexpr std::string_view typeset_minus = "\xe2\x88\x92";
  if (text.starts_with(typeset_minus)) text.replace(0, typeset_minus.size(), "-");
  if (!without_thousands(text, decimal, thousands)) return std::nullopt;
  if (decimal == ',') std::ranges::replace(text, ',', '.');
  // Fortran: 1.5D-03.
  if (const auto at = text.find_first_of("dD"); at != std::string::npos && at > 0 && at + 1 < text.size()) {
    const bool exponent = (is_digit_sign(text[at - 1]) || text[at - 1] == '.') &&
                          (is_digit_sign(text[at + 1]) || text[at + 1] == '-' || text[at + 1] == '+');
    if (exponent) text[at] = 'e';
  }
  const char* const start = text.data() + (text.front() == '+' ? 1 : 0);
  double value = 0.0;
  const auto [end, status] = std::from_chars(start, text.data() + text.size(), value);
  if (end != text.data() + text.size() || (status != std::errc{} && status != std::errc::result_out_of_range)) {
    return std::nullopt;
  }
  return value;
}

void note_marks(std::string_view line, const TextStyle& style, std::vector<MarkUse>& uses) {
  const TextFields fields = text_fields(line, style.separator);
  constexpr std::size_t three_digits = 3;
  for (std::size_t c = 0; c < uses.size() && fields.size() == uses.size(); ++c) {
    const std::string_view field = fields[c];
    MarkUse& use = uses[c];
    if (may_be_thousands(field, style.decimal)) {
      ++use.groups, use.example = field;
      if (std::ranges::count(field, style.decimal) > 1) ++use.hundreds, use.plain = field;  // decimals have one sign
    } else if (field.find(style.decimal) != std::string_view::npos && text_value(field, style.decimal)) {
      ++use.decimals;
    } else if (field.find_first_not_of("+-0123456789") == std::string_view::npos && field.size() >= three_digits) {
      ++use.hundreds, use.plain = field;
    }
  }
}

bool LineShape::has_text() const { return std::ranges::find(kinds, 't') != kinds.end(); }

bool LineShape::goes_with(const LineShape& other) const {
  if (width != other.width) return false;
  for (std::size_t c = 0; c < width; ++c) {
    if (kinds[c] != other.kinds[c] && kinds[c] != '-' && other.kinds[c] != '-') return false;
  }
  return true;
}

LineShape line_shape(std::string_view line, const TextStyle& style) {
  LineShape shape;
  for (const std::string_view field : text_fields(line, style.separator)) {
    const auto value = text_value(field, style.decimal, style.thousands);
    shape.kinds.push_back(!value ? 't' : std::isnan(*value) ? '-' : 'n');
    shape.numbers += shape.kinds.back() == 'n' ? 1 : 0;
  }
  shape.width = shape.kinds.size();
  return shape;
}

}  // namespace touchstone::importing
