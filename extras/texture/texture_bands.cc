#include "texture_bands.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "harness/perception/fourier.h"

namespace touchstone::texture {
using perception::BandPower;
using perception::FastForce;
using perception::Thresholds;

namespace {

constexpr int per_bin = 16;
constexpr int reach_bins = 8;  // beyond, a Hann window's side lobes lie below -90 dB

class Bands {
 public:
  Bands(double rate_Hz, std::size_t length, const Thresholds& thresholds)
      : bin_Hz_(rate_Hz / static_cast<double>(length)), bins_((length - 1) / 2), window_(length) {
    double energy = 0.0;
    for (std::size_t i = 0; i < length; ++i) {
      const double turn = (static_cast<double>(i) + 0.5) / static_cast<double>(length);
      window_[i] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * turn);
      energy += window_[i] * window_[i];
    }
    scale_ = 2.0 / (energy * static_cast<double>(length));  // Parseval, both signs of the frequency
    const auto& centres = perception::band_centres_Hz();
    for (std::size_t k = 1; k <= bins_; ++k) {
      const double f = bin_Hz_ * static_cast<double>(k);
      const long nearest = std::lround(3.0 * std::log2(f / centres.front()));
      const bool in_band = nearest >= 0 && nearest < static_cast<long>(centres.size());
      band_.push_back(in_band ? static_cast<int>(nearest) : -1);
      const double centre = in_band ? centres[static_cast<std::size_t>(nearest)] : f;
      weight_.push_back(perception::band_weight(f, centre, thresholds));
      octaves_.push_back(std::log2(f / centre));
    }
    double sum = 0.0;
    for (int j = -reach_bins * per_bin; j <= reach_bins * per_bin; ++j) {
      // The transform of cos^2 over one length, at j sixteenths of a bin: sinc(u) / (1 - u^2).
      const double u = static_cast<double>(j) / per_bin;
      double value = 1.0;
      if (std::abs(std::abs(u) - 1.0) < 1e-9) {
        value = 0.5;
      } else if (u != 0.0) {
        value = std::sin(std::numbers::pi * u) / (std::numbers::pi * u) / (1.0 - u * u);
      }
      shape_.push_back(value * value);
      sum += shape_.back();
    }
    for (double& value : shape_) value /= sum;
  }

  // Powers of the bins from 1 on, N^2.
  [[nodiscard]] std::vector<double> measured(const std::vector<double>& x) const {
    std::vector<double> tapered(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) tapered[i] = window_[i] * x[i];
    const auto spectrum = perception::real_fourier(tapered);
    std::vector<double> powers;
    for (std::size_t k = 1; k <= bins_; ++k) powers.push_back(scale_ * std::norm(spectrum[k]));
    return powers;
  }

  [[nodiscard]] std::vector<double> expected(const TextureFilter& filter, double model_rate_Hz, double mass_kg) const {
    std::vector<double> density;
    const double step_Hz = bin_Hz_ / per_bin;
    const int last = (static_cast<int>(bins_) + reach_bins) * per_bin;
    for (int j = 0; j <= last; ++j) {
      const double f = step_Hz * j;
      density.push_back(2.0 * f <= model_rate_Hz ? filter.density(f, model_rate_Hz) : 0.0);
    }
    std::vector<double> powers;
    for (int k = 1; k <= static_cast<int>(bins_); ++k) {
      double sum = 0.0;
      for (int j = -reach_bins * per_bin; j <= reach_bins * per_bin; ++j)
        sum += shape_[static_cast<std::size_t>(j + reach_bins * per_bin)] *
               density[static_cast<std::size_t>(std::abs(k * per_bin + j))];
      powers.push_back(mass_kg * mass_kg * bin_Hz_ * sum);
    }
    return powers;
  }

  // Adds powers of bins to those of bands.
  void add(const std::vector<double>& powers, std::vector<double>& bands, std::vector<double>& moments) const {
    for (std::size_t k = 0; k < powers.size(); ++k) {
      if (band_[k] < 0) continue;
      const auto band = static_cast<std::size_t>(band_[k]);
      bands[band] += weight_[k] * powers[k];
      moments[band] += weight_[k] * powers[k] * octaves_[k];
    }
  }
  [[nodiscard]] double bins_in(std::size_t band) const {
    return static_cast<double>(std::count(band_.begin(), band_.end(), static_cast<int>(band)));
  }

 private:
  double bin_Hz_;
  std::size_t bins_;
  std::vector<double> window_;
  double scale_ = 0.0;
  std::vector<int> band_;  // of each bin from 1 on; -1: none
  std::vector<double> weight_;
  std::vector<double> octaves_;
  std::vector<double> shape_;  // of the window's power, sum 1
};

// `axes_of(window)`: for each axis the powers of its bins. `noisy`: they are draws, not means.
template <class AxesOf>
FastForce bands_of(const SlideWindows& windows, const Thresholds& thresholds, bool noisy, AxesOf axes_of) {
  const std::size_t length = windows.windows.front().fast_N[0].size();
  const Bands bands(windows.rate_Hz, length, thresholds);
  const std::size_t count = perception::band_centres_Hz().size();
  const auto n = static_cast<double>(windows.windows.size());
  FastForce fast;
  fast.nyquist_Hz = 0.5 * windows.rate_Hz;
  fast.tracker_N2.assign(count, 0.0);
  BandPower& power = fast.contact;
  power.segments = windows.windows.size();
  power.segment_s = windows.window_s;
  power.power_N2.assign(count, 0.0);
  std::array<std::vector<double>, 3> of_axis;
  for (auto& axis : of_axis) axis.assign(count, 0.0);
  for (const SlideWindow& window : windows.windows) {
    std::vector<double> sum(count, 0.0), moments(count, 0.0);
    const std::vector<std::vector<double>> axes = axes_of(bands, window);
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      const std::vector<double> before = sum;
      bands.add(axes[axis], sum, moments);
      for (std::size_t b = 0; b < count; ++b) of_axis[axis][b] += (sum[b] - before[b]) / n;
    }
    for (std::size_t b = 0; b < count; ++b) power.power_N2[b] += sum[b] / n;
    power.windows_N2.push_back(std::move(sum));
    power.windows_octaves.push_back(std::move(moments));
    power.since_contact_s.push_back(std::numeric_limits<double>::infinity());
    power.slide_m_per_s.push_back(window.speed_m_per_s);
    power.load_N.push_back(window.load_N);
  }
  for (std::size_t b = 0; b < count; ++b) {
    const double mean = power.power_N2[b];
    double spread = 0.0, moment = 0.0, squares = 0.0;
    for (std::size_t w = 0; w < power.segments; ++w) {
      spread += std::pow(power.windows_N2[w][b] - mean, 2);
      moment += power.windows_octaves[w][b];
    }
    for (const auto& axis : of_axis) squares += axis[b] * axis[b];
    power.variance_N4.push_back(noisy && n > 1.0 ? spread / (n * (n - 1.0)) : 0.0);
    power.octaves.push_back(mean > 0.0 ? moment / (n * mean) : 0.0);
    // As in harness/perception/judge/vibration.cc: a taper makes three bins show what two would.
    const double independent = std::max(1.0, bands.bins_in(b) / 1.5);
    power.gaussian_share.push_back(noisy && mean > 0.0 ? squares / (mean * mean * independent * n) : 0.0);
  }
  return fast;
}

}  // namespace

FastForce recorded_bands(const SlideWindows& windows, const Thresholds& thresholds) {
  return bands_of(windows, thresholds, true, [](const Bands& bands, const SlideWindow& window) {
    std::vector<std::vector<double>> axes;
    for (const std::vector<double>& axis : window.fast_N) axes.push_back(bands.measured(axis));
    return axes;
  });
}

FastForce expected_bands(const TextureModel& model, double effective_mass_kg, const SlideWindows& windows,
                         const Thresholds& thresholds) {
  FastForce fast = bands_of(windows, thresholds, false, [&](const Bands& bands, const SlideWindow& window) {
    return std::vector<std::vector<double>>{
        bands.expected(filter_at(model, window.speed_m_per_s, window.load_N), model.rate_Hz, effective_mass_kg)};
  });
  // A tenth of the model's rate below its end a player at another rate lets the signal fall (texture_signal.h).
  if (std::abs(model.rate_Hz / windows.rate_Hz - 1.0) > 0.01)
    fast.nyquist_Hz = std::min(fast.nyquist_Hz, 0.4 * model.rate_Hz);
  return fast;
}

}  // namespace touchstone::texture
