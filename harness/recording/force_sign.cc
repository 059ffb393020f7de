#include "harness/recording/force_sign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace touchstone::recording {
namespace {

constexpr std::size_t most_blocks = 20;
constexpr double least_statistic = 0.5;
constexpr double greatest_p = 0.01;

// Two-sided: the probability that of n fair coins at least max(k, n - k) fall alike.
double sign_test(std::size_t k, std::size_t n) {
  const std::size_t alike = std::max(k, n - k);
  double term = std::pow(0.5, static_cast<double>(n));  // P(n of n), then P(n - 1 of n), ...
  double sum = 0.0;
  for (std::size_t i = n;; --i) {
    sum += term;
    if (i == alike) break;
    term *= static_cast<double>(i) / static_cast<double>(n - i + 1);
  }
  return std::min(1.0, 2.0 * sum);
}

// Does one sign prevail in `values`, in all and block by block? None of them is zero.
ForceSign judge(std::span<const double> values) {
  ForceSign sign;
  sign.samples = values.size();
  if (values.empty()) return sign;
  // Scaled by the largest, so that sums neither overflow nor vanish.
  const double largest = std::abs(*std::ranges::max_element(values, {}, [](double v) { return std::abs(v); }));
  double sum = 0.0;
  double size = 0.0;
  sign.blocks = std::min(most_blocks, values.size());
  std::size_t positive = 0;
  for (std::size_t block = 0; block < sign.blocks; ++block) {
    double block_sum = 0.0;
    for (std::size_t i = values.size() * block / sign.blocks; i < values.size() * (block + 1) / sign.blocks; ++i) {
      block_sum += values[i] / largest;
      size += std::abs(values[i] / largest);
    }
    sum += block_sum;
    if (block_sum > 0.0) ++positive;
  }
  sign.statistic = sum / size;
  sign.p_value = sign_test(positive, sign.blocks);
  const bool majority_agrees = (2 * positive > sign.blocks) == (sum > 0.0);
  if (std::abs(sign.statistic) > least_statistic && sign.p_value < greatest_p && majority_agrees) {
    sign.verdict = sign.statistic > 0.0 ? SignVerdict::outward : SignVerdict::reversed;
  }
  return sign;
}

}  // namespace

ForceSign check_force_sign(std::span<const Vec3> normals, std::span<const Vec3> forces) {
  if (normals.size() != forces.size()) {
    throw std::invalid_argument(fmt::format("{} normals for {} forces", normals.size(), forces.size()));
  }
  std::vector<double> outward;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const double value = forces[i].dot(normals[i]);
    if (std::isfinite(value) && value != 0.0) outward.push_back(value);
  }
  return judge(outward);
}

ForceSign check_load_change(std::span<const double> depths_m, std::span<const double> loads_N) {
  if (depths_m.size() != loads_N.size()) {
    throw std::invalid_argument(fmt::format("{} depths for {} loads", depths_m.size(), loads_N.size()));
  }
  std::vector<std::size_t> finite;
  for (std::size_t i = 0; i < loads_N.size(); ++i) {
    if (std::isfinite(depths_m[i]) && std::isfinite(loads_N[i])) finite.push_back(i);
  }
  // Centred in each block, so that neither a slow drift of the sensor nor its zero takes part.
  std::vector<double> together;
  const std::size_t blocks = std::min(most_blocks, finite.size());
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::size_t begin = finite.size() * block / blocks, end = finite.size() * (block + 1) / blocks;
    double depth_m = 0.0, load_N = 0.0;
    for (std::size_t k = begin; k < end; ++k) depth_m += depths_m[finite[k]], load_N += loads_N[finite[k]];
    depth_m /= static_cast<double>(end - begin), load_N /= static_cast<double>(end - begin);
    for (std::size_t k = begin; k < end; ++k) {
      const double value = (depths_m[finite[k]] - depth_m) * (loads_N[finite[k]] - load_N);
      if (value != 0.0) together.push_back(value);
    }
  }
  return judge(together);
}

std::string ForceSign::explain() const {
  const std::string numbers =
      fmt::format("statistic {:.3f}, p = {:.2g} over {} blocks of {} samples", statistic, p_value, blocks, samples);
  switch (verdict) {
    case SignVerdict::outward:
      return fmt::format("the forces push outward, as forces on the probe by the object do ({})", numbers);
    case SignVerdict::reversed:
      return fmt::format(
          "the forces push into the object ({}): they look like forces BY the probe; Touchstone takes "
          "forces ON the probe BY the object",
          numbers);
    case SignVerdict::undecided:
      break;
  }
  return fmt::format("the sign of the forces cannot be told ({})", numbers);
}

}  // namespace touchstone::recording
