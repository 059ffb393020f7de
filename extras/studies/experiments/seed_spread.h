// One experiment over several seeds: in how many of them each finding of the paper holds, and how far the numbers
// spread.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "harness/report/page.h"

namespace touchstone::experiments {

struct SeedSpread {
  struct Value {
    std::string name;  // with its unit
    std::vector<double> of_seed;
  };
  struct Finding {
    std::string statement;
    std::vector<bool> held;  // by seed
  };
  std::vector<Value> values;
  std::vector<Finding> findings;

  // Of the next seed. Throws std::invalid_argument where names and statements are not those of the first, in its order.
  void add(const std::vector<std::pair<std::string, double>>& values_of_seed,
           const std::vector<std::pair<std::string, bool>>& findings_of_seed);
};

// Medians and extremes; "none" where a value is not finite in every seed. "" for fewer than two seeds.
std::string spread_table(const SeedSpread& spread);
report::Section spread_section(const SeedSpread& spread);

}  // namespace touchstone::experiments
