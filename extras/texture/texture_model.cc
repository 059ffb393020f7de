#include "texture_model.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "line_spectrum.h"

namespace touchstone::texture {

double TextureFilter::density(double frequency_Hz, double rate_Hz) const noexcept {
  const double angle = 2.0 * std::numbers::pi * frequency_Hz / rate_Hz;
  std::complex<double> numerator = 0.0;
  std::complex<double> denominator = 0.0;
  for (std::size_t i = 0; i <= ma_count; ++i) numerator += std::polar(ma[i], -angle * static_cast<double>(i));
  for (std::size_t i = 0; i <= ar_count; ++i) denominator += std::polar(ar[i], -angle * static_cast<double>(i));
  return 2.0 * variance * std::norm(numerator) / (std::norm(denominator) * rate_Hz);
}

namespace {

// Where the point lies in the triangle: weights of the corners with sum 1, below 0 outside.
std::array<double, 3> barycentric(const TextureModel& model, const std::array<std::size_t, 3>& triangle, double speed,
                                  double force) noexcept {
  const TextureNode& a = model.nodes[triangle[0]];
  const TextureNode& b = model.nodes[triangle[1]];
  const TextureNode& c = model.nodes[triangle[2]];
  const double bx = b.speed_m_per_s - a.speed_m_per_s, by = b.force_N - a.force_N;
  const double cx = c.speed_m_per_s - a.speed_m_per_s, cy = c.force_N - a.force_N;
  const double px = speed - a.speed_m_per_s, py = force - a.force_N;
  const double area = bx * cy - by * cx;
  const double wb = (px * cy - py * cx) / area;
  const double wc = (bx * py - by * px) / area;
  return {1.0 - wb - wc, wb, wc};
}

}  // namespace

TextureFilter filter_at(const TextureModel& model, double speed_m_per_s, double force_N) noexcept {
  const double speed = std::clamp(speed_m_per_s, 0.0, model.largest_speed_m_per_s);
  const double force = std::clamp(force_N, 0.0, model.largest_force_N);
  // The triangle that holds the point; by rounding, or in a gap of the triangulation, the one it is least outside of.
  std::array<double, 3> weights{};
  const std::array<std::size_t, 3>* holds = nullptr;
  double best = 0.0;
  for (const auto& triangle : model.triangles) {
    const auto in = barycentric(model, triangle, speed, force);
    const double least = std::min({in[0], in[1], in[2]});
    if (holds != nullptr && !(least > best)) continue;
    best = least;
    weights = in;
    holds = &triangle;
  }
  double sum = 0.0;
  for (double& weight : weights) sum += weight = std::max(0.0, weight);

  TextureFilter filter;
  std::array<double, most_coefficients> ar_rad{}, ma_rad{};
  filter.ar_count = model.nodes.front().ar_rad.size();
  filter.ma_count = model.nodes.front().ma_rad.size();
  double gain = 0.0;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const TextureNode& node = model.nodes[(*holds)[corner]];
    const double weight = weights[corner] / sum;
    for (std::size_t i = 0; i < filter.ar_count; ++i) ar_rad[i] += weight * node.ar_rad[i];
    for (std::size_t i = 0; i < filter.ma_count; ++i) ma_rad[i] += weight * node.ma_rad[i];
    filter.variance += weight * node.variance;
    gain += weight * node.gain;
  }
  polynomial_of({ar_rad.data(), filter.ar_count}, filter.ar);
  polynomial_of({ma_rad.data(), filter.ma_count}, filter.ma);
  for (double& coefficient : filter.ma) coefficient *= gain;
  return filter;
}

}  // namespace touchstone::texture
