// Are blocks of the file in a wrong order, as when pieces of a log are joined wrongly, or does its last part stand
// first? Blocks of the measured load are assigned to the blocks of the modelled load that they fit best (optimal
// assignment, Kuhn 1955). The order is wrong if another one leaves less than half of the square that the file's own
// order leaves, and less than half of what an assignment leaves to pieces that nobody cut: to blocks that run backwards
// in time, and to modelled ones half a block further on. Chance alone finds as much. A load that hardly varies
// fits every order equally and is never blamed.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace touchstone::recording_checks {

struct BlockOrder {
  double block_s = 0.0;  // length of the blocks; of the part that stands first instead of last
  std::size_t blocks = 0;
  std::size_t moved = 0;     // blocks whose best place is another one
  double correlation = 0.0;  // of measured and modelled load in the file's order
  double reordered = 0.0;    // and in the best order

  // "with 17 of the 20 blocks of 1 s in another order", "with its first 1.1 s at its end"
  [[nodiscard]] std::string remedy() const;
};

// Loads at times that increase. Where parts of the recording are left out, blocks are of what stands between them.
// Nothing where the order is right or cannot be judged.
std::optional<BlockOrder> find_wrong_order(std::span<const double> t_s, std::span<const double> measured,
                                           std::span<const double> modelled, double most_left = 0.5);

// The cheapest assignment of rows to columns of a square matrix: result[row] = column.
std::vector<std::size_t> assign(const std::vector<std::vector<double>>& cost);

// Pearson's correlation; 0 where a series does not vary.
double correlation(std::span<const double> a, std::span<const double> b);

}  // namespace touchstone::recording_checks
