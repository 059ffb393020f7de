#include "harness/base/signed_order.h"

#include <fmt/format.h>

#include <algorithm>

namespace touchstone {
namespace {

// Columns that do not stand in their place, then signs.
int changes(const SignedOrder& order) {
  int changed = 0;
  for (int k = 0; k < 3; ++k) {
    changed += 2 * static_cast<int>(order.from.at(static_cast<std::size_t>(k)) != k);
    changed += static_cast<int>(order.sign.at(static_cast<std::size_t>(k)) < 0);
  }
  return changed;
}

}  // namespace

std::string SignedOrder::meaning(char vector) const {
  const std::array<std::string, 3> names{{{vector, 'x'}, {vector, 'y'}, {vector, 'z'}}};
  std::string text;
  const auto add = [&](const std::string& words) { text += (text.empty() ? "" : " and ") + words; };
  std::array<int, 3> moved{};
  int count = 0;
  for (int k = 0; k < 3; ++k) {
    if (from.at(static_cast<std::size_t>(k)) != k) moved.at(static_cast<std::size_t>(count++)) = k;
  }
  if (count == 2) {
    add(fmt::format("{} and {} are exchanged", names.at(static_cast<std::size_t>(moved[0])),
                    names.at(static_cast<std::size_t>(moved[1]))));
  } else if (count == 3) {
    add(fmt::format("the columns {}, {}, {} hold {}, {}, {}", names[0], names[1], names[2],
                    names.at(static_cast<std::size_t>(std::ranges::find(from, 0) - from.begin())),
                    names.at(static_cast<std::size_t>(std::ranges::find(from, 1) - from.begin())),
                    names.at(static_cast<std::size_t>(std::ranges::find(from, 2) - from.begin()))));
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (sign.at(k) < 0) add(fmt::format("{} has the other sign", names.at(static_cast<std::size_t>(from.at(k)))));
  }
  return text;
}

std::vector<SignedOrder> signed_orders() {
  std::vector<SignedOrder> all;
  std::array<int, 3> from{0, 1, 2};
  do {
    for (int pattern = 0; pattern < 8; ++pattern)
      all.push_back({from, {(pattern & 1) != 0 ? -1 : 1, (pattern & 2) != 0 ? -1 : 1, (pattern & 4) != 0 ? -1 : 1}});
  } while (std::ranges::next_permutation(from).found);
  std::ranges::stable_sort(all, {}, changes);
  return all;
}

}  // namespace touchstone
