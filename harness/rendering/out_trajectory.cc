#include "harness/rendering/out_trajectory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "harness/base/error.h"

namespace touchstone::rendering {
using surface::SurfacePoint;

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

// The half-space n . x >= offset that keeps the ball clear of one contact.
struct HalfSpace {
  Vec3 n;
  double offset = 0.0;
  [[nodiscard]] double clearance(const Vec3& x) const { return n.dot(x) - offset; }
};

// Outward direction from the surface point to the centre: along the centre's offset where that is longer than rounding,
// else the surface's normal.
Vec3 outward(const SurfacePoint& at, const Vec3& center, double rounding, bool ball) {
  const Vec3 away = center - at.p_W_m;
  // On a face and on an analytic shape both are the same direction, and the normal has less rounding.
  const bool crease = at.feature == surface::Feature::edge || at.feature == surface::Feature::vertex;
  if (!ball || !crease || at.distance_m <= rounding) return at.n_W;
  return (at.signed_distance_m < 0.0 ? -away : away) / at.distance_m;
}

// The closest point to p in the intersection of up to a few half-spaces: every subset of at most three planes is tried
// (the optimum lies on the intersection of those that hold it), the closest feasible answer taken.
struct Projection {
  Vec3 x;
  Vec3 normal_sum;
  bool found = false;
};

void try_subset(const Vec3& p, std::span<const HalfSpace> all, std::span<const std::size_t> chosen, double tolerance,
                Projection& best) {
  const auto n = static_cast<Eigen::Index>(chosen.size());
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> normals(3, n);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> lack(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const HalfSpace& half = all[chosen[static_cast<std::size_t>(i)]];
    normals.col(i) = half.n;
    lack[i] = -half.clearance(p);
  }
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> gram = normals.transpose() * normals;
  // Nearly parallel planes say the same thing twice.
  const Eigen::LDLT<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>> solver(gram);
  if (solver.info() != Eigen::Success || solver.vectorD().minCoeff() < 1e-12) return;
  const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> push = solver.solve(lack);
  if (push.minCoeff() < 0.0) return;
  const Vec3 x = p + normals * push;
  for (const HalfSpace& half : all) {
    if (half.clearance(x) < -tolerance) return;
  }
  if (!best.found || (x - p).squaredNorm() < (best.x - p).squaredNorm()) {
    best = {x, normals.rowwise().sum(), true};
  }
}

Projection project(const Vec3& p, std::span<const HalfSpace> all, double tolerance) {
  Projection best;
  for (std::size_t i = 0; i < all.size(); ++i) {
    try_subset(p, all, std::array{i}, tolerance, best);
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      try_subset(p, all, std::array{i, j}, tolerance, best);
      for (std::size_t k = j + 1; k < all.size(); ++k) try_subset(p, all, std::array{i, j, k}, tolerance, best);
    }
  }
  return best;
}

}  // namespace

OutTrajectoryMaker::OutTrajectoryMaker(const surface::Surface& surface, const OutTrajectoryRule& rule)
    : surface_(surface), rule_(rule) {
  if (!(rule.tip_radius_m >= 0.0 && std::isfinite(rule.tip_radius_m))) {
    throw UsageError(fmt::format("a tip radius of {} m makes no sense; expected 0 or more", rule.tip_radius_m));
  }
  if (!(rule.contact_threshold_N >= 0.0 && std::isfinite(rule.contact_threshold_N))) {
    throw UsageError(
        fmt::format("a contact threshold of {} N makes no sense; expected 0 or more", rule.contact_threshold_N));
  }
  const Box3 box = surface.bounds();
  step_m_ = epsilon * (std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff()) + rule.tip_radius_m);
}

OutSample OutTrajectoryMaker::operator()(const Vec3& p_W_m, const Vec3& f_W_N) const {
  if (!p_W_m.allFinite() || !f_W_N.allFinite()) throw BadData("a position or force is not finite");
  const double r = rule_.tip_radius_m;
  const double rounding = 8.0 * (step_m_ + epsilon * p_W_m.cwiseAbs().maxCoeff());
  const SurfacePoint measured = surface_.closest(p_W_m);
  OutSample out{p_W_m, outward(measured, p_W_m, rounding, r > 0.0), 0.0, 0.0, 0.0, false, true};
  out.contact = f_W_N.dot(out.n_W) > rule_.contact_threshold_N;
  if (!out.contact && measured.signed_distance_m >= r) {
    out.gap_m = measured.signed_distance_m - r;
    return out;
  }
  // Rule 2. Half-spaces are added as the ball, moved clear of the known ones, is found to touch elsewhere.
  constexpr std::size_t most_contacts = 6;
  std::array<HalfSpace, most_contacts> contacts;
  contacts[0] = {out.n_W, out.n_W.dot(measured.p_W_m) + r};
  std::size_t count = 1;
  Vec3 x = measured.p_W_m + r * out.n_W;
  SurfacePoint at = surface_.closest(x);
  Vec3 normal = out.n_W;
  while (at.signed_distance_m < r - rounding) {
    if (count == most_contacts) break;
    const Vec3 n = outward(at, x, rounding, r > 0.0);
    contacts[count++] = {n, n.dot(at.p_W_m) + r};
    const Projection projection = project(p_W_m, std::span(contacts).first(count), rounding);
    if (!projection.found) break;
    x = projection.x;
    normal = projection.normal_sum.normalized();
    at = surface_.closest(x);
  }
  // Rule 6: doubling steps, a few at most.
  double step = step_m_ + epsilon * x.cwiseAbs().maxCoeff();
  for (int i = 0; i < 8 && at.signed_distance_m < r; ++i, step *= 2.0) {
    x += step * normal;
    at = surface_.closest(x);
  }
  out.p_W_m = x;
  out.n_W = normal;
  out.clear = at.signed_distance_m >= r;
  out.normal_force_N = out.contact ? std::max(0.0, f_W_N.dot(normal)) : 0.0;
  out.moved_m = (x - p_W_m).norm();
  return out;
}

void OutTrajectorySummary::add(const OutSample& sample) {
  ++samples;
  in_contact += sample.contact ? 1 : 0;
  not_clear += sample.clear ? 0 : 1;
  free_but_inside += !sample.contact && sample.moved_m > 0.0 ? 1 : 0;
  double& largest = sample.contact ? largest_move_in_contact_m : largest_move_free_m;
  largest = std::max(largest, sample.moved_m);
}

recording::OutTrajectory make_out_trajectory(const recording::Recording& recording, const surface::Surface& surface,
                                             const OutTrajectoryRule& rule, OutTrajectorySummary* summary) {
  const OutTrajectoryMaker make(surface, rule);
  if (recording.f_W_N.size() != recording.size()) {
    throw BadData(fmt::format("{}: an out-trajectory needs a force for every position; {} of {} have one",
                              recording.source, recording.f_W_N.size(), recording.size()));
  }
  recording::OutTrajectory out;
  out.motion = recording.motion;
  out.n_W.reserve(recording.size());
  out.gap_m.reserve(recording.size());
  out.normal_force_N.reserve(recording.size());
  for (std::size_t i = 0; i < recording.size(); ++i) {
    OutSample sample;
    try {
      sample = make(recording.motion.p_W_m[i], recording.f_W_N[i]);
    } catch (const BadData& error) {
      throw BadData(
          fmt::format("{}: sample {} (t = {} s): {}", recording.source, i, recording.motion.t_s[i], error.what()));
    }
    out.motion.p_W_m[i] = sample.p_W_m;
    out.n_W.push_back(sample.n_W);
    out.gap_m.push_back(sample.gap_m);
    out.normal_force_N.push_back(sample.normal_force_N);
    if (summary != nullptr) summary->add(sample);
  }
  return out;
}

}  // namespace touchstone::rendering
