// The tracker's frame to the object's by markers seen in both (2006 paper, section 2: "the location of the optical
// tracking markers are included in the scan"): the rotation and translation of least squares, without scale.
// Source: Umeyama 1991, equations 40-42 (Kabsch 1976 with the determinant's sign). Expected target error:
// Fitzpatrick, West and Maurer 1998, equation 46.
#pragma once

#include <string>
#include <vector>

#include "harness/base/vec.h"

namespace touchstone::acquisition {

// A small move, shift and turn, and what is known of it.
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

struct RigidTransform {
  Quat q = Quat::Identity();
  Vec3 t_m = Vec3::Zero();

  [[nodiscard]] Vec3 point(const Vec3& p) const { return q * p + t_m; }
};
// First b, then a.
inline RigidTransform operator*(const RigidTransform& a, const RigidTransform& b) {
  return {(a.q * b.q).normalized(), a.q * b.t_m + a.t_m};
}

struct MarkerRegistration {
  RigidTransform tracker_to_object;
  std::vector<double> residual_m;  // per marker
  double residual_rms_m = 0.0;     // fiducial registration error
  Vec3 centroid_m = Vec3::Zero();  // of the markers, object frame
  Mat3 axes = Mat3::Identity();    // principal axes of the markers, columns
  Vec3 spread_m = Vec3::Zero();    // root mean square distance of the markers from each of these axes
  std::size_t markers = 0;

  // What the markers' own error lets expect at a point of the object, root mean square. NaN with three markers or fewer
  // where their residual says nothing about it.
  [[nodiscard]] double expected_error_m(const Vec3& p_object_m) const;
};

// Throws BadData for fewer than three markers, for markers on one line, for lists of different length, and where the
// tracker's lengths differ from the object's by a factor that is clear and worth more than half a millimetre.
MarkerRegistration register_markers(const std::vector<Vec3>& tracker_m, const std::vector<Vec3>& object_m,
                                    const std::string& source);

}  // namespace touchstone::acquisition
