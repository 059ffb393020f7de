#include "harness/metrics/force_axes.h"

#include <fmt/format.h>

#include <cmath>

#include "harness/metrics/result.h"

namespace touchstone::metrics {
namespace {

constexpr std::array<char, 3> axes{'x', 'y', 'z'};

}  // namespace

void ForceAxes::add(const MetricSample& sample) {
  const Vec3 error = sample.f_rendered_W_N - sample.f_measured_W_N;
  const bool finite = error.allFinite();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    // A force with one component that is not a number is no force: all three axes are invalid.
    error_[axis].add(sample.t_s, finite ? error[i] : std::nan(""));
    measured_[axis].add(sample.t_s, sample.f_measured_W_N[i]);
  }
}

std::vector<MetricResult> ForceAxes::results() {
  std::vector<MetricResult> out;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.push_back(make_result(fmt::format("rms_force_error_{}", axes[axis]), "N",
                              fmt::format("Root mean square of the force error along {}.", axes[axis]),
                              error_[axis].rms(), error_[axis]));
    set_reference(out.back(), measured_[axis].rms(), fmt::format("RMS of the measured force along {}", axes[axis]));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.push_back(make_result(fmt::format("bias_force_error_{}", axes[axis]), "N",
                              fmt::format("Mean of rendered minus measured force along {}.", axes[axis]),
                              error_[axis].mean(), error_[axis]));
    set_reference(out.back(), measured_[axis].mean(), fmt::format("mean measured force along {}", axes[axis]));
  }
  return out;
}

}  // namespace touchstone::metrics
