#include "harness/base/known_names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

namespace touchstone {
namespace {

// Two letters that change places count as one slip.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      row[j + 1] = std::min({last[j] + (a[i] == b[j] ? 0 : 1), last[j + 1] + 1, row[j] + 1});
      if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j]) row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last.back();
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

bool is_one_slip(std::string_view name, std::string_view meant) { return edit_distance(name, meant) == 1; }

std::string unknown_name(std::string_view what, std::string_view name, const std::vector<std::string>& known) {
  if (known.empty()) return fmt::format("there is no {} \"{}\"; none is known", what, name);
  const auto meant = closest_name(name, known);
  return fmt::format("there is no {} \"{}\"; {}known: {}", what, name,
                     meant.empty() ? std::string() : fmt::format("did you mean \"{}\"? ", meant),
                     fmt::join(known, ", "));
}

}  // namespace touchstone
