#include "harness/perception/fourier.h"

#include <fftw3.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

namespace touchstone::perception {
namespace {

using Plan = std::shared_ptr<fftw_plan_s>;

enum class Transform : std::uint8_t { real_fourier, cosine, inverse_cosine };

Plan make_plan(Transform transform, int n) {
  std::vector<double> in(static_cast<std::size_t>(n));
  constexpr unsigned kFlags = FFTW_ESTIMATE | FFTW_UNALIGNED;
  switch (transform) {
    case Transform::real_fourier: {
      std::vector<std::complex<double>> out(in.size() / 2 + 1);
      return {fftw_plan_dft_r2c_1d(n, in.data(), reinterpret_cast<fftw_complex*>(out.data()), kFlags),
              fftw_destroy_plan};
    }
    case Transform::cosine:
      return {fftw_plan_r2r_1d(n, in.data(), in.data(), FFTW_REDFT10, kFlags), fftw_destroy_plan};
    case Transform::inverse_cosine:
      break;
  }
  return {fftw_plan_r2r_1d(n, in.data(), in.data(), FFTW_REDFT01, kFlags), fftw_destroy_plan};
}

// Half the cost of a transform is its table of sines; plans are kept for the lengths in use. FFTW plans and destroys
// one at a time only, and may then run a plan on other arrays from any thread.
Plan plan_for(Transform transform, std::size_t n) {
  constexpr std::size_t kMost = 16;
  static std::mutex mutex;
  static std::map<std::pair<Transform, std::size_t>, Plan> plans;
  const std::scoped_lock lock(mutex);
  const auto found = plans.find({transform, n});
  if (found != plans.end()) return found->second;
  // What other threads still run stays: a plan is only ever destroyed here, under the mutex.
  if (plans.size() >= kMost) std::erase_if(plans, [](const auto& entry) { return entry.second.use_count() == 1; });
  return plans.emplace(std::pair{transform, n}, make_plan(transform, static_cast<int>(n))).first->second;
}

std::vector<double> real_to_real(std::vector<double> x, Transform transform) {
  if (x.empty()) return x;
  fftw_execute_r2r(plan_for(transform, x.size()).get(), x.data(), x.data());
  return x;
}

}  // namespace

std::vector<std::complex<double>> real_fourier(std::span<const double> x) {
  if (x.empty()) return {};
  std::vector<double> in(x.begin(), x.end());
  std::vector<std::complex<double>> out(x.size() / 2 + 1);
  fftw_execute_dft_r2c(plan_for(Transform::real_fourier, in.size()).get(), in.data(),
                       reinterpret_cast<fftw_complex*>(out.data()));
  return out;
}

std::vector<double> cosine_transform(std::span<const double> x) {
  auto y = real_to_real({x.begin(), x.end()}, Transform::cosine);
  if (y.empty()) return y;
  const double scale = std::sqrt(0.5 / static_cast<double>(y.size()));
  for (double& value : y) value *= scale;
  y[0] *= std::sqrt(0.5);
  return y;
}

std::vector<double> inverse_cosine_transform(std::span<const double> coefficients) {
  std::vector<double> y(coefficients.begin(), coefficients.end());
  if (y.empty()) return y;
  const double scale = std::sqrt(0.5 / static_cast<double>(y.size()));
  for (double& value : y) value *= scale;
  y[0] *= std::sqrt(2.0);
  return real_to_real(std::move(y), Transform::inverse_cosine);
}

}  // namespace touchstone::perception
