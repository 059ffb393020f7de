#include "contacts/quasi_static.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/base/least_squares.h"

namespace touchstone::contacts {
using tool::Coupling;
using tool::Displacement;
using tool::Pose;

namespace {

// Solutions within rounding of the balance: 1e-13 of a newton and a metre at forces of a few newtons.
constexpr double largest_residual = 1e-12;
constexpr double slack = 1e-12;  // m and N: rounding of gaps that touch in exact arithmetic
constexpr int rounds = 60;
constexpr double derivative_step = 1e-6;  // m and rad: only the speed of Newton's method depends on it

struct Candidate {
  Pose pose;
  Eigen::VectorXd l;
};

// How each contact pushes: along its normal, and by friction against the way that it slides.
struct Slide {
  double mu = 0.0;
  Vec3 velocity_W = Vec3::Zero();

  [[nodiscard]] Vec3 push(const Gap& gap) const {
    if (mu == 0.0) return gap.n_W;
    return gap.n_W - mu * unit(velocity_W - gap.n_W.dot(velocity_W) * gap.n_W);
  }
};

Eigen::VectorXd residual(const std::vector<GapOfPose>& gaps, const std::vector<std::size_t>& touching,
                         const Pose& handle, const Coupling& coupling, const Slide& slide, const Pose& pose,
                         const Eigen::VectorXd& l) {
  Eigen::VectorXd r(6 + static_cast<Eigen::Index>(touching.size()));
  const Wrench pull = coupling_wrench(coupling, handle, pose);
  r.head<3>() = pull.f_N;
  r.segment<3>(3) = pull.torque_Nm;
  for (std::size_t k = 0; k < touching.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const Gap gap = gaps[touching[k]](pose);
    const Vec3 push = slide.push(gap);
    r.head<3>() -= l[i] * push;
    r.segment<3>(3) -= l[i] * (gap.contact_W_m - pose.p_W_m).cross(push);
    // As a force, so that all rows have one scale.
    r[6 + i] = coupling.stiffness_N_per_m * gap.gap_m;
  }
  return r;
}

bool newton(const std::vector<GapOfPose>& gaps, const std::vector<std::size_t>& touching, const Pose& handle,
            const Coupling& coupling, const Slide& slide, Candidate& at) {
  const auto size = 6 + static_cast<Eigen::Index>(touching.size());
  for (int round = 0; round < rounds; ++round) {
    const Eigen::VectorXd r = residual(gaps, touching, handle, coupling, slide, at.pose, at.l);
    if (!r.allFinite()) return false;
    if (r.norm() < largest_residual) return true;
    Eigen::MatrixXd slope(size, size);
    for (Eigen::Index c = 0; c < size; ++c) {
      Displacement step;
      Eigen::VectorXd dl = Eigen::VectorXd::Zero(size - 6);
      if (c < 3)
        step.translation_m[c] = derivative_step;
      else if (c < 6)
        step.rotation_rad[c - 3] = derivative_step;
      else
        dl[c - 6] = derivative_step;
      const Displacement back{-step.translation_m, -step.rotation_rad};
      slope.col(c) = (residual(gaps, touching, handle, coupling, slide, moved(at.pose, step), at.l + dl) -
                      residual(gaps, touching, handle, coupling, slide, moved(at.pose, back), at.l - dl)) /
                     (2.0 * derivative_step);
    }
    const Eigen::VectorXd d = LeastSquares(slope).solve(-r);
    at.pose = moved(at.pose, {d.head<3>(), d.segment<3>(3)});
    at.l += d.tail(size - 6);
  }
  return residual(gaps, touching, handle, coupling, slide, at.pose, at.l).norm() < largest_residual;
}

Equilibrium solved(const std::vector<GapOfPose>& gaps, const Pose& handle, const Coupling& coupling,
                   const Slide& slide) {
  constexpr std::size_t most_touching = 4;
  Equilibrium best;
  double least = std::numeric_limits<double>::infinity();
  bool ambiguous = false;
  std::vector<std::size_t> touching;
  const auto try_set = [&] {
    Candidate at{handle, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(touching.size()))};
    if (!newton(gaps, touching, handle, coupling, slide, at) || (at.l.array() < -slack).any()) return;
    for (const GapOfPose& gap : gaps) {
      if (!(gap(at.pose).gap_m >= -slack)) return;
    }
    const double energy = coupling_energy_J(coupling, handle, at.pose);
    if (slide.mu > 0.0 && best.found) {
      constexpr double same = 1e-9;  // m and rad
      const Displacement apart = displacement(best.proxy, at.pose);
      ambiguous = ambiguous || !(apart.translation_m.norm() + apart.rotation_rad.norm() < same);
    }
    if (!(energy < least)) return;
    least = energy;
    best.found = true;
    best.proxy = at.pose;
    best.wrench_W = coupling_wrench(coupling, handle, at.pose);
    best.contact_forces_N.assign(gaps.size(), 0.0);
    for (std::size_t k = 0; k < touching.size(); ++k)
      best.contact_forces_N[touching[k]] = at.l[static_cast<Eigen::Index>(k)];
    best.residual_N = residual(gaps, touching, handle, coupling, slide, at.pose, at.l).norm();
  };
  const std::function<void(std::size_t)> extend = [&](std::size_t from) {
    try_set();
    if (touching.size() == most_touching) return;
    for (std::size_t j = from; j < gaps.size(); ++j) {
      touching.push_back(j);
      extend(j + 1);
      touching.pop_back();
    }
  };
  extend(0);
  best.found = best.found && !ambiguous;
  return best;
}

}  // namespace

Equilibrium quasi_static_equilibrium(const std::vector<GapOfPose>& gaps, const Pose& handle, const Coupling& coupling) {
  return solved(gaps, handle, coupling, {});
}

Equilibrium sliding_equilibrium(const std::vector<GapOfPose>& gaps, const Pose& handle, const Coupling& coupling,
                                double mu, const Vec3& velocity_W) {
  return solved(gaps, handle, coupling, {mu, velocity_W});
}

GapOfPose ball_on_plane(const Vec3& center_T_m, double radius_m, const Vec3& n_W, double d_m) {
  return [=](const Pose& pose) {
    const Vec3 center = pose.to_W(center_T_m);
    return Gap{n_W.dot(center) - radius_m - d_m, n_W, center - radius_m * n_W};
  };
}

GapOfPose ball_on_ball(const Vec3& center_T_m, double radius_m, const Vec3& center_W_m, double object_radius_m) {
  return [=](const Pose& pose) {
    const Vec3 center = pose.to_W(center_T_m);
    const Vec3 n = (center - center_W_m).normalized();
    return Gap{(center - center_W_m).norm() - radius_m - object_radius_m, n, center - radius_m * n};
  };
}

GapOfPose ellipsoid_on_plane(const Vec3& center_T_m, const Vec3& semi_axes_m, const Vec3& n_W, double d_m) {
  // The support function of an ellipsoid in direction -u is sqrt(sum (a_i u_i)^2), attained at -a_i^2 u_i / it.
  return [=](const Pose& pose) {
    const Vec3 u = pose.q_WT.conjugate() * n_W;
    const Vec3 au = semi_axes_m.cwiseProduct(u);
    const double support = au.norm();
    const Vec3 lowest = pose.to_W(center_T_m - semi_axes_m.cwiseProduct(au) / support);
    return Gap{n_W.dot(lowest) - d_m, n_W, lowest};
  };
}

GapOfPose ellipsoid_on_ball(const Vec3& center_T_m, const Vec3& semi_axes_m, const Vec3& center_W_m,
                            double object_radius_m) {
  // The point of the ellipsoid nearest to y (outside): x_i = a_i^2 y_i / (t + a_i^2) with t > 0 the root of
  // sum (a_i y_i / (t + a_i^2))^2 = 1 (Eberly, Distance from a Point to an Ellipsoid).
  return [=](const Pose& pose) {
    const Vec3 y = pose.to_T(center_W_m) - center_T_m;
    const Vec3 squares = semi_axes_m.cwiseProduct(semi_axes_m);
    const auto excess = [&](double t) {
      return semi_axes_m.cwiseProduct(y).cwiseQuotient(Vec3(squares.array() + t)).squaredNorm() - 1.0;
    };
    double low = 0.0;
    double high = semi_axes_m.maxCoeff() * y.norm();
    for (int i = 0; i < 200 && low < high; ++i) {  // to the last bit
      const double middle = 0.5 * (low + high);
      if (middle == low || middle == high) break;
      (excess(middle) > 0.0 ? low : high) = middle;
    }
    const Vec3 x = squares.cwiseProduct(y).cwiseQuotient(Vec3(squares.array() + high));
    const Vec3 n = pose.q_WT * Vec3((x - y).normalized());
    return Gap{(x - y).norm() - object_radius_m, n, pose.to_W(center_T_m + x)};
  };
}

GapOfPose disc_on_plane(const Vec3& center_T_m, const Vec3& axis_T, double radius_m, const Vec3& n_W, double d_m) {
  return [=](const Pose& pose) {
    const Vec3 axis = pose.q_WT * axis_T;
    const Vec3 across = n_W - n_W.dot(axis) * axis;
    const Vec3 lowest = pose.to_W(center_T_m) - radius_m * across.normalized();
    return Gap{n_W.dot(lowest) - d_m, n_W, lowest};
  };
}

std::array<GapOfPose, 4> square_peg_in_hole(double half_width_m, double end_T_m, double hole_half_width_m) {
  const auto end_on_wall = [=](double side) {
    return [=](const Pose& pose) {
      const Vec3 edge = pose.to_W(Vec3(side * half_width_m, 0.0, end_T_m));
      return Gap{hole_half_width_m - side * edge.x(), Vec3(-side, 0.0, 0.0), edge};
    };
  };
  const auto rim_on_side = [=](double side) {
    return [=](const Pose& pose) {
      const Vec3 rim(side * hole_half_width_m, 0.0, 0.0);
      const Vec3 n = pose.q_WT * Vec3(-side, 0.0, 0.0);
      return Gap{side * pose.to_T(rim).x() - half_width_m, n, rim};
    };
  };
  return {end_on_wall(1.0), end_on_wall(-1.0), rim_on_side(1.0), rim_on_side(-1.0)};
}

}  // namespace touchstone::contacts
