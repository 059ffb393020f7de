#include "harness/metrics/error_map.h"

#include <cmath>

namespace touchstone::metrics {

std::size_t ErrorMap::Hash::operator()(const Key& key) const noexcept {
  // Large odd multipliers (Teschner et al. 2003, "Optimized spatial hashing", use primes likewise).
  std::uint64_t h = 0;
  for (const std::int64_t k : key) h = (h ^ static_cast<std::uint64_t>(k)) * 0x9E3779B97F4A7C15u;
  return static_cast<std::size_t>(h ^ (h >> 29));
}

ErrorMap::Key ErrorMap::key(const Vec3& p_W_m) const {
  Key out{};
  for (std::size_t i = 0; i < 3; ++i) {
    out[i] = static_cast<std::int64_t>(std::floor(p_W_m[static_cast<Eigen::Index>(i)] / cell_m_));
  }
  return out;
}

void ErrorMap::add(const Vec3& contact_W_m, double error) {
  // Beyond 2^62 cubes from the origin a point has no cube; nothing physical lies there.
  if (!std::isfinite(error) || !((contact_W_m / cell_m_).cwiseAbs().maxCoeff() < 0x1p62)) return;
  Cell& cell = cells_[key(contact_W_m)];
  cell.sum += error;
  cell.count += 1.0;
}

std::optional<double> ErrorMap::at(const Vec3& p_W_m) const {
  if (!((p_W_m / cell_m_).cwiseAbs().maxCoeff() < 0x1p62)) return std::nullopt;
  const Key centre = key(p_W_m);
  double sum = 0.0;
  double weight = 0.0;
  for (std::int64_t x = -2; x <= 2; ++x) {
    for (std::int64_t y = -2; y <= 2; ++y) {
      for (std::int64_t z = -2; z <= 2; ++z) {
        const auto found = cells_.find({centre[0] + x, centre[1] + y, centre[2] + z});
        if (found == cells_.end()) continue;
        Vec3 middle;
        for (std::size_t i = 0; i < 3; ++i) {
          middle[static_cast<Eigen::Index>(i)] = (static_cast<double>(found->first[i]) + 0.5) * cell_m_;
        }
        const double r = (middle - p_W_m).norm() / cell_m_;
        if (r > 1.5) continue;
        const double w = std::exp(-r * r) * found->second.count;
        sum += w * found->second.sum / found->second.count;
        weight += w;
      }
    }
  }
  if (weight == 0.0) return std::nullopt;
  return sum / weight;
}

}  // namespace touchstone::metrics
