#include "segment_burg.h"

namespace touchstone::texture {

SegmentBurg segment_burg(std::span<const std::vector<double>> series, std::size_t largest) {
  std::vector<std::vector<double>> forward;
  double squares = 0.0;
  double count = 0.0;
  for (const std::vector<double>& one : series) {
    if (one.size() <= largest) continue;
    forward.push_back(one);
    for (const double x : one) squares += x * x;
    count += static_cast<double>(one.size());
  }
  std::vector<std::vector<double>> backward = forward;
  SegmentBurg result;
  result.polynomials.push_back({1.0});
  result.errors.push_back(count > 0.0 ? squares / count : 0.0);
  for (std::size_t order = 1; order <= largest; ++order) {
    double product = 0.0;
    double energy = 0.0;
    for (std::size_t s = 0; s < forward.size(); ++s) {
      for (std::size_t i = order; i < forward[s].size(); ++i) {
        product += forward[s][i] * backward[s][i - 1];
        energy += forward[s][i] * forward[s][i] + backward[s][i - 1] * backward[s][i - 1];
      }
    }
    const double reflection = energy > 0.0 ? -2.0 * product / energy : 0.0;
    for (std::size_t s = 0; s < forward.size(); ++s) {
      for (std::size_t i = forward[s].size(); i-- > order;) {
        const double ahead = forward[s][i];
        const double behind = backward[s][i - 1];
        forward[s][i] = ahead + reflection * behind;
        backward[s][i] = behind + reflection * ahead;
      }
    }
    const std::vector<double>& before = result.polynomials.back();
    std::vector<double> polynomial(before);
    polynomial.push_back(0.0);
    for (std::size_t i = 1; i <= order; ++i) polynomial[i] += reflection * before[order - i];
    result.polynomials.push_back(std::move(polynomial));
    result.errors.push_back(result.errors.back() * (1.0 - reflection * reflection));
  }
  return result;
}

}  // namespace touchstone::texture
