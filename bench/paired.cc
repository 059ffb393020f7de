#include "bench/paired.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace touchstone::bench {
namespace {

// How probable each sum of the ranks of positive differences is when every sign is a coin's throw.
std::vector<double> null_distribution(const std::vector<std::size_t>& ranks) {
  const std::size_t most = std::accumulate(ranks.begin(), ranks.end(), std::size_t{0});
  std::vector<double> probability(most + 1, 0.0);
  probability[0] = 1.0;
  std::size_t reached = 0;
  for (const std::size_t rank : ranks) {
    reached += rank;
    for (std::size_t sum = reached + 1; sum-- > 0;)
      probability[sum] = 0.5 * (probability[sum] + (sum >= rank ? probability[sum - rank] : 0.0));
  }
  return probability;
}

// Twice the ranks of the absolute differences, so that ties share a whole number; zeros are left out (Wilcoxon).
double signed_rank_p(std::vector<double> differences) {
  std::erase(differences, 0.0);
  if (differences.empty()) return 1.0;
  std::ranges::sort(differences, {}, [](double d) { return std::abs(d); });
  std::vector<std::size_t> ranks(differences.size());
  for (std::size_t i = 0; i < differences.size();) {
    std::size_t end = i;
    while (end < differences.size() && std::abs(differences[end]) == std::abs(differences[i])) ++end;
    for (std::size_t j = i; j < end; ++j) ranks[j] = i + end + 1;
    i = end;
  }
  std::size_t positive = 0;
  for (std::size_t i = 0; i < ranks.size(); ++i) positive += differences[i] > 0.0 ? ranks[i] : 0;
  const auto probability = null_distribution(ranks);
  const std::size_t extreme = std::min(positive, probability.size() - 1 - positive);
  const double tail =
      std::accumulate(probability.begin(), probability.begin() + static_cast<std::ptrdiff_t>(extreme) + 1, 0.0);
  return std::min(1.0, 2.0 * tail);
}

// Means of every pair of differences, each with itself too, ascending.
std::vector<double> walsh_averages(const std::vector<double>& differences) {
  std::vector<double> averages;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    for (std::size_t j = i; j < differences.size(); ++j) averages.push_back(0.5 * (differences[i] + differences[j]));
  }
  std::ranges::sort(averages);
  return averages;
}

}  // namespace

PairedComparison compare_paired(std::span<const double> before, std::span<const double> after, double confidence) {
  const auto unusable = [](double value) { return !(value > 0.0 && std::isfinite(value)); };
  if (before.size() != after.size() || before.empty() || std::ranges::any_of(before, unusable) ||
      std::ranges::any_of(after, unusable))
    throw std::invalid_argument("two series of as many numbers above 0 were expected");
  PairedComparison result;
  result.pairs = before.size();
  std::vector<double> differences(before.size());
  for (std::size_t i = 0; i < before.size(); ++i) differences[i] = std::log(after[i] / before[i]);
  result.p = signed_rank_p(differences);
  const auto averages = walsh_averages(differences);
  const std::size_t middle = averages.size() / 2;
  result.ratio =
      std::exp(averages.size() % 2 == 1 ? averages[middle] : 0.5 * (averages[middle - 1] + averages[middle]));
  // The interval leaves out as many averages at each end as the test would reject at.
  std::vector<std::size_t> ranks(before.size());
  std::iota(ranks.begin(), ranks.end(), 1);
  const auto probability = null_distribution(ranks);
  std::size_t left_out = 0;
  double tail = probability[0];
  while (tail <= 0.5 * (1.0 - confidence)) tail += probability[++left_out];
  result.low = left_out == 0 ? 0.0 : std::exp(averages[left_out - 1]);
  result.high =
      left_out == 0 ? std::numeric_limits<double>::infinity() : std::exp(averages[averages.size() - left_out]);
  return result;
}

}  // namespace touchstone::bench
