#include "harness/perception/fourier.h"

#include <fftw3.h>

#include <cmath>
#include <memory>
#include <mutex>

namespace touchstone::perception {
namespace {

// Only fftw_execute may run in parallel; planning may not.
std::mutex& planner() {
  static std::mutex mutex;
  return mutex;
}

struct DestroyPlan {
  void operator()(fftw_plan_s* plan) const {
    const std::scoped_lock lock(planner());
    fftw_destroy_plan(plan);
  }
};
using Plan = std::unique_ptr<fftw_plan_s, DestroyPlan>;

std::vector<double> real_to_real(std::vector<double> x, fftw_r2r_kind kind) {
  if (x.empty()) return x;
  Plan plan;
  {
    const std::scoped_lock lock(planner());
    plan.reset(fftw_plan_r2r_1d(static_cast<int>(x.size()), x.data(), x.data(), kind, FFTW_ESTIMATE));
  }
  fftw_execute(plan.get());
  return x;
}

}  // namespace

std::vector<std::complex<double>> real_fourier(std::span<const double> x) {
  if (x.empty()) return {};
  std::vector<double> in(x.begin(), x.end());
  std::vector<std::complex<double>> out(x.size() / 2 + 1);
  Plan plan;
  {
    const std::scoped_lock lock(planner());
    plan.reset(fftw_plan_dft_r2c_1d(static_cast<int>(in.size()), in.data(), reinterpret_cast<fftw_complex*>(out.data()),
                                    FFTW_ESTIMATE));
  }
  fftw_execute(plan.get());
  return out;
}

std::vector<double> cosine_transform(std::span<const double> x) {
  auto y = real_to_real({x.begin(), x.end()}, FFTW_REDFT10);
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
  return real_to_real(std::move(y), FFTW_REDFT01);
}

}  // namespace touchstone::perception
