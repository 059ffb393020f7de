#include "harness/perception/filters/output_band.h"

#include <fmt/format.h>

#include "harness/base/error.h"
#include "harness/perception/fourier.h"

namespace touchstone::perception {

std::vector<double> output_band(std::span<const double> x, double rate_Hz, double limit_Hz) {
  if (!(rate_Hz > 0.0) || !(limit_Hz > 0.0)) {
    throw UsageError(
        fmt::format("the output band needs a rate and a limit above 0 Hz, not {} and {}", rate_Hz, limit_Hz));
  }
  auto coefficients = cosine_transform(x);
  // Coefficient k belongs to the frequency k rate / (2 N).
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    const double f_Hz = static_cast<double>(k) * rate_Hz / (2.0 * static_cast<double>(coefficients.size()));
    if (f_Hz > limit_Hz) coefficients[k] = 0.0;
  }
  return inverse_cosine_transform(coefficients);
}

}  // namespace touchstone::perception
