// How tables of text are written: lines, fields, numbers. RFC 4180's quotes; decimal points and commas, with thousands
// where both signs stand in one number; Fortran's D exponents; the words by which programs say that a value is missing.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::importing {

struct TextStyle {
  char separator;  // ' ': any run of blanks
  char decimal;
  const char* separator_name;
  bool thousands = false;  // whole numbers are grouped by the other sign: 1.234 beside 998
};
// In the order of preference among those that give as many columns.
inline constexpr std::array text_styles{TextStyle{'\t', '.', "tab"},      TextStyle{'\t', ',', "tab"},
                                        TextStyle{';', '.', "semicolon"}, TextStyle{';', ',', "semicolon"},
                                        TextStyle{',', '.', "comma"},     TextStyle{' ', '.', "space"},
                                        TextStyle{' ', ',', "space"},     TextStyle{',', ',', "comma"}};

using TextFields = std::vector<std::string_view>;

// Ended by LF, CR LF, or CR where there is no LF.
std::vector<std::string_view> text_lines(std::string_view text);
std::string_view without_blanks(std::string_view text);
// Without the quotes around them; a separator within quotes separates nothing.
TextFields text_fields(std::string_view line, char separator);
// "17:18:18.938" and "5:18:18.938 PM" in seconds of the day, with a date before it that does not say which is the month
// ("3/5/2024") too; "2024-03-05T17:18:18.9Z" (ISO 8601, a blank for the T, an offset) in seconds since 1970; nothing
// for other text.
std::optional<double> text_time_s(std::string_view field, char decimal);
// What begins the line as a comment: the sign `given`, else one of #, %, //, !; empty where it is none.
std::string_view comment_of(std::string_view line, const std::string& given);
// For a message: cut short and printable.
std::string shown_field(std::string_view text);
// A number, a time, a truth value, or NaN where it is missing; no value where the field is text. `thousands`: signs
// that are not decimal group whole numbers too.
std::optional<double> text_value(std::string_view field, char decimal, bool thousands = false);
// "1.234", "-12.345.678" where `mark` is the point: digits that may be in groups, of which the first does not begin
// with zero.
bool may_be_thousands(std::string_view field, char mark);

// How the fields of a column use the sign that a style takes for the decimal one.
struct MarkUse {
  std::size_t groups = 0, decimals = 0, hundreds = 0;  // such as 1.234, 0.5, 998
  std::string_view example, plain;                     // of the first and the last kind

  // Nobody writes numbers with three decimals or none and never with one, two or four.
  [[nodiscard]] bool of_thousands() const { return groups > 0 && hundreds > 0 && decimals == 0; }
};
// Counts the fields of a line, if it has as many as `uses`.
void note_marks(std::string_view line, const TextStyle& style, std::vector<MarkUse>& uses);

// What a line is in a style.
struct LineShape {
  std::size_t width = 0, numbers = 0;
  std::vector<char> kinds;  // of each field: 'n' number, 't' text, '-' missing

  [[nodiscard]] bool has_text() const;
  // Of as many fields, none of them a number in one and text in the other.
  [[nodiscard]] bool goes_with(const LineShape& other) const;
};
LineShape line_shape(std::string_view line, const TextStyle& style);

}  // namespace touchstone::importing
