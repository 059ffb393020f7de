#include "harness/stats/all_pairs.h"

#include <algorithm>
#include <numeric>
#include <set>

namespace touchstone::stats {

std::vector<std::size_t> possible_equal_pairs(std::size_t things) {
  // Equal things form classes. A class of j has j (j - 1) / 2 equal pairs; the others are split in every way.
  std::vector<std::set<std::size_t>> by_count{{0}};
  for (std::size_t k = 1; k <= things; ++k) {
    by_count.emplace_back();
    for (std::size_t j = 1; j <= k; ++j) {
      for (const std::size_t others : by_count[k - j]) by_count[k].insert(j * (j - 1) / 2 + others);
    }
  }
  return {by_count[things].begin(), by_count[things].end()};
}

std::vector<PairVerdict> judge_all_pairs(std::span<const double> p, std::size_t things, double level) {
  const std::vector<std::size_t> possible = possible_equal_pairs(things);
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t pair) { return p[pair]; });
  std::vector<PairVerdict> out(p.size());
  bool going = true;
  for (std::size_t rejected = 0; rejected < order.size(); ++rejected) {
    // The largest possible number of equal pairs among those that are left; at least this one.
    const auto above = std::ranges::upper_bound(possible, order.size() - rejected);
    const std::size_t equal = std::max<std::size_t>(1, *std::prev(above));
    PairVerdict& own = out[order[rejected]];
    own.level = level / static_cast<double>(equal);
    going = going && p[order[rejected]] <= own.level;
    own.differ = going;
  }
  return out;
}

}  // namespace touchstone::stats
