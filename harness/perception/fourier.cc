#include "harness/perception/fourier.h"

#include <fftw3.h>

#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>

namespace touchstone::perception {
namespace {

// A real transform of length n and its inverse, and the turns that make cosine transforms of them.
struct Plans {
  std::shared_ptr<fftw_plan_s> forward;
  std::shared_ptr<fftw_plan_s> backward;
  std::vector<std::complex<double>> turns;  // exp(-i pi k / 2n), k = 0..n/2
};

std::shared_ptr<const Plans> make_plans(std::size_t n) {
  std::vector<double> x(n);
  std::vector<std::complex<double>> spectrum(n / 2 + 1);
  auto* const complex = reinterpret_cast<fftw_complex*>(spectrum.data());
  // Plans for arrays of any alignment use no vector units: all machines then round alike.
  constexpr unsigned kFlags = FFTW_ESTIMATE | FFTW_UNALIGNED;
  auto plans = std::make_shared<Plans>();
  plans->forward = {fftw_plan_dft_r2c_1d(static_cast<int>(n), x.data(), complex, kFlags), fftw_destroy_plan};
  plans->backward = {fftw_plan_dft_c2r_1d(static_cast<int>(n), complex, x.data(), kFlags), fftw_destroy_plan};
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    plans->turns.push_back(std::polar(1.0, -0.5 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n)));
  }
  return plans;
}

// Half the cost of a transform is its table of sines; plans are kept for the lengths in use. FFTW plans and destroys
// one at a time only, and may then run a plan on other arrays from any thread.
std::shared_ptr<const Plans> plans_for(std::size_t n) {
  constexpr std::size_t kMost = 16;
  static std::mutex mutex;
  static std::map<std::size_t, std::shared_ptr<const Plans>> plans;
  const std::scoped_lock lock(mutex);
  const auto found = plans.find(n);
  if (found != plans.end()) return found->second;
  // What other threads still run stays: a plan is only ever destroyed here, under the mutex.
  if (plans.size() >= kMost) std::erase_if(plans, [](const auto& entry) { return entry.second.use_count() == 1; });
  return plans.emplace(n, make_plans(n)).first->second;
}

void run_forward(const Plans& plans, std::vector<double>& x, std::vector<std::complex<double>>& spectrum) {
  fftw_execute_dft_r2c(plans.forward.get(), x.data(), reinterpret_cast<fftw_complex*>(spectrum.data()));
}

// Makhoul's order: the even samples forwards, then the odd ones backwards. Calls visit(place in order, sample).
template <class Visit>
void in_order(std::size_t n, Visit&& visit) {
  for (std::size_t i = 0; 2 * i < n; ++i) visit(i, 2 * i);
  for (std::size_t i = 0; 2 * i + 1 < n; ++i) visit(n - 1 - i, 2 * i + 1);
}

// Makes the transform orthonormal; the constant has twice the squares of the other cosines.
double scale_of(std::size_t n) { return std::sqrt(2.0 / static_cast<double>(n)); }

}  // namespace

std::vector<std::complex<double>> real_fourier(std::span<const double> x) {
  if (x.empty()) return {};
  std::vector<double> in(x.begin(), x.end());
  std::vector<std::complex<double>> out(x.size() / 2 + 1);
  run_forward(*plans_for(x.size()), in, out);
  return out;
}

std::vector<double> cosine_transform(std::span<const double> x) {
  const std::size_t n = x.size();
  if (n == 0) return {};
  const auto plans = plans_for(n);
  std::vector<double> y(n);
  in_order(n, [&](std::size_t place, std::size_t sample) { y[place] = x[sample]; });
  std::vector<std::complex<double>> spectrum(n / 2 + 1);
  run_forward(*plans, y, spectrum);
  const double scale = scale_of(n);
  y[0] = spectrum[0].real() * scale * std::sqrt(0.5);
  for (std::size_t k = 1; k < spectrum.size(); ++k) {
    const std::complex<double>& v = spectrum[k];
    const std::complex<double>& turn = plans->turns[k];
    y[k] = scale * (turn.real() * v.real() - turn.imag() * v.imag());
    y[n - k] = -scale * (turn.real() * v.imag() + turn.imag() * v.real());
  }
  // In the middle of an even length both say the same.
  return y;
}

std::vector<double> inverse_cosine_transform(std::span<const double> coefficients) {
  const std::size_t n = coefficients.size();
  if (n == 0) return {};
  const auto plans = plans_for(n);
  std::vector<std::complex<double>> spectrum(n / 2 + 1);
  const double scale = 0.5 * scale_of(n);
  spectrum[0] = coefficients[0] * scale * std::sqrt(2.0);
  for (std::size_t k = 1; k < spectrum.size(); ++k) {
    const double a = scale * coefficients[k];
    const double b = -scale * coefficients[n - k];
    const std::complex<double>& turn = plans->turns[k];
    spectrum[k] = {turn.real() * a + turn.imag() * b, turn.real() * b - turn.imag() * a};
  }
  std::vector<double> ordered(n);
  fftw_execute_dft_c2r(plans->backward.get(), reinterpret_cast<fftw_complex*>(spectrum.data()), ordered.data());
  std::vector<double> x(n);
  in_order(n, [&](std::size_t place, std::size_t sample) { x[sample] = ordered[place]; });
  return x;
}

}  // namespace touchstone::perception
