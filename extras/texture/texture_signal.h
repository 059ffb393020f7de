// The acceleration that a texture model makes while a tip slides: noise through the filter of the speed and force of
// the moment, one sample at each tick of the model's own rate (Culbertson, Unwin and Kuchenbecker 2014, section 5; as
// vibrations() of the toolkit's TexturedSphere), and that signal at the times of a loop of any rate.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "harness/base/random.h"
#include "texture_model.h"

namespace touchstone::texture {

// The same seed gives the same samples. Allocates nothing but in the constructor.
class TextureSignal {
 public:
  TextureSignal(std::shared_ptr<const TextureModel> model, std::uint64_t seed);
  void reset();
  // The next sample, m/s^2.
  double next(double speed_m_per_s, double force_N) noexcept;

 private:
  std::shared_ptr<const TextureModel> model_;
  std::uint64_t seed_;
  Random random_;
  std::array<double, most_coefficients> outputs_{};  // the latest first
  std::array<double, most_coefficients> noises_{};
};

// At the times of the loop the signal is the sum of its samples over a windowed sinc (windowed_sinc.h), so that a
// faster loop adds no images of the spectrum above the model's own, and a slower one, as far as half the model's rate,
// folds nothing down; a tenth of the rate around the upper end of the band is lost. It is late by half_width samples; a
// loop at the model's rate gets the samples themselves.
class TexturePlayer {
 public:
  static constexpr std::size_t half_width = 16;

  TexturePlayer(std::shared_ptr<const TextureModel> model, std::uint64_t seed);
  void reset();
  // Times ascend. Samples that are due by now are made with this speed and force. m/s^2.
  double at(double t_s, double speed_m_per_s, double force_N) noexcept;

 private:
  static constexpr std::size_t kept = 4 * half_width;

  double rate_Hz_;
  TextureSignal signal_;
  std::array<double, kept> samples_{};  // sample k at k mod kept
  std::uint64_t made_ = 0;
  double origin_s_ = 0.0;
  double before_s_ = 0.0;
};

}  // namespace touchstone::texture
