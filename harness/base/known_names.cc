#include "harness/base/known_names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

namespace touchstone {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substituted, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string closest_name(std::string_view name, const std::vector<std::string>& known) {
  std::string best;
  // A third of the letters wrong still reads as a slip; more is another word.
  std::size_t least = std::max<std::size_t>(2, name.size() / 3) + 1;
  for (const auto& candidate : known) {
    const auto distance = edit_distance(name, candidate);
    const bool begins = !name.empty() && candidate.starts_with(name);
    if (distance < least || (begins && best.empty())) {
      best = candidate;
      least = std::min(least, distance);
    }
  }
  return best;
}

std::string unknown_name(std::string_view what, std::string_view name, const std::vector<std::string>& known) {
  if (known.empty()) return fmt::format("there is no {} \"{}\"; none is known", what, name);
  const auto meant = closest_name(name, known);
  return fmt::format("there is no {} \"{}\"; {}known: {}", what, name,
                     meant.empty() ? std::string() : fmt::format("did you mean \"{}\"? ", meant),
                     fmt::join(known, ", "));
}

}  // namespace touchstone
