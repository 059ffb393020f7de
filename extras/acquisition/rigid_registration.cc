#include "rigid_registration.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/base/error.h"
#include "harness/stats/distributions.h"

namespace touchstone::acquisition {

namespace {

// Lengths that differ by a factor between tracker and object: one more parameter, which takes (s - 1)^2 sum |from|^2
// from the sum of squares (Umeyama 1991, equation 42), by Fisher's F with 1 and 3 n - 7 degrees of freedom.
void refuse_scale(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to, double left2, const std::string& source) {
  constexpr double one_in_ten_thousand = 1e-4, most_m = 0.5e-3, most_factor = 0.1;
  const double size2 = from.squaredNorm(), n = static_cast<double>(from.cols());
  const double longer = size2 / from.cwiseProduct(to).sum() - 1.0;
  const double taken2 = std::min(left2, longer * longer * size2), freedom = 3.0 * n - 7.0;
  const double off_m = std::abs(longer) * std::sqrt(size2 / n);
  // Other markers, or mirrored ones, fit with no factor: their residual says so.
  if (!(off_m > most_m) || std::abs(longer) > most_factor) return;
  const double f = taken2 / ((left2 - taken2) / freedom);
  if (std::isfinite(f) && !(stats::f_tail(f, 1.0, freedom) < one_in_ten_thousand)) return;
  throw BadData(fmt::format(
      "{}: by the tracker the markers are {:.2g} % farther from each other than on the object ({:.2g} mm; without it "
      "they "
      "fit to {:.2g} mm instead of {:.2g} mm RMS): calibrate the tracker, or scan the object again",
      source, 100.0 * longer, 1e3 * off_m, 1e3 * std::sqrt((left2 - taken2) / n), 1e3 * std::sqrt(left2 / n)));
}

}  // namespace

MarkerRegistration register_markers(const std::vector<Vec3>& tracker_m, const std::vector<Vec3>& object_m,
                                    const std::string& source) {
  if (tracker_m.size() != object_m.size()) {
    throw BadData(
        fmt::format("{}: {} markers of the tracker and {} of the object; they must be the same ones in the same order: "
                    "one line each, with both places",
                    source, tracker_m.size(), object_m.size()));
  }
  if (tracker_m.size() < 3)
    throw BadData(fmt::format("{}: has {} markers; at least 3 are needed, better 4: add more of the object's", source,
                              tracker_m.size()));
  const auto n = static_cast<Eigen::Index>(tracker_m.size());
  Eigen::Matrix3Xd from(3, n), to(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    from.col(i) = tracker_m[static_cast<std::size_t>(i)];
    to.col(i) = object_m[static_cast<std::size_t>(i)];
  }
  if (!from.allFinite() || !to.allFinite())
    throw BadData(fmt::format(
        "{}: a marker's position is not a finite number; leave out a marker that the tracker did not see", source));

  MarkerRegistration result;
  result.markers = tracker_m.size();
  result.centroid_m = to.rowwise().mean();
  // The principal axes of the markers, least variance first. The mean square distance from an axis is the sum of the
  // variances along the two others.
  const Eigen::Matrix3Xd centred = to.colwise() - result.centroid_m;
  const Eigen::SelfAdjointEigenSolver<Mat3> principal(centred * centred.transpose() / static_cast<double>(n));
  result.axes = principal.eigenvectors();
  const Vec3 variance = principal.eigenvalues().cwiseMax(0.0);
  result.spread_m = Vec3(std::sqrt(variance[1] + variance[2]), std::sqrt(variance[0] + variance[2]),
                         std::sqrt(variance[0] + variance[1]));
  // On one line the turn about it is free. A thousandth of the line's length is what trackers resolve.
  const auto on_a_line = [](const Vec3& eigenvalues) { return !(eigenvalues[1] > 1e-6 * eigenvalues[2]); };
  const Eigen::Matrix3Xd from_centred = from.colwise() - from.rowwise().mean().eval();
  const Eigen::SelfAdjointEigenSolver<Mat3> from_principal(
      from_centred * from_centred.transpose() / static_cast<double>(n), Eigen::EigenvaluesOnly);
  if (on_a_line(variance) || on_a_line(from_principal.eigenvalues())) {
    throw BadData(fmt::format(
        "{}: the markers lie on one line, so the turn about it cannot be known; add a marker beside it", source));
  }
  // R = U diag(1, 1, det U det V) V' from the singular values of the covariance of both sets about their means, and
  // t = mean(to) - R mean(from) (Umeyama 1991, equations 40 to 42).
  const Eigen::Matrix4d transform = Eigen::umeyama(from, to, false);
  result.tracker_to_object.q = Quat(Mat3(transform.topLeftCorner<3, 3>())).normalized();
  result.tracker_to_object.t_m = transform.topRightCorner<3, 1>();
  double sum = 0.0;
  for (std::size_t i = 0; i < tracker_m.size(); ++i) {
    result.residual_m.push_back((result.tracker_to_object.point(tracker_m[i]) - object_m[i]).norm());
    sum += result.residual_m.back() * result.residual_m.back();
  }
  result.residual_rms_m = std::sqrt(sum / static_cast<double>(n));
  refuse_scale(from_centred, result.tracker_to_object.q.toRotationMatrix().transpose() * centred, sum, source);
  return result;
}

double MarkerRegistration::expected_error_m(const Vec3& p_object_m) const {
  if (markers < 4) return std::numeric_limits<double>::quiet_NaN();
  const auto n = static_cast<double>(markers);
  // Fitzpatrick, West and Maurer 1998: the residual of n markers is FRE^2 = (1 - 2 / n) FLE^2 (Sibson 1979), for six of
  // their 3 n numbers are fitted, and at a place with distance d_k from the k-th principal axis
  //   TRE^2 = FLE^2 / n (1 + 1/3 sum over k of d_k^2 / f_k^2)   (equation 46), f_k the markers' own such distance.
  const double localisation = residual_rms_m * residual_rms_m / (1.0 - 2.0 / n);
  const Vec3 d = axes.transpose() * (p_object_m - centroid_m);
  double sum = 0.0;
  // d_k^2 = |d|^2 - (d along the axis)^2.
  for (int k = 0; k < 3; ++k) sum += (d.squaredNorm() - d[k] * d[k]) / (spread_m[k] * spread_m[k]);
  return std::sqrt(localisation / n * (1.0 + sum / 3.0));
}

}  // namespace touchstone::acquisition
