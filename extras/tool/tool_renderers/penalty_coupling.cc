#include "tool_renderers/penalty_coupling.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "harness/surface/embree_surface.h"
#include "tool_renderers/shell_parameters.h"

namespace touchstone::tool_renderers {
namespace {

std::vector<Ball> point_balls(const tool::PointShell& shell) {
  std::vector<Ball> balls;
  balls.reserve(shell.size());
  for (const Vec3& p : shell.p_T_m) balls.push_back({p, 0.0});
  return balls;
}

Mat3 cross_matrix(const Vec3& v) {
  Mat3 m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

// About the tool's origin, axes of W.
Mat6 inertia(const tool::MassFrame& mass, const Mat3& rotation) {
  const Mat3 c = cross_matrix(rotation * mass.center_T_m);
  Mat6 m;
  m.topLeftCorner<3, 3>() = mass.mass_kg * Mat3::Identity();
  m.topRightCorner<3, 3>() = -mass.mass_kg * c;
  m.bottomLeftCorner<3, 3>() = mass.mass_kg * c;
  m.bottomRightCorner<3, 3>() = rotation * mass.inertia_T_kg_m2 * rotation.transpose() - mass.mass_kg * c * c;
  return m;
}

}  // namespace

tool::ToolRendererEntry penalty_coupling_entry() {
  tool::ToolRendererEntry entry;
  entry.name = "penalty-coupling";
  entry.summary = "penalty forces on a tool with mass behind a virtual coupling";
  entry.source = "Colgate, Stanley and Brown 1995; Otaduy and Lin 2006";
  entry.parameters = {contact_stiffness_parameter(), point_spacing_parameter(), tool::friction_parameter()};
  entry.takes_points = true;
  entry.make = [](const rendering::Parameters& parameters, const tool::Tool& tool,
                  const surface::TriangleMesh& object_W,
                  const tool::Coupling& coupling) -> std::unique_ptr<tool::ToolRenderer> {
    return std::make_unique<PenaltyCoupling>(
        tool, shell_of(tool, parameters.at("point_spacing_m")), make_embree_surface(object_W), coupling,
        parameters.at("contact_stiffness_N_per_m"), parameters.at(tool::friction_parameter_name));
  };
  entry.resolution_m = [](const rendering::Parameters& parameters, double force_N) {
    return force_N / parameters.at("contact_stiffness_N_per_m");
  };
  return entry;
}

PenaltyCoupling::PenaltyCoupling(const tool::Tool& tool, const tool::PointShell& shell,
                                 std::shared_ptr<const surface::Surface> object, const tool::Coupling& coupling,
                                 double contact_stiffness_N_per_m, double mu)
    : mass_(tool.mass),
      shell_(shell),
      tree_(point_balls(shell_)),
      distances_(std::move(object), tree_.size()),
      coupling_(coupling),
      stiffness_N_per_m_(contact_stiffness_N_per_m) {
  if (mu > 0.0) friction_.emplace(shell_.size(), mu, contact_stiffness_N_per_m);
}

tool::ToolResult PenaltyCoupling::do_step(const tool::ToolState& state, double dt_s) noexcept {
  if (!placed_) {
    proxy_ = handle_ = state.handle;
    velocity_.setZero();
    placed_ = true;
  }
  tool::ToolResult result;
  result.proxy = proxy_;
  if (dt_s > 0.0) {
    const Mat3 rotation = proxy_.q_WT.toRotationMatrix();
    Vec6 push = Vec6::Zero();
    Mat6 give = Mat6::Zero();
    std::size_t touching = 0;
    std::size_t listed = 0;
    if (friction_) friction_->begin_step();
    std::array<std::int32_t, SphereTree::stack_depth>
        stack;  // NOLINT(cppcoreguidelines-pro-type-member-init): written first
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
      const std::int32_t index = stack[--size];
      const SphereTree::Node& node = tree_.node(index);
      const Vec3 r = rotation * node.ball.center;
      const Vec3 p = proxy_.p_W_m + r;
      const auto known = distances_.side(static_cast<std::size_t>(index), p, node.ball.radius);
      if (known == DistanceBounds::Side::beyond) continue;
      surface::SurfacePoint near;
      if (known == DistanceBounds::Side::unknown || node.child < 0) {
        near = distances_.ask(static_cast<std::size_t>(index), p);
        if (near.signed_distance_m > node.ball.radius) continue;  // all of it is outside
      }
      if (node.child >= 0) {
        stack[size++] = node.child + 1;
        stack[size++] = node.child;
        continue;
      }
      const double depth = -near.signed_distance_m;
      if (!(depth > 0.0)) continue;
      const Vec3 n = (near.p_W_m - p) / depth;
      Vec3 force;
      if (friction_) {
        force = friction_->touch(node.item, p, r, n, depth);
      } else {
        Vec6 w;
        w << n, r.cross(n);
        push += stiffness_N_per_m_ * depth * w;
        give.noalias() += stiffness_N_per_m_ * w * w.transpose();
        force = stiffness_N_per_m_ * depth * n;
      }
      if (listed < most_contacts) contacts_[listed++] = {p, n, force};
      ++touching;
    }
    const Wrench pull = coupling_wrench(coupling_, state.handle, proxy_);
    push.head<3>() -= pull.f_N;
    push.tail<3>() -= pull.torque_Nm;
    const Mat6 mass = inertia(mass_, rotation);
    Mat6 matrix = mass / (dt_s * dt_s) + give;
    matrix.diagonal().head<3>().array() += coupling_.stiffness_N_per_m;
    matrix.diagonal().tail<3>().array() += coupling_.rotational_stiffness_Nm_per_rad;
    // Critical: 2 sqrt(k m) for each direction.
    Vec6 damping;
    for (int k = 0; k < 6; ++k) {
      const double stiffness = k < 3 ? coupling_.stiffness_N_per_m : coupling_.rotational_stiffness_Nm_per_rad;
      damping[k] = 2.0 * std::sqrt(stiffness * mass(k, k));
      matrix(k, k) += damping[k] / dt_s;
    }
    const tool::Displacement hand = displacement(handle_, state.handle);
    Vec6 hand_velocity;
    hand_velocity << hand.translation_m / dt_s, hand.rotation_rad / dt_s;
    const Vec6 right = push + mass * velocity_ / dt_s + damping.cwiseProduct(hand_velocity);
    const Vec6 by = friction_ ? friction_->displacement(matrix, right) : Vec6(Eigen::LLT<Mat6>(matrix).solve(right));
    velocity_ = by / dt_s;
    proxy_ = moved(proxy_, {by.head<3>(), by.tail<3>()});
    result.contact = touching > 0;
    result.contacts = {contacts_.data(), listed};
    result.proxy = proxy_;
  }
  handle_ = state.handle;
  if (result.contact) {
    const Wrench wrench = coupling_wrench(coupling_, state.handle, proxy_);
    result.f_W_N = wrench.f_N;
    result.torque_W_Nm = wrench.torque_Nm;
  }
  return result;
}

}  // namespace touchstone::tool_renderers
