#include "harness/perception/features/change_rate.h"

namespace touchstone::perception {

std::vector<double> change_rate(const SparseSeries& series, double rate_Hz) {
  std::vector<double> result(series.held.size(), 0.0);
  for (std::size_t i = 0; i + 1 < series.kept.size(); ++i) {
    const std::size_t from = series.kept[i];
    const std::size_t to = series.kept[i + 1];
    const double slope = (series.held[to] - series.held[from]) * rate_Hz / static_cast<double>(to - from);
    for (std::size_t t = from; t < to; ++t) result[t] = slope;
  }
  return result;
}

}  // namespace touchstone::perception
