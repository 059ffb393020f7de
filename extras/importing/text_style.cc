#include "text_style.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "harness/base/error.h"

namespace touchstone::importing {
namespace {

struct Run {
  std::size_t score = 0, numbers = 0, width = 0, first = 0;
  std::optional<TextStyle> style;
  bool mixed = false;
};

class StyleChoice {
 public:
  StyleChoice(const std::string& source, const std::vector<std::string_view>& lines, const TextLayout& layout,
              bool commas_alone)
      : source_(source), lines_(lines), layout_(layout), commas_alone_(commas_alone) {}

  // Rows of numbers alone go before rows with text, unless those hold many more numbers: heads have such lines too.
  [[nodiscard]] TextRows choose() const {
    Run pure, mixed;
    for (TextStyle style : text_styles) {
      style.thousands = !layout_.decimal.empty();  // the other sign can be nothing else
      if (!fits(style)) continue;
      longest_run(style, false, pure);
      Run run;
      longest_run(style, true, run);
      if (run.numbers > mixed.numbers) mixed = run;
    }
    constexpr std::size_t many_more = 4;
    Run best = mixed.numbers > many_more * pure.numbers ? mixed : pure;
    prefer_thousands(best);
    if (!best.style) refuse_without_table();
    if (!best.style->thousands) refuse_doubtful_thousands(best);
    return {*best.style, best.width, best.first, best.mixed};
  }

 private:
  [[nodiscard]] bool fits(const TextStyle& style) const {
    const bool separator = layout_.separator.empty() || layout_.separator == style.separator_name;
    const bool decimal = layout_.decimal.empty() || (layout_.decimal == "comma") == (style.decimal == ',');
    return separator && decimal && (!commas_alone_ || style.separator == ',');
  }

  // The most lines in a row that go together: of numbers alone, or (`mixed`) with text in the same columns of each.
  void longest_run(const TextStyle& style, bool mixed, Run& best) const {
    constexpr std::size_t enough = 50;
    std::size_t run = 0, begin = 0;
    LineShape before;
    for (std::size_t i = 0; i < lines_.size() && run < enough; ++i) {
      const std::string_view line = without_blanks(lines_[i]);
      if (line.empty() || !comment_of(line, layout_.comment).empty()) continue;
      LineShape shape = line_shape(lines_[i], style);
      const bool row = shape.numbers > 0 && shape.has_text() == mixed;
      if (!row || run == 0 || (mixed ? !shape.goes_with(before) : shape.width != before.width)) run = 0, begin = i;
      if (row) ++run;
      before = std::move(shape);
      const std::size_t score = run * 1000 + before.width;
      if (row && score > best.score && run >= std::min<std::size_t>(2, lines_.size())) {
        best = {score, run * before.numbers, before.width, begin, style, mixed};
      }
    }
  }

  [[nodiscard]] std::vector<MarkUse> mark_uses(const TextStyle& style, std::size_t width) const {
    std::vector<MarkUse> uses(width);
    for (const std::string_view line : lines_) note_marks(line, style, uses);
    return uses;
  }

  // "998" and "1.001" below one another are 998 and 1001: the sign groups thousands, and the other one is decimal.
  void prefer_thousands(Run& best) const {
    if (!layout_.decimal.empty()) return;
    for (const bool mixed : {false, true}) {
      for (TextStyle style : text_styles) {
        style.thousands = true;
        Run run;
        if (fits(style)) longest_run(style, mixed, run);
        if (!run.style || run.numbers < best.numbers) continue;
        style.decimal = style.decimal == ',' ? '.' : ',';  // as if what groups were decimal
        if (std::ranges::any_of(mark_uses(style, run.width), &MarkUse::of_thousands)) best = run;
      }
    }
  }

  void refuse_doubtful_thousands(const Run& best) const {
    const auto uses = mark_uses(*best.style, best.width);
    const auto found = std::ranges::find_if(uses, &MarkUse::of_thousands),
               other = std::ranges::find_if(uses, [](const MarkUse&use) { return use.decimals > 0; });
    if (found == uses.end()) return;
    throw BadData(fmt::format(
        "{}: column {} holds '{}' and '{}', as where '{}' groups thousands{}: say which it is in the map: \"table\": "
        "{{\"decimal\": \"point\"}} or \"comma\"",
        source_, found - uses.begin() + 1, found->plain, found->example, best.style->decimal,
        other == uses.end() ? "" : fmt::format(", but in column {} it is the decimal sign", other - uses.begin() + 1)));
  }

  // No two lines go together. Where one line is a row all the same (of several numbers, in the style that gives the
  // most), its place is said, and that of the line behind it.
  [[noreturn]] void refuse_without_table() const {
    std::size_t most = 1, at = 0;
    const TextStyle* found = nullptr;
    for (const TextStyle& style : text_styles) {
      for (std::size_t i = 0; fits(style) && i < lines_.size(); ++i) {
        if (!comment_of(without_blanks(lines_[i]), layout_.comment).empty()) continue;
        const LineShape shape = line_shape(lines_[i], style);
        if (!shape.has_text() && shape.numbers > 0 && shape.width > most) most = shape.width, at = i, found = &style;
      }
    }
    std::string message = fmt::format(
        "{}: holds no table of numbers: no two lines that follow one another have as many fields (separated by tabs, "
        "semicolons, commas or blanks) with numbers in the same of them",
        source_);
    if (found != nullptr) {
      message += fmt::format("; line {} has {} (separator {})", at + 1, most, found->separator_name);
      std::size_t next = at + 1;
      while (next < lines_.size() && without_blanks(lines_[next]).empty()) ++next;
      if (next < lines_.size()) {
        message += fmt::format(", line {} has {} values", next + 1, text_fields(lines_[next], found->separator).size());
      } else {
        message += ", and is the last";
      }
      message += ": was the file cut short?";
    }
    throw BadData(message);
  }

  const std::string& source_;
  const std::vector<std::string_view>& lines_;
  const TextLayout& layout_;
  bool commas_alone_;
};

}  // namespace

TextRows choose_text_style(const std::string& source, const std::vector<std::string_view>& lines,
                           const TextLayout& layout, bool commas_alone) {
  return StyleChoice(source, lines, layout, commas_alone).choose();
}

}  // namespace touchstone::importing
