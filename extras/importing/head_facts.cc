#include "head_facts.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "foreign_unit.h"
#include "text_dialect.h"

namespace touchstone::importing {
namespace {

std::string small_letters(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

struct HeadNumber {
  double value = 0.0;
  std::string_view behind;
};

// The first number behind `from`, not further than a head puts it from its name; "1,000,000" is a million.
std::optional<HeadNumber> number_behind(std::string_view line, std::size_t from) {
  constexpr std::size_t near = 40;
  const auto begin = line.find_first_of("0123456789", from);
  if (begin == std::string_view::npos || begin >= from + near) return std::nullopt;
  const auto end = std::min(line.find_first_not_of("0123456789.,e", begin), line.size());
  std::string_view text = line.substr(begin, end - begin);
  while (!text.empty() && !std::isdigit(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
  // Where commas stand elsewhere too they separate fields.
  const auto commas = std::ranges::count(text, ',');
  if (commas > 0 && commas != std::ranges::count(line, ',')) text = text.substr(0, text.find(','));
  const char decimal = text.find(',') == std::string_view::npos || may_be_thousands(text, ',') ? '.' : ',';
  const auto value = text_value(text, decimal, decimal == '.');
  if (!value) return std::nullopt;
  return HeadNumber{*value, line.substr(begin + text.size())};
}

// Of a rate behind its number, in small letters: nothing, or samples in a second. Nothing for other units ("baud").
std::optional<double> rate_factor(std::string_view behind) {
  const auto begin = behind.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return 1.0;
  const std::string_view unit = behind.substr(begin, behind.find_first_of(" \t,;)(]\"", begin) - begin);
  if (unit.empty() || unit == "hz" || unit == "fps" || unit == "1/s" || unit == "s/s" || unit == "sps") return 1.0;
  if (unit.starts_with("sample") || unit.starts_with("frame") || unit.starts_with("hz")) return 1.0;
  constexpr double kilo = 1e3;
  return unit == "khz" || unit == "ks/s" || unit == "ksps" ? std::optional(kilo) : std::nullopt;
}

// "length units: mm" -> mm, of the text as it is written.
std::string unit_behind(const std::string& line, std::size_t from) {
  const auto begin = line.find_first_not_of(":=,;\t \"s", from);
  if (begin == std::string::npos) return {};
  const auto end = line.find_first_of(",;\t\"", begin);
  std::string unit = line.substr(begin, end == std::string::npos ? std::string::npos : end - begin);
  while (!unit.empty() && (unit.back() == ' ' || unit.back() == '\r')) unit.pop_back();
  return unit;
}

void read_rate(const std::string& line, const std::string& small, HeadFacts& facts, bool& contradicted) {
  for (const char* const what : {"rate", "frequency", "freq."}) {
    for (auto at = small.find(what); at != std::string::npos; at = small.find(what, at + 1)) {
      constexpr std::size_t word = 16;
      const std::string before = small.substr(at < word ? 0 : at - word, std::min(at, word));
      bool of_samples = false;
      for (const char* const kind :
           {"sampl", "frame", "acqui", "scan", "data", "logging", "export", "update", "record"}) {
        of_samples = of_samples || before.find(kind) != std::string::npos;
      }
      const auto number = number_behind(small, at);
      if (!of_samples || !number || !(number->value > 0.0)) continue;
      const auto factor = rate_factor(number->behind);
      if (!factor) continue;
      const auto behind_name = std::string_view(small).substr(at, small.size() - at - number->behind.size());
      const double rate = *factor * number->value * (behind_name.find("khz") != std::string_view::npos ? 1e3 : 1.0);
      contradicted = contradicted || (facts.rate_Hz && *facts.rate_Hz != rate);
      facts.rate_Hz = rate;
      constexpr std::size_t shown = 60;
      facts.rate_line = line.substr(0, shown);
    }
  }
}

}  // namespace

const std::string& HeadFacts::unit_of(Quantity quantity) const {
  static const std::string none;
  if (quantity == Quantity::position) return length_unit;
  if (quantity == Quantity::force) return force_unit;
  return quantity == Quantity::torque ? torque_unit : none;
}

std::optional<double> HeadFacts::counts_of(Quantity quantity) const {
  if (quantity == Quantity::force) return counts_per_force;
  return quantity == Quantity::torque ? counts_per_torque : std::nullopt;
}

HeadFacts head_facts(const std::vector<std::string>& head) {
  HeadFacts facts;
  bool contradicted = false;
  for (const std::string& line : head) {
    const std::string small = small_letters(line);
    read_rate(line, small, facts, contradicted);
    for (const auto& [word, unit] : {std::pair{"length unit", &facts.length_unit},
                                     {"position unit", &facts.length_unit},
                                     {"force unit", &facts.force_unit},
                                     {"torque unit", &facts.torque_unit}}) {
      const auto at = small.find(word);
      if (at == std::string::npos || !unit->empty()) continue;
      *unit = unit_behind(as_utf8(line), at + std::string_view(word).size());
    }
    for (const auto& [word, counts] : {std::pair{"counts per unit force", &facts.counts_per_force},
                                       {"counts per force", &facts.counts_per_force},
                                       {"counts per unit torque", &facts.counts_per_torque},
                                       {"counts per torque", &facts.counts_per_torque}}) {
      const auto at = small.find(word);
      const auto number = at == std::string::npos ? std::nullopt : number_behind(small, at);
      if (number) *counts = number->value;
    }
  }
  if (contradicted) facts.rate_Hz.reset();
  return facts;
}

}  // namespace touchstone::importing
