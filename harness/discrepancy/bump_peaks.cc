#include "harness/discrepancy/bump_peaks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "harness/base/least_squares.h"
#include "harness/discrepancy/local_stiffness.h"

namespace touchstone::discrepancy {
namespace {

constexpr std::size_t most_samples = 1200;
constexpr std::size_t fewest_samples = 30;
constexpr int places = 13;                                 // along each axis
constexpr std::array widths{0.04, 0.07, 0.12, 0.2, 0.33};  // of the extent
constexpr double least_seen = 1e-6;                        // of a bump's square, beyond what the nuisances take

struct Seen {
  Eigen::ArrayXd x_m;
  Eigen::ArrayXd y_m;
  Eigen::ArrayXd response;    // of the force along the normal to a bump of 1 at the sample
  Eigen::VectorXd left_N;     // along the normal, beyond the nuisances
  Eigen::MatrixXd nuisances;  // orthonormal columns

  [[nodiscard]] Eigen::VectorXd beyond_nuisances(const Eigen::VectorXd& column) const {
    return column - nuisances * (nuisances.transpose() * column);
  }
};

Seen look(const recording::Recording& recording, const rendering::Prediction& current, BumpOf of) {
  const std::size_t stride = std::max<std::size_t>(1, recording.size() / most_samples);
  const std::vector<std::size_t> touching = pressing_samples(current, stride);
  const std::vector<double> stiffness_N_per_m = stiffness_at(current, touching);
  const auto n = static_cast<Eigen::Index>(touching.size());
  Seen seen{Eigen::ArrayXd(n), Eigen::ArrayXd(n), Eigen::ArrayXd(n), Eigen::VectorXd(n), {}};
  Eigen::MatrixXd nuisances(n, 2);
  for (Eigen::Index row = 0; row < n; ++row) {
    const auto k = static_cast<std::size_t>(row);
    const std::size_t i = touching[k];
    seen.x_m[row] = recording.motion.p_W_m[i].x();
    seen.y_m[row] = recording.motion.p_W_m[i].y();
    seen.response[row] = of == BumpOf::stiffness ? current.normal_N[i] : stiffness_N_per_m[k];
    seen.left_N[row] = current.n_W[i].dot(recording.f_W_N[i] - current.f_W_N[i]);
    nuisances.row(row) << current.normal_N[i], 1.0;
  }
  if (touching.size() < fewest_samples) return seen;
  seen.nuisances = LeastSquares(nuisances).range();
  seen.left_N = seen.beyond_nuisances(seen.left_N);
  return seen;
}

bool within(const BumpPeak& a, const BumpPeak& b) {
  return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m) < 0.7 * std::max(a.width_m, b.width_m);
}

}  // namespace

std::vector<BumpPeak> bump_peaks(const recording::Recording& recording, const rendering::Prediction& current, BumpOf of,
                                 const Vec3& low_W_m, const Vec3& high_W_m, std::size_t count) {
  const Vec3 size_m = high_W_m - low_W_m;
  const double extent_m = size_m.head<2>().norm();
  const Seen seen = look(recording, current, of);
  const double total = seen.left_N.squaredNorm();
  std::vector<BumpPeak> all;
  if (seen.nuisances.size() == 0 || !(extent_m > 0.0) || !(total > 0.0)) return all;
  const auto gaussian = [](const Eigen::ArrayXd& at, double centre, double width) -> Eigen::ArrayXd {
    return (-0.5 * ((at - centre) / width).square()).exp();
  };
  for (const double share : widths) {
    const double width_m = share * extent_m;
    for (int column = 0; column < places; ++column) {
      const double x_m = low_W_m.x() + size_m.x() * column / (places - 1);
      const Eigen::ArrayXd along_x = seen.response * gaussian(seen.x_m, x_m, width_m);
      for (int row = 0; row < places; ++row) {
        const double y_m = low_W_m.y() + size_m.y() * row / (places - 1);
        const Eigen::VectorXd bump = (along_x * gaussian(seen.y_m, y_m, width_m)).matrix();
        const Eigen::VectorXd own = seen.beyond_nuisances(bump);
        const double square = own.squaredNorm();
        if (!(square > least_seen * seen.response.matrix().squaredNorm())) continue;
        const double along = own.dot(seen.left_N);
        all.push_back({along / square, x_m, y_m, width_m, along * along / (square * total)});
      }
    }
  }
  std::sort(all.begin(), all.end(), [](const BumpPeak& a, const BumpPeak& b) { return a.power > b.power; });
  std::vector<BumpPeak> peaks;
  for (const BumpPeak& peak : all) {
    if (peaks.size() == count) break;
    if (std::none_of(peaks.begin(), peaks.end(), [&](const BumpPeak& kept) { return within(peak, kept); })) {
      peaks.push_back(peak);
    }
  }
  return peaks;
}

}  // namespace touchstone::discrepancy
