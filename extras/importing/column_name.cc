#include "column_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <span>
#include <utility>

#include "foreign_unit.h"

namespace touchstone::importing {
namespace {

using Words = std::vector<std::string>;

struct Lexeme {
  Quantity quantity;
  std::string_view words;  // with a blank before and behind each
};

// A word is of one quantity; single letters are in `letters`.
constexpr auto lexicon = std::to_array<Lexeme>({
    {Quantity::time,
     " time timestamp timestamps stamp clock elapsed seconds secs sec millis millisec "
     "milliseconds msec micros microseconds usec nsec nsecs nanosec nanoseconds zeit prüfzeit "
     "zeitstempel temps tiempo "},
    {Quantity::count,
     " frame frames sample samples index idx row seq sequence counter count packet record point "
     "nr no number n i id # "},
    {Quantity::position,
     " position positions pos translation trans location loc coordinate coord displacement disp "
     "extension height indentation depth penetration pd stroke travel weg standardweg traverse course "
     "separation "
     "crosshead verticaltipposition "},
    {Quantity::force, " force forces load kraft standardkraft prüfkraft fn vdeflection "},
    {Quantity::torque, " torque torques moment moments drehmoment tau effort trq "},
    {Quantity::quaternion, " quaternion quat orientation orient ori rotation rot "},
    {Quantity::angle, " angle theta "},
    {Quantity::wrench, " wrench ft fts netft "},
    {Quantity::pose, " pose "},
});

// Before an axis, or alone. `t` before an axis is a torque, or the translation of a pose.
struct LetterLexeme {
  char letter;
  std::string_view axes;
  std::array<Quantity, 2> quantities;  // the second `other`: one alone
};
constexpr auto letters = std::to_array<LetterLexeme>({{'f', "xyz", {Quantity::force, Quantity::other}},
                                                      {'p', "xyz", {Quantity::position, Quantity::other}},
                                                      {'m', "xyz", {Quantity::torque, Quantity::other}},
                                                      {'q', "xyzw", {Quantity::quaternion, Quantity::other}},
                                                      {'t', "xyz", {Quantity::torque, Quantity::position}}});

// What makes of a column something else than what was measured, or of another quantity.
constexpr std::string_view others =
    " req request requested ideal velocity velocities vel speed v twist linear angular acceleration accel acc a jerk "
    "gyro gyroscope omega mag magnetometer voltage volt volts power temperature temp pressure error err diff delta "
    "dt difference covariance cov std stddev var variance desired target command commanded cmd reference ref "
    "setpoint des nominal planned expected goal norm magnitude abs resultant rms mean max min peak limit rate dot "
    "derivative offset bias noise predicted virtual strain stress stiffness gain date datum status rpy euler roll "
    "pitch yaw marker quality frequency segment counts cycle energy work width friction fnref axisangle rotvec ";

// Whose, or where, or how handled: a bare axis with these is still a position.
constexpr std::string_view frames =
    " tip tcp tool probe stylus current ee eef end effector hand robot world base object map global local actual "
    "measured meas data field header sensor raw filtered filt msg transform obs state states coordinates axis value "
    "since start series tracker device haptic left right of the smoothed ft fts netft cell body rigid wrist contact "
    "test standard ";

// A frame in which a bare axis might be a force's.
constexpr std::string_view of_wrenches = " ft fts netft wrench wrist ";

// `list` has a blank before and behind each of its words.
bool lists(std::string_view list, std::string_view word) {
  return list.find(" " + std::string(word) + " ") != std::string_view::npos;
}

template <class Items>
bool holds(const Items& items, const auto& item) {
  return std::ranges::find(items, item) != std::end(items);
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](unsigned char c) { return static_cast<char>(c < 0x80 ? std::tolower(c) : c); });
  // Ü, as the names of German testing machines have it.
  for (auto at = result.find("\xc3\x9c"); at != std::string::npos; at = result.find("\xc3\x9c")) {
    result.replace(at, 2, "\xc3\xbc");
  }
  return result;
}

bool is_separator(char c) { return std::string_view("_./:-,;~|\\ \t\"'").find(c) != std::string_view::npos; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_small(char c) { return (c >= 'a' && c <= 'z') || static_cast<unsigned char>(c) >= 0x80; }
bool is_capital(char c) { return c >= 'A' && c <= 'Z'; }
bool is_number(std::string_view word) { return !word.empty() && std::ranges::all_of(word, is_digit); }
bool is_axis(std::string_view word) {
  return word.size() == 1 && std::string_view("xyzw").find(word.front()) != std::string_view::npos;
}

// "TCPForceX1" -> tcp, force, x, 1.
Words words_of(std::string_view text) {
  Words words;
  std::string word;
  const auto end_word = [&] {
    if (!word.empty()) words.push_back(lower(word));
    word.clear();
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (is_separator(c)) {
      end_word();
      continue;
    }
    if (i > 0 && !is_separator(text[i - 1])) {
      const char before = text[i - 1];
      const bool hump =
          is_capital(c) && (is_small(before) || (is_capital(before) && i + 1 < text.size() && is_small(text[i + 1])));
      if (hump || is_digit(c) != is_digit(before)) end_word();
    }
    word += c;
  }
  end_word();
  return words;
}

std::optional<Quantity> quantity_of(std::string_view word) {
  const auto found = std::ranges::find_if(lexicon, [&](const Lexeme& l) { return lists(l.words, word); });
  return found == lexicon.end() ? std::nullopt : std::optional(found->quantity);
}

const LetterLexeme* letter_of(std::string_view word) {
  if (word.size() != 1) return nullptr;
  const auto found = std::ranges::find(letters, word.front(), &LetterLexeme::letter);
  return found == letters.end() ? nullptr : &*found;
}

// "fx" -> f, x; "forcex" -> force, x; "xpos" -> pos, x. Other words stay.
void split_fused(Words& words) {
  Words split;
  for (std::string& word : words) {
    const std::string head = word.substr(0, word.size() - 1), tail = word.substr(1);
    const bool axis_last = word.size() > 1 && is_axis(word.substr(word.size() - 1));
    const bool axis_first = word.size() > 3 && is_axis(word.substr(0, 1));
    const auto* const letter = axis_last ? letter_of(head) : nullptr;
    const bool letter_fits = letter != nullptr && letter->axes.find(word.back()) != std::string_view::npos;
    if (axis_last && !quantity_of(word) &&
        (letter_fits || quantity_of(head) || (lists(others, head) && head.size() < 6))) {
      split.push_back(head);
      split.push_back(word.substr(word.size() - 1));
    } else if (axis_first && quantity_of(tail)) {
      split.push_back(tail);
      split.push_back(word.substr(0, 1));
    } else {
      split.push_back(std::move(word));
    }
  }
  words = std::move(split);
}

// Two words that are one: the sensor's name "force torque"; "load cell"; "end effector".
void join_pairs(Words& words) {
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    const bool sensor = (words[i] == "force" && words[i + 1] == "torque") || (words[i] == "f" && words[i + 1] == "t") ||
                        (words[i] == "load" && words[i + 1] == "cell");
    const bool normal = words[i] == "f" && words[i + 1] == "n";
    if (!sensor && !normal) continue;
    words[i] = normal ? "fn" : words[i] == "load" ? "cell" : "ft";
    words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
  }
}

struct Parsed {
  std::vector<Quantity> quantities;
  char axis = 0;
  std::optional<unsigned> index;
  Words frame;
  bool unknown_last = false;  // the last word is no quantity, axis, number or frame that is known
  bool unknown = false;       // or any
  bool is_letter = false;     // no word names the quantity but a letter, or an axis alone
};

// Whether all other words are places or numbers: a letter beside another word is that word's.
bool stands_alone(const Words& words, std::size_t letter) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i != letter && !lists(frames, words[i]) && !is_number(words[i])) return false;
  }
  return true;
}

void find_quantity(const Words& words, Parsed& out, std::vector<char>& used) {
  // The last word that is a quantity names it: in "pose.position.x" the pose is whose position it is.
  std::optional<std::size_t> at;
  for (std::size_t i = words.size(); i-- > 0 && !at;) {
    const auto quantity = quantity_of(words[i]);
    if (!quantity || *quantity == Quantity::count) continue;
    if ((*quantity == Quantity::wrench || *quantity == Quantity::pose) && (!out.index || out.axis != 0)) continue;
    at = i;
    out.quantities = {*quantity};
  }
  out.is_letter = !at;
  // A letter before its axis, or alone, where no word says it: "F x", "t", "q 3".
  for (std::size_t i = 0; i < words.size() && !at; ++i) {
    const LetterLexeme* const letter = letter_of(words[i]);
    if (letter == nullptr) continue;
    if (out.axis != 0 && letter->axes.find(out.axis) != std::string_view::npos) {
      at = i;
      out.quantities = {letter->quantities[0]};
      if (letter->quantities[1] != Quantity::other) out.quantities.push_back(letter->quantities[1]);
    } else if (out.axis == 0 && letter->letter != 'm' && stands_alone(words, i)) {
      at = i;
      constexpr auto alone = std::to_array<std::pair<char, Quantity>>(
          {{'t', Quantity::time}, {'f', Quantity::force}, {'p', Quantity::position}, {'q', Quantity::angle}});
      out.quantities = {std::ranges::find(alone, letter->letter, [](const auto& p) { return p.first; })->second};
    }
  }
  for (std::size_t i = words.size(); i-- > 0 && !at;) {
    if (quantity_of(words[i]) != Quantity::count) continue;
    at = i;
    out.quantities = {Quantity::count};
  }
  if (at) used[*at] = 1;
}

Parsed analysed(Words words) {
  split_fused(words);
  join_pairs(words);
  Parsed out;
  std::vector<char> used(words.size(), 0);
  std::size_t axes = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (is_axis(words[i])) out.axis = words[i].front(), used[i] = 1, ++axes;
    if (is_number(words[i]) && words[i].size() < 5) out.index = static_cast<unsigned>(std::stoul(words[i]));
  }
  find_quantity(words, out, used);
  bool commanded = axes > 1;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (used[i] != 0) continue;
    // A letter is the acceleration or the velocity only before its axis; else it names a frame: "Body A".
    const bool letter = words[i].size() == 1 && (i + 1 == words.size() || !is_axis(words[i + 1]));
    commanded = commanded || (!letter && lists(others, words[i]));
    const bool known = lists(frames, words[i]) || quantity_of(words[i]) || is_number(words[i]) || words[i] == "joint";
    out.unknown = out.unknown || !known;
    if (i + 1 == words.size()) out.unknown_last = !known;
    // With an axis beside it a number counts the sensor.
    if (!is_number(words[i]) || out.axis != 0) out.frame.push_back(words[i]);
  }
  if (out.axis != 0) out.index.reset();
  if (holds(words, "fn") || (out.quantities == std::vector{Quantity::force} && holds(out.frame, "n"))) out.axis = 'n';
  const bool joint = holds(words, "joint") || holds(words, "joints");
  if (out.quantities == std::vector{Quantity::position} && out.axis == 0 && !out.index) {
    const bool of_length = !holds(words, "position") && !holds(words, "pos");
    if (joint) out.quantities = {Quantity::angle};
    if (!joint && !of_length) out.quantities.push_back(Quantity::angle);
  }
  // "ground_force_px" is where the force acts: the letter before the axis names another quantity than the word does.
  for (std::size_t i = 0; i + 1 < words.size() && !out.is_letter; ++i) {
    const LetterLexeme* const letter = is_axis(words[i + 1]) ? letter_of(words[i]) : nullptr;
    const bool same = letter == nullptr || std::ranges::any_of(letter->quantities, [&](Quantity q) {
                        return q != Quantity::other && holds(out.quantities, q);
                      });
    commanded = commanded || !same;
  }
  // A row counter that is more than one is none: "frame rate"; "frame" beside a bare axis is a frame.
  if (out.quantities == std::vector{Quantity::count} && out.axis != 0) out.quantities.clear();
  if (out.quantities.empty() && out.axis != 0) {
    const bool of_wrench = std::ranges::any_of(words, [](const auto& w) { return lists(of_wrenches, w); });
    if (of_wrench) out.quantities = {Quantity::force, Quantity::torque};
    if (!of_wrench && !out.unknown && out.axis != 'w') out.quantities = {Quantity::position};
    if (out.axis == 'w') out.quantities = {Quantity::quaternion};
  }
  if (out.axis == 'w' && out.quantities != std::vector{Quantity::quaternion}) commanded = true;
  // Numbered torques of joints are no vector.
  if (out.index && (joint || holds(words, std::string("tau")) || holds(words, std::string("effort")))) commanded = true;
  // "current_pos_x" is the one of now; alone, or of a motor, it is in amperes.
  if (holds(words, std::string("current"))) {
    const bool now = !out.quantities.empty() && !out.is_letter;
    if (!now) commanded = true;
  }
  if (commanded) out.quantities = {Quantity::other};
  return out;
}

// The factor of the one of `quantities` that the unit fits, which are then left.
std::optional<double> fitting(std::vector<Quantity>& quantities, const std::string& unit) {
  std::optional<double> factor;
  std::vector<Quantity> left;
  for (const Quantity quantity : quantities) {
    if (si_unit(quantity).empty()) continue;
    const auto one = foreign_unit_factor(unit, si_unit(quantity));
    if (!one) continue;
    factor = one;
    left.push_back(quantity);
  }
  if (factor) quantities = left;
  return factor;
}

// In capitals throughout, or in small letters throughout, a unit has lost its own: FX_N, X_MM, fx_n, LOAD (KN). What
// would be a million of something is a thousandth in capitals: "Mm".
std::optional<double> fitting_any_case(std::vector<Quantity>& quantities, const std::string& unit,
                                       std::string_view name) {
  constexpr double million = 1e6;
  const bool capitals = std::ranges::none_of(name, is_small), small = std::ranges::none_of(name, is_capital);
  const bool torque = !quantities.empty() && quantities.front() == Quantity::torque;
  const bool no_nanometre = small && torque && unit == "nm";  // tx_nm
  std::vector<Quantity> as_written = quantities;
  if (const auto factor = fitting(as_written, unit); factor && *factor < million && !no_nanometre) {
    quantities = as_written;
    return factor;
  }
  if (unit.size() == 1) return fitting(quantities, small && unit == "n" ? "N" : lower(unit));
  if (!capitals && !small) return std::nullopt;
  const std::string in_small = lower(unit);
  std::string of_newton = in_small;
  if (const auto newton = of_newton.find('n'); newton < 2) of_newton[newton] = 'N';
  // "TX (NM)" is no nanometre.
  for (const std::string& restored : {torque ? of_newton : in_small, torque ? in_small : of_newton}) {
    if (const auto factor = fitting(quantities, restored)) return factor;
  }
  return std::nullopt;
}

struct Split {
  std::string name, unit;
  bool stated = false;  // the unit stands in brackets or behind a sign, so that it is one
};

// What stands in brackets, or behind " / ", " in " or ", ": a unit, a number that counts, or a remark.
Split split_unit(std::string text) {
  Split out;
  for (;;) {
    const auto open = text.find_first_of("([{");
    const auto close = open == std::string::npos ? open : text.find_first_of(")]}", open);
    if (open == std::string::npos) break;
    const auto end = close == std::string::npos ? text.size() : close;
    const std::string inside = text.substr(open + 1, end - open - 1);
    const Words words = words_of(inside);
    const bool remark = std::ranges::all_of(
        words, [](const std::string& w) { return lists(frames, w) || lists(others, w) || is_number(w) || is_axis(w); });
    const bool wordy = remark && !is_foreign_unit(inside);
    if (!wordy) out.unit = inside, out.stated = true;
    const std::string behind = close == std::string::npos ? "" : text.substr(close + 1);
    text = fmt::format("{} {}{}", text.substr(0, open), wordy ? inside + " " : "", behind);
  }
  for (const std::string_view sign : {" / ", "/", " in ", ", "}) {
    const auto at = text.rfind(sign);
    if (out.stated || at == std::string::npos || at == 0 || text.front() == '/') continue;
    const std::string behind = text.substr(at + sign.size());
    if (behind.empty() || is_axis(lower(behind)) || !is_foreign_unit(behind)) continue;
    if (sign == "/") {  // a path, unless what stands before it is a quantity of that unit
      std::vector<Quantity> of_head = analysed(words_of(text.substr(0, at))).quantities;
      if (text.find('/') != at || !fitting(of_head, behind)) continue;
    }
    out.unit = behind, out.stated = true;
    text.resize(at);
  }
  out.name = text;
  return out;
}

// Volts, degrees Celsius, metres in a second: of nothing that a recording has.
bool is_of_something_else(const std::string& unit) {
  constexpr auto own = std::to_array<std::string_view>({"m", "N", "N.m", "s", "1", "kg"});
  return is_foreign_unit(unit) &&
         std::ranges::none_of(own, [&](std::string_view si) { return foreign_unit_factor(unit, si).has_value(); });
}

// A unit at the end, behind a separator or a hump: "x_mm", "force x N", "ForceN". The longest that fits.
bool take_last_unit(std::string& name, std::vector<Quantity>& quantities, ColumnName& out) {
  for (std::size_t i = 1; i < name.size(); ++i) {
    const bool hump = is_capital(name[i]) && is_small(name[i - 1]);
    const bool behind_axis = i > 1 && name[i - 1] >= 'X' && name[i - 1] <= 'Z' && is_small(name[i - 2]);  // posXmm
    if (!hump && !behind_axis && !is_separator(name[i - 1])) continue;
    const std::string unit = name.substr(i), head = name.substr(0, i);
    if (unit.empty() || is_axis(unit)) continue;
    const Parsed parsed = analysed(words_of(head));
    std::vector<Quantity> of_head = parsed.quantities;
    // A bare axis in newtons is a force.
    if (parsed.is_letter && parsed.axis != 0 && of_head == std::vector{Quantity::position}) {
      of_head = {Quantity::position, Quantity::force, Quantity::torque};
    }
    // Behind a hump the first letter is a capital whatever it is: posMm, timeMs.
    std::optional<double> factor = hump ? fitting(of_head, lower(unit)) : std::nullopt;
    if (!factor) factor = fitting_any_case(of_head, unit, name);
    if (!factor) continue;
    out.unit = unit, out.factor = factor;
    quantities = of_head;
    name = head;
    return true;
  }
  return false;
}

}  // namespace

bool ColumnName::may_be(Quantity quantity) const { return holds(quantities, quantity); }

bool most_are_column_names(const std::vector<std::string_view>& names) {
  const auto known = std::ranges::count_if(names, [](auto n) { return !parse_column_name(n).quantities.empty(); });
  return 2 * known > std::ssize(names);
}

std::string_view si_unit(Quantity quantity) {
  switch (quantity) {
    case Quantity::time:
      return "s";
    case Quantity::position:
      return "m";
    case Quantity::force:
      return "N";
    case Quantity::torque:
      return "N.m";
    case Quantity::angle:
      return "rad";
    default:
      return {};
  }
}

ColumnName parse_column_name(std::string_view written) {
  ColumnName out;
  Split split = split_unit(as_utf8(written));
  std::vector<Quantity> quantities;
  bool taken = false;
  if (!split.stated) {
    // A number behind the unit counts the components: "position_mm.2".
    const auto end = split.name.find_last_not_of("0123456789");
    const bool counted = end != std::string::npos && end + 1 < split.name.size() && is_separator(split.name[end]);
    const std::string number = counted ? split.name.substr(end) : "";
    split.name.resize(split.name.size() - number.size());
    taken = take_last_unit(split.name, quantities, out);
    split.name += number;
  }
  Parsed parsed = analysed(words_of(split.name));
  if (taken) parsed.quantities = quantities;
  out.quantities = parsed.quantities;
  out.axis = parsed.axis;
  out.index = parsed.index;
  for (const std::string& word : parsed.frame) out.frame += (out.frame.empty() ? "" : " ") + word;
  if (taken || out.is(Quantity::other)) return out;
  if (split.stated) {
    out.unit = split.unit;
    // A bare axis in newtons is a force, one of something unknown in metres a position.
    if (parsed.axis != 0 && (out.quantities.empty() || out.is(Quantity::position)) && parsed.axis != 'w') {
      out.quantities = {Quantity::position, Quantity::force, Quantity::torque};
    }
    out.factor = fitting_any_case(out.quantities, split.unit, written);
    if (out.quantities.size() == 3) out.quantities = parsed.quantities;
    const bool needs_none = out.quantities.empty() || out.is(Quantity::count) || out.is(Quantity::quaternion) ||
                            out.is(Quantity::wrench) || out.is(Quantity::pose);
    // A letter in a unit of something else is another quantity's: "T (degC)", "P (kPa)", "Load cell X (V)".
    const bool bare = parsed.is_letter && (parsed.axis == 0 || parsed.quantities == std::vector{Quantity::position});
    if (!out.factor && !needs_none && bare && is_of_something_else(split.unit)) {
      out.quantities = {Quantity::other};
      return out;
    }
    // In French a force is an effort.
    if (!out.factor && parsed.quantities == std::vector{Quantity::torque} && holds(words_of(split.name), "effort")) {
      out.factor = foreign_unit_factor(split.unit, "N");
      if (out.factor) out.quantities = {Quantity::force};
    }
    if (!out.factor && !needs_none) {
      const auto mass_kg = foreign_unit_factor(split.unit, "kg");
      constexpr double gravity_m_per_s2 = 9.80665;
      out.doubt = fmt::format("'{}' is no unit of it that is known", split.unit);
      if (mass_kg)
        out.doubt += fmt::format(" but one of mass: its weight has the scale {:.9g}", *mass_kg * gravity_m_per_s2);
    }
    return out;
  }
  // "pos_x_N": a unit, but of something else.
  const auto last = split.name.find_last_of("_ ./-");
  const std::string end = last == std::string::npos ? "" : split.name.substr(last + 1);
  const bool needs_unit = !out.quantities.empty() && !si_unit(out.quantities.front()).empty();
  const bool is_word = quantity_of(lower(end)) || lists(frames, lower(end)) || is_axis(lower(end));
  if (needs_unit && is_foreign_unit(end) && (end == "N" || end == "V" || (end.size() > 1 && !is_word))) {
    out.doubt = fmt::format("'{}' at its end is no unit of it", end);
    return out;
  }
  const Words words = words_of(split.name);
  if (out.is(Quantity::time) && !words.empty() && quantity_of(words.back()) == Quantity::time) {
    out.factor = foreign_unit_factor(words.back(), "s");  // "elapsed seconds"
    if (out.factor) out.unit = words.back();
  }
  // "force_x_kip2": a short last word that nobody knows may be a unit.
  constexpr std::size_t as_long_as_units = 4;
  if (!out.quantities.empty() && parsed.unknown_last && !out.is(Quantity::count) && !out.is(Quantity::quaternion) &&
      words.back().size() <= as_long_as_units && !is_number(words.back())) {
    out.doubt = fmt::format("what '{}' at its end is, a unit or a place, is not known", words.back());
  }
  return out;
}

}  // namespace touchstone::importing
