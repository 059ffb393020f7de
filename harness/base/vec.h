// Vectors, rotations and bounding boxes used everywhere. SI units inside: m, N, s, N/m, kg, rad.
// Names carry frame and unit: p_W_m is a position in the world (object) frame in metres, f_W_N a force in newtons.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace touchstone {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;
using Box3 = Eigen::AlignedBox3d;

}  // namespace touchstone
