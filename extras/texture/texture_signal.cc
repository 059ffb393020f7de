#include "texture_signal.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "windowed_sinc.h"

namespace touchstone::texture {
TextureSignal::TextureSignal(std::shared_ptr<const TextureModel> model, std::uint64_t seed)
    : model_(std::move(model)), seed_(seed), random_(seed) {}

void TextureSignal::reset() {
  random_ = Random(seed_);
  outputs_.fill(0.0);
  noises_.fill(0.0);
}

double TextureSignal::next(double speed_m_per_s, double force_N) noexcept {
  const TextureFilter filter = filter_at(*model_, speed_m_per_s, force_N);
  const double noise = std::sqrt(filter.variance) * random_.normal();
  double output = filter.ma[0] * noise;
  for (std::size_t i = 0; i < filter.ma_count; ++i) output += filter.ma[i + 1] * noises_[i];
  for (std::size_t i = 0; i < filter.ar_count; ++i) output -= filter.ar[i + 1] * outputs_[i];
  std::shift_right(outputs_.begin(), outputs_.end(), 1);
  std::shift_right(noises_.begin(), noises_.end(), 1);
  outputs_[0] = output;
  noises_[0] = noise;
  return output;
}

TexturePlayer::TexturePlayer(std::shared_ptr<const TextureModel> model, std::uint64_t seed)
    : rate_Hz_(model->rate_Hz), signal_(std::move(model), seed) {}

void TexturePlayer::reset() {
  signal_.reset();
  samples_.fill(0.0);
  made_ = 0;
}

double TexturePlayer::at(double t_s, double speed_m_per_s, double force_N) noexcept {
  constexpr double rounding = 1e-6;  // of a sample
  if (made_ == 0) origin_s_ = before_s_ = t_s;
  double now = (t_s - origin_s_) * rate_Hz_;  // in samples
  if (now - static_cast<double>(made_) > static_cast<double>(kept)) {
    // A pause longer than the memory of the kernel: nothing of before is heard.
    origin_s_ = t_s;
    now = 0.0;
    made_ = 0;
    samples_.fill(0.0);
  }
  for (; static_cast<double>(made_) <= now + rounding; ++made_)
    samples_[made_ % kept] = signal_.next(speed_m_per_s, force_N);
  // Below the model's rate, the band that the loop can carry.
  const double step = (t_s - before_s_) * rate_Hz_;
  const double band = step > 1.0 + rounding ? std::max(0.5, 1.0 / step) : 1.0;
  before_s_ = t_s;
  double nearest = std::round(now);
  if (std::abs(now - nearest) < rounding) now = nearest;
  const double place = now - static_cast<double>(half_width);
  const double first = std::max(0.0, std::ceil(place - static_cast<double>(half_width)));
  double sum = 0.0;
  for (auto k = static_cast<std::uint64_t>(first); k < made_; ++k) {
    const double away = static_cast<double>(k) - place;
    sum += samples_[k % kept] * band * sinc(band * away) * blackman(away / static_cast<double>(half_width));
  }
  return sum;
}

}  // namespace touchstone::texture
