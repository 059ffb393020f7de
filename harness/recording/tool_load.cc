#include "harness/recording/tool_load.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <cmath>
#include <limits>

#include "harness/base/error.h"
#include "harness/recording/raw_table.h"

namespace touchstone::recording {
namespace {

constexpr Eigen::Index unknowns = 10;
using Matrix10 = Eigen::Matrix<double, unknowns, unknowns>;
// Smallest singular value of the scaled system that counts as information: orientations a third of a degree apart.
constexpr double rank_tolerance = 5e-3;

struct Solution {
  Eigen::Matrix<double, unknowns, 1> x;
  Matrix10 inverse_normal;  // (A^T A)^-1
  Eigen::Index rank = 0;
  double condition = std::numeric_limits<double>::infinity();
};

// At rest the sensor shows F = m g_S + b_F and T = c x (m g_S) + b_T = -[g_S]x (m c) + b_T, g_S gravity in its own
// axes: linear in m, m c, b_F and b_T, the ten unknowns in this order.
void fill(const StaticPose& pose, const Vec3& gravity_W, Eigen::Ref<Eigen::MatrixXd> a, Eigen::Ref<Eigen::VectorXd> b) {
  const Vec3 g = pose.q_WS.conjugate() * gravity_W;
  a.setZero();
  a.block<3, 1>(0, 0) = g;
  a.block<3, 3>(0, 4).setIdentity();
  a.block<3, 3>(3, 1) << 0, g.z(), -g.y(), -g.z(), 0, g.x(), g.y(), -g.x(), 0;  // -[g]x
  a.block<3, 3>(3, 7).setIdentity();
  b << pose.measured.f_N, pose.measured.torque_Nm;
}

Eigen::MatrixXd rows_of(const std::vector<StaticPose>& poses, const Vec3& gravity_W, Eigen::VectorXd& b) {
  const auto n = static_cast<Eigen::Index>(poses.size());
  Eigen::MatrixXd a(6 * n, unknowns);
  b.resize(6 * n);
  for (Eigen::Index i = 0; i < n; ++i)
    fill(poses[static_cast<std::size_t>(i)], gravity_W, a.middleRows(6 * i, 6), b.segment(6 * i, 6));
  return a;
}

Solution solve(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  // Columns of one length: kilograms, metres and newtons do not compare. Then A D^-1 = U S V', x = D^-1 V S^-1 U' b and
  // (A' A)^-1 = H H' with H = D^-1 V S^-1, D the lengths.
  const Eigen::VectorXd scale = a.colwise().norm().transpose();
  Eigen::VectorXd inverse_scale = scale;
  for (Eigen::Index i = 0; i < unknowns; ++i) inverse_scale[i] = scale[i] > 0.0 ? 1.0 / scale[i] : 0.0;
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(a * inverse_scale.asDiagonal(), Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(rank_tolerance);
  Solution solution;
  solution.rank = svd.rank();
  if (solution.rank < unknowns) return solution;
  const auto& s = svd.singularValues();  // as many as unknowns: fewer rows would be of a lower rank
  solution.condition = s[0] / s[unknowns - 1];
  solution.x = inverse_scale.asDiagonal() * svd.solve(b);
  const Eigen::MatrixXd half = inverse_scale.asDiagonal() * svd.matrixV() * s.cwiseInverse().asDiagonal();
  solution.inverse_normal = half * half.transpose();
  return solution;
}

// Whether rows with these normal equations determine all unknowns: by the same singular values as in solve().
bool determined(const Matrix10& normal) {
  const Eigen::Matrix<double, unknowns, 1> scale = normal.diagonal().cwiseSqrt();
  if (!(scale.minCoeff() > 0.0)) return false;
  const Matrix10 scaled = scale.cwiseInverse().asDiagonal() * normal * scale.cwiseInverse().asDiagonal();
  const auto squares = Eigen::SelfAdjointEigenSolver<Matrix10>(scaled, Eigen::EigenvaluesOnly).eigenvalues();
  return squares[0] > rank_tolerance * rank_tolerance * squares[unknowns - 1];
}

// Each pose predicted from the fit to the others. With the hat matrix' block H_i = A_i (A' A)^-1 A_i' of the pose's six
// rows A_i, what the fit without it leaves there is (1 - H_i)^-1 times what the fit with it leaves (Cook and Weisberg,
// Residuals and Influence in Regression, 1982, section 2.2): one pass, not a fit for each pose.
std::vector<Wrench> held_out_errors(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, const Solution& all) {
  std::vector<Wrench> errors;
  const Matrix10 normal = a.transpose() * a;
  for (Eigen::Index row = 0; row < a.rows(); row += 6) {
    const Eigen::Matrix<double, 6, unknowns> own = a.middleRows<6>(row);
    if (!determined(normal - own.transpose() * own)) continue;
    const Eigen::Matrix<double, 6, 1> left = b.segment<6>(row) - own * all.x;
    const Eigen::Matrix<double, 6, 6> rest =
        Eigen::Matrix<double, 6, 6>::Identity() - own * all.inverse_normal * own.transpose();
    const Eigen::Matrix<double, 6, 1> held_out = rest.ldlt().solve(left);
    errors.push_back({held_out.head<3>(), held_out.tail<3>()});
  }
  return errors;
}

ToolLoad load_of(const Eigen::Matrix<double, unknowns, 1>& x) {
  ToolLoad load;
  load.mass_kg = x[0];
  load.center_S_m = x.segment<3>(1) / x[0];
  load.bias = {x.segment<3>(4), x.segment<3>(7)};
  return load;
}

Wrench error_of(const StaticPose& pose, const ToolLoad& load, const Vec3& gravity_W) {
  const Wrench predicted = tool_wrench(load, pose.q_WS, gravity_W);
  return {pose.measured.f_N - predicted.f_N, pose.measured.torque_Nm - predicted.torque_Nm};
}

}  // namespace

WrenchResidual residual_of(const std::vector<Wrench>& errors) {
  WrenchResidual residual;
  residual.samples = errors.size();
  if (errors.empty()) return residual;
  Vec3 force = Vec3::Zero();
  double torque = 0.0;
  for (const Wrench& e : errors) {
    force += e.f_N.cwiseAbs2();
    torque += e.torque_Nm.squaredNorm();
  }
  const auto n = static_cast<double>(errors.size());
  residual.force_axis_N = (force / n).cwiseSqrt();
  residual.force_vector_N = std::sqrt(force.sum() / n);
  residual.force_component_N = std::sqrt(force.sum() / (3 * n));
  residual.torque_component_Nm = std::sqrt(torque / (3 * n));
  return residual;
}

Wrench tool_wrench(const ToolLoad& load, const Quat& q_WS, const Vec3& gravity_W_m_per_s2) {
  const Vec3 weight = load.mass_kg * (q_WS.conjugate() * gravity_W_m_per_s2);
  return {load.bias.f_N + weight, load.bias.torque_Nm + load.center_S_m.cross(weight)};
}

Wrench contact_wrench_at_tip(const Wrench& measured, const ToolLoad& load, const Quat& q_WS,
                             const Vec3& gravity_W_m_per_s2, const Vec3& tip_S_m) {
  const Wrench own = tool_wrench(load, q_WS, gravity_W_m_per_s2);
  return wrench_about({measured.f_N - own.f_N, measured.torque_Nm - own.torque_Nm}, tip_S_m);
}

std::vector<StaticPose> read_static_poses(const std::filesystem::path& path, bool bare_is_si) {
  const RawTable table(path);
  const auto f = table.vectors("f", force_units, bare_is_si), torque = table.vectors("t", torque_units, bare_is_si);
  const auto q = table.rotations();
  std::vector<StaticPose> poses;
  poses.reserve(table.rows());
  for (std::size_t i = 0; i < table.rows(); ++i) poses.push_back({q[i], {f[i], torque[i]}});
  return poses;
}

ToolIdentification identify_tool(const std::vector<StaticPose>& poses, const Vec3& gravity_W_m_per_s2,
                                 const std::string& source) {
  if (!(gravity_W_m_per_s2.norm() > 0.0) || !gravity_W_m_per_s2.allFinite()) {
    throw BadData(
        fmt::format("{}: gravity is zero or not finite; a weight cannot be found without it: give "
                    "/tool/gravity_T_m_per_s2 (or --gravity), [0, 0, -9.81] if z is up",
                    source));
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!poses[i].measured.finite() || !(std::abs(poses[i].q_WS.norm() - 1.0) < 1e-6)) {
      throw BadData(fmt::format(
          "{}: static orientation {} is not finite or not a rotation; take that line out, or fix its qw, qx, qy, qz",
          source, i + 1));
    }
  }
  if (poses.empty())
    throw BadData(fmt::format(
        "{}: has no static orientations; at least 3 are needed, better 6: hold the probe still in each", source));
  Eigen::VectorXd right;
  const Eigen::MatrixXd rows_of_all = rows_of(poses, gravity_W_m_per_s2, right);
  const Solution all = solve(rows_of_all, right);
  if (all.rank < unknowns) {
    throw BadData(fmt::format(
        "{}: {} static orientations determine only {} of the 10 unknowns (mass, 3 centre of mass, 3 + 3 bias): gravity "
        "must point along at "
        "least 3 directions of the sensor that do not lie in one line; turn the probe about two axes and record again",
        source, poses.size(), all.rank));
  }
  ToolIdentification result;
  result.load = load_of(all.x);
  result.condition = all.condition;
  std::vector<Wrench> errors;
  errors.reserve(poses.size());
  for (const StaticPose& pose : poses) errors.push_back(error_of(pose, result.load, gravity_W_m_per_s2));
  result.fit = residual_of(errors);

  // Force and torque rows share no unknown: mass and b_F (4) come from forces, m c and b_T (6) from torques.
  const auto rows = static_cast<double>(3 * poses.size());
  const auto n = static_cast<double>(poses.size());
  // Residual squares over the degrees of freedom that are left, and (A' A)^-1 times it: the covariance of least
  // squares.
  const double force_variance = rows > 4 ? 3 * n * std::pow(result.fit.force_component_N, 2) / (rows - 4) : 0.0;
  const double torque_variance = rows > 6 ? 3 * n * std::pow(result.fit.torque_component_Nm, 2) / (rows - 6) : 0.0;
  result.mass_sigma_kg = std::sqrt(force_variance * all.inverse_normal(0, 0));
  for (int i = 0; i < 3; ++i) {
    result.bias_force_sigma_N[i] = std::sqrt(force_variance * all.inverse_normal(4 + i, 4 + i));
    // c = (m c) / m, so that to first order var(c) = (var(m c) + c^2 var(m)) / m^2.
    result.center_sigma_m[i] = std::hypot(std::sqrt(torque_variance * all.inverse_normal(1 + i, 1 + i)),
                                          result.load.center_S_m[i] * result.mass_sigma_kg) /
                               std::abs(result.load.mass_kg);
  }

  if (poses.size() > 3) result.held_out = residual_of(held_out_errors(rows_of_all, right, all));
  return result;
}

}  // namespace touchstone::recording
