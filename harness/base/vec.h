// Vectors, rotations and bounding boxes used everywhere. SI units inside: m, N, s, N/m, kg, rad.
// Names carry frame and unit: p_W_m is a position in the world (object) frame in metres, f_W_N a force in newtons.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace touchstone {

// Over another scalar than double, for code that also runs with counted.h's.
template <class Scalar>
using Vec3Of = Eigen::Matrix<Scalar, 3, 1>;

using Vec3 = Vec3Of<double>;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;
using Box3 = Eigen::AlignedBox3d;

// The scalar product in a fixed order. Eigen's own adds (x + y) + z for double and x + (y + z) for scalars that it
// cannot vectorise: code that must give the same bits with both uses these three. For double they are Eigen's to the
// bit.
template <class A, class B>
typename A::Scalar dot(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  return (a.coeff(0) * b.coeff(0) + a.coeff(1) * b.coeff(1)) + a.coeff(2) * b.coeff(2);
}
template <class A>
typename A::Scalar squared_norm(const Eigen::MatrixBase<A>& a) {
  const Vec3Of<typename A::Scalar> v = a;
  return dot(v, v);
}
// a / |a|; zero stays zero.
template <class A>
Vec3Of<typename A::Scalar> unit(const Eigen::MatrixBase<A>& a) {
  using std::sqrt;
  Vec3Of<typename A::Scalar> v = a;
  const typename A::Scalar square = dot(v, v);
  if (!(square > typename A::Scalar(0.0))) return v;
  return v / sqrt(square);
}

}  // namespace touchstone
