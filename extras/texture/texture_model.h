// A texture as filtered noise, by the speed and the normal force of the tip that slides over it, in the file layout of
// the Penn Haptic Texture Toolkit.
//
// Source: Culbertson, Lopez Delgado and Kuchenbecker 2014, "One hundred data-driven haptic texture models and
// open-source methods for rendering on 3D objects", Haptics Symposium (the toolkit: repository.upenn.edu/meam_papers/
// 299); Culbertson, Unwin and Kuchenbecker 2014, "Modeling and rendering realistic textures from unconstrained
// tool-surface interactions", IEEE Trans. Haptics 7:381. The toolkit's licence lets nobody pass its files on; none is
// here.
//
// A node is a filter that stands at a speed and a force: acceleration x[n] = sum_j b_j e[n-j] - sum_i a_i x[n-i] with
// white Gaussian e of the node's variance, b = gain (1, b1 ...), and b = 1 without a numerator. Between nodes the line
// spectral frequencies, the variance and the gain are interpolated linearly in the triangle that holds the point;
// beyond the largest speed or force the model is that of the largest.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::texture {

inline constexpr std::size_t most_coefficients = 25;  // of the toolkit's own renderer (MAX_COEFF of its shared.h)

struct TextureNode {
  double speed_m_per_s = 0.0;
  double force_N = 0.0;
  std::vector<double> ar_rad;  // line spectral frequencies of the denominator
  std::vector<double> ma_rad;  // of the numerator; empty: the numerator is 1
  double variance = 0.0;       // (m/s^2)^2
  double gain = 1.0;           // of the numerator
};

struct TextureModel {
  std::string material;
  double rate_Hz = 0.0;
  double mu = 0.0;  // Coulomb friction
  double largest_speed_m_per_s = 0.0;
  double largest_force_N = 0.0;
  std::vector<TextureNode> nodes;  // all with as many coefficients
  std::vector<std::array<std::size_t, 3>> triangles;
};

// A filter with its noise; places behind `ar_count` and `ma_count` are 0. ar[0] is 1, ma[0] the gain.
struct TextureFilter {
  std::array<double, most_coefficients + 1> ar{};
  std::array<double, most_coefficients + 1> ma{};
  std::size_t ar_count = 0;  // without the first
  std::size_t ma_count = 0;
  double variance = 0.0;

  // Density of the power of the acceleration, (m/s^2)^2/Hz over positive frequencies: 2 variance |B|^2 / (rate |A|^2).
  [[nodiscard]] double density(double frequency_Hz, double rate_Hz) const noexcept;
};

// The filter at a speed and a force. Allocates nothing.
TextureFilter filter_at(const TextureModel& model, double speed_m_per_s, double force_N) noexcept;

// Throws BadData naming file, line, element, value and what was expected.
TextureModel read_texture_model(const std::filesystem::path& file);
TextureModel parse_texture_model(const std::string& xml, const std::string& source);
// The text of such a file.
std::string texture_model_to_xml(const TextureModel& model);

}  // namespace touchstone::texture
