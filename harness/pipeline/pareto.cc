#include "harness/pipeline/pareto.h"

#include <algorithm>
#include <cmath>

namespace touchstone::pipeline {
namespace {

bool is_complete(const std::vector<double>& cost) {
  return std::ranges::all_of(cost, [](double one) { return std::isfinite(one); });
}

bool beats(const std::vector<double>& one, const std::vector<double>& other) {
  bool cheaper = false;
  for (std::size_t i = 0; i < one.size(); ++i) {
    if (one[i] > other[i]) return false;
    cheaper = cheaper || one[i] < other[i];
  }
  return cheaper;
}

}  // namespace

std::vector<bool> pareto_front(const std::vector<std::vector<double>>& costs) {
  std::vector<bool> front;
  for (const auto& own : costs) {
    front.push_back(is_complete(own) && std::ranges::none_of(costs, [&](const auto& other) {
                      return is_complete(other) && beats(other, own);
                    }));
  }
  return front;
}

}  // namespace touchstone::pipeline
