#include "head_facts.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string_view>

#include "foreign_unit.h"

namespace touchstone::importing {
namespace {

std::string small_letters(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// The first number behind `from`, not further than a head puts it from its name.
std::optional<double> number_behind(std::string_view line, std::size_t from) {
  constexpr std::size_t near = 40;
  const std::size_t end = std::min(line.size(), from + near);
  for (std::size_t i = from; i < end; ++i) {
    if (line[i] < '0' || line[i] > '9') continue;
    double value = 0.0;
    if (std::from_chars(line.data() + i, line.data() + line.size(), value).ec != std::errc{}) return std::nullopt;
    return value;
  }
  return std::nullopt;
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
      if (!of_samples || !number || !(*number > 0.0)) continue;
      const bool kilo = small.find("khz", at) != std::string::npos && small.find("khz", at) < at + 40;
      const double rate = kilo ? 1e3 * *number : *number;
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
      if (const auto at = small.find(word); at != std::string::npos) *counts = number_behind(small, at);
    }
  }
  if (contradicted) facts.rate_Hz.reset();
  return facts;
}

}  // namespace touchstone::importing
