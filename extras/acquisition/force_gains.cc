#include "force_gains.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "harness/base/least_squares.h"

namespace touchstone::acquisition {
namespace {

constexpr double clear_sigmas = 2.0;
constexpr Eigen::Index unknowns_of_axis = 4;

// The mean square of E f with E = A / m - 1 and the forces' second moments, and of what noise makes of it.
struct Square {
  double error2 = 0.0, noise2 = 0.0;
};
Square square_of(const ForceGains& gains, const Mat3& moments_N2, double mass_kg) {
  const Mat3 off = gains.mass_kg / mass_kg - Mat3::Identity();
  const double relative = gains.sigma_N / mass_kg;
  return {(off * moments_N2 * off.transpose()).trace(),
          3.0 * relative * relative * (gains.inverse_gravity_s4_m2 * moments_N2).trace()};
}

}  // namespace

ForceGains identify_gains(const std::vector<StaticPose>& poses, const Vec3& gravity_W) {
  ForceGains result;
  result.poses = poses.size();
  const auto n = static_cast<Eigen::Index>(poses.size());
  if (n <= unknowns_of_axis) return result;
  Eigen::MatrixXd columns(n, unknowns_of_axis), force(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const StaticPose& pose = poses[static_cast<std::size_t>(i)];
    columns.row(i) << (pose.q_WS.conjugate() * gravity_W).transpose(), gravity_W.norm();
    force.row(i) = pose.measured.f_N.transpose();
  }
  const LeastSquares fit(columns);
  if (fit.rank() < unknowns_of_axis) return result;
  const Eigen::MatrixXd found = fit.solve(force);
  result.determined = true;
  result.mass_kg = found.topRows<3>().transpose();
  result.sigma_N = std::sqrt((force - columns * found).squaredNorm() / static_cast<double>(3 * (n - unknowns_of_axis)));
  const Eigen::Matrix4d normal = columns.transpose() * columns;
  result.inverse_gravity_s4_m2 = normal.inverse().topLeftCorner<3, 3>();
  return result;
}

Vec3 ForceGains::gains(std::optional<double> weighed_kg) const {
  Vec3 sorted = mass_kg.diagonal();
  std::ranges::sort(sorted);
  return mass_kg.diagonal() / weighed_kg.value_or(sorted[1]);
}

Vec3 ForceGains::sigmas() const {
  return Vec3::Constant(sigma_N / (mass_kg.trace() / 3.0)).cwiseProduct(inverse_gravity_s4_m2.diagonal().cwiseSqrt());
}

GainError gain_error(const ForceGains& gains, const std::vector<Vec3>& contact_force_S_N, double contact_force_N,
                     std::optional<double> weighed_kg) {
  GainError result;
  if (contact_force_S_N.empty()) return result;
  Mat3 moments = Mat3::Zero();
  for (const Vec3& f : contact_force_S_N) moments += f * f.transpose() / static_cast<double>(contact_force_S_N.size());
  result.limit_N = std::max(0.25 * contact_force_N, largest_gain_error * std::sqrt(moments.trace()));
  if (!gains.determined) {
    result.error_N = result.sigma_N = std::numeric_limits<double>::quiet_NaN();
    result.doubt = fmt::format(
        "cannot tell whether the axes of the force have one gain: {} static poses do not determine their gains; {}",
        gains.poses, gain_poses);
    return result;
  }
  std::vector<double> masses;
  if (weighed_kg) {
    masses = {*weighed_kg};
  } else {
    const Mat3 symmetric = 0.5 * (gains.mass_kg + gains.mass_kg.transpose());
    const Vec3 own = Eigen::SelfAdjointEigenSolver<Mat3>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
    masses = {own[0], own[1], own[2]};
  }
  for (const double mass : masses) {
    const Square here = square_of(gains, moments, mass);
    if (const double error = std::sqrt(std::max(0.0, here.error2 - here.noise2));
        !(error + clear_sigmas * std::sqrt(here.noise2) < result.error_N + clear_sigmas * result.sigma_N))
      result.error_N = error, result.sigma_N = std::sqrt(here.noise2);
  }
  const Vec3 own = gains.gains(weighed_kg), sigma = gains.sigmas();
  const std::string figures = fmt::format(
      "of x, y and z they are {:.3f}, {:.3f} and {:.3f} (+- {:.2g}) of {}, by the static poses, so that the recorded "
      "force may be off by {:.2g} +- {:.2g} N RMS (limit {:.2g} N, a quarter of the contact force or 3 % of the force)",
      own.x(), own.y(), own.z(), clear_sigmas * sigma.maxCoeff(),
      weighed_kg ? "what the weighed mass makes" : "their middle one", result.error_N, clear_sigmas * result.sigma_N,
      result.limit_N);
  if (result.error_N - clear_sigmas * result.sigma_N > result.limit_N)
    result.fault = fmt::format(
        "the gains of the force's axes do not agree: {}: load the calibration of this very sensor, check its cable and "
        "amplifier, and measure the poses again",
        figures);
  else if (!(result.error_N + clear_sigmas * result.sigma_N <= result.limit_N))
    result.doubt = fmt::format("cannot tell whether the gains of the force's axes agree: {}; {}", figures, gain_poses);
  return result;
}

}  // namespace touchstone::acquisition
