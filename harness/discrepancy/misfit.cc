#include "harness/discrepancy/misfit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace touchstone::discrepancy {
using rendering::Model;

namespace {

struct Group {
  std::vector<double> squares;    // of residuals, per block
  std::vector<double> variances;  // declared, of one axis
  double axes = 1.0;              // per block

  [[nodiscard]] double chi_squared_per_axis(double added) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < squares.size(); ++i) sum += squares[i] / (variances[i] + added);
    return sum / (axes * static_cast<double>(squares.size()));
  }

  [[nodiscard]] bool tells() const { return squares.size() >= 10; }

  [[nodiscard]] double misfit() const {
    if (squares.empty() || chi_squared_per_axis(0.0) <= 1.0) return 0.0;
    double high = 0.0;  // here chi-squared is below 1 for sure
    for (const double square : squares) high += square / axes;
    double low = 0.0;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (chi_squared_per_axis(middle) > 1.0 ? low : high) = middle;
    }
    return std::sqrt(0.5 * (low + high));
  }
};

}  // namespace

Misfit estimate_misfit(const FitData& declared, const Model& model) {
  const auto means = block_means(declared.blocks, declared.predictor->predict(model).f_W_N);
  Group free{{}, {}, 3.0};
  Group normal{{}, {}, 1.0};
  Group tangential{{}, {}, 2.0};
  for (std::size_t b = 0; b < means.size(); ++b) {
    const BlockNoise& noise = declared.noise[b];
    const Vec3 left = declared.measured_N[b] - means[b] - noise.bias_W_N;
    const double along = noise.n_W.dot(left);
    const double across = left.squaredNorm() - along * along;
    Group& plane = noise.n_W.isZero() ? free : tangential;
    plane.squares.push_back(across);
    plane.variances.push_back(noise.tangential_N * noise.tangential_N);
    if (noise.n_W.isZero()) continue;
    normal.squares.push_back(along * along);
    normal.variances.push_back(noise.along_normal_N * noise.along_normal_N);
  }
  // A group of a few blocks says little: it is taken to be as far off as the others.
  double others_N = 0.0;
  for (const Group* group : {&free, &normal, &tangential}) {
    if (group->tells()) others_N = std::max(others_N, group->misfit());
  }
  const auto of = [&](const Group& group) { return group.tells() ? group.misfit() : others_N; };
  return {of(free), of(normal), of(tangential)};
}

std::vector<double> block_deviance(const FitData& data, const Model& model) {
  std::vector<double> out = block_chi_squared(data, model);
  for (std::size_t b = 0; b < out.size(); ++b) {
    const BlockNoise& noise = data.noise[b];
    out[b] += 2.0 * (2.0 * std::log(noise.tangential_N) + std::log(noise.along_normal_N));
  }
  return out;
}

double deviance(const FitData& data, const Model& model) {
  const auto blocks = block_deviance(data, model);
  return std::accumulate(blocks.begin(), blocks.end(), 0.0);
}

void add_misfit(FitData& data, const Misfit& misfit) {
  for (BlockNoise& noise : data.noise) {
    noise.tangential_N = std::hypot(noise.tangential_N, noise.n_W.isZero() ? misfit.free_N : misfit.tangential_N);
    noise.along_normal_N =
        noise.n_W.isZero() ? noise.tangential_N : std::hypot(noise.along_normal_N, misfit.along_normal_N);
  }
}

}  // namespace touchstone::discrepancy
