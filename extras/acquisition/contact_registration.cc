#include "contact_registration.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/stats/quantile.h"

namespace touchstone::acquisition {
using surface::Surface;

namespace {

double rms(const std::vector<double>& v) {
  double sum = 0.0;
  for (const double x : v) sum += x * x;
  return v.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(v.size()));
}

double robust_sigma(std::vector<double> v) {
  for (double& x : v) x = std::abs(x);
  return stats::normal_sigma_per_median * stats::upper_median(std::move(v));
}

std::vector<double> distances(const Surface& surface, const std::vector<Vec3>& centers, const RigidTransform& move,
                              double radius) {
  std::vector<double> result;
  result.reserve(centers.size());
  for (const Vec3& p : centers) result.push_back(surface.closest(move.point(p)).signed_distance_m - radius);
  return result;
}

}  // namespace

BallContact ball_contact(const Surface& surface, const Vec3& center_W_m, double tip_radius_m) {
  const surface::SurfacePoint closest = surface.closest(center_W_m);
  return {closest.p_W_m, closest.n_W, closest.signed_distance_m - tip_radius_m};
}

ContactRegistration register_contacts(const Surface& surface, const std::vector<Vec3>& centers_W_m, double tip_radius_m,
                                      const ContactRegistrationOptions& options, const std::string& source) {
  if (centers_W_m.size() < 6)
    throw BadData(
        fmt::format("{}: {} contacts; at least 6 are needed to refine a registration: touch more places, lower "
                    "/registration/contact_force_N, or leave /registration/mesh out",
                    source, centers_W_m.size()));
  Vec3 centroid = Vec3::Zero();
  for (const Vec3& p : centers_W_m) {
    if (!p.allFinite())
      throw BadData(fmt::format(
          "{}: a contact's position is not a finite number; take that sample out of the motion's file", source));
    centroid += p / static_cast<double>(centers_W_m.size());
  }
  // Turns are measured in arc length at the contacts' spread, so that all six directions compare.
  double spread = 0.0;
  for (const Vec3& p : centers_W_m) spread += (p - centroid).squaredNorm() / static_cast<double>(centers_W_m.size());
  spread = std::sqrt(spread);
  if (!(spread > 0.0))
    throw BadData(
        fmt::format("{}: all {} contacts lie in one point, which says nothing of the object's attitude; touch it in "
                    "places far apart",
                    source, centers_W_m.size()));

  ContactRegistration result;
  result.residual_before_m = distances(surface, centers_W_m, result.correction, tip_radius_m);
  result.rms_before_m = rms(result.residual_before_m);
  RigidTransform best = result.correction;
  double damping = 0.0;
  // Huber's loss (1964): squares up to the limit, beyond it straight lines with the same slope, so that a contact of
  // something else pulls no harder than one at the limit.
  const auto robust_cost = [&](const std::vector<double>& r, double limit) {
    double sum = 0.0;
    for (const double x : r) sum += std::abs(x) <= limit ? 0.5 * x * x : limit * (std::abs(x) - 0.5 * limit);
    return sum;
  };
  std::vector<double> now = result.residual_before_m;
  for (result.iterations = 0; result.iterations < options.most_iterations; ++result.iterations) {
    const double limit = std::max(options.huber_sigmas * robust_sigma(now), 1e-12 * spread);
    // Gauss and Newton's step for distances d_i(move) = 0, each weighted as the loss' slope over the distance (iterated
    // reweighting): sum w row row' step = -sum w row d.
    Matrix6 normal = Matrix6::Zero();
    Vector6 gradient = Vector6::Zero();
    const Vec3 about = best.point(centroid);
    for (std::size_t i = 0; i < centers_W_m.size(); ++i) {
      const Vec3 p = best.point(centers_W_m[i]);
      const surface::SurfacePoint closest = surface.closest(p);
      // The distance's gradient: along the line to the closest point; at the surface itself, its normal.
      const Vec3 away = p - closest.p_W_m;
      const Vec3 n = closest.distance_m > 1e-9 * spread
                         ? Vec3(away / (closest.signed_distance_m < 0 ? -away.norm() : away.norm()))
                         : closest.n_W;
      // A shift s changes the distance by n . s, a turn w about `about` by n . (w x (p - about)) = w . ((p - about) x
      // n).
      Vector6 row;
      row << n, (p - about).cross(n) / spread;
      const double weight = std::abs(now[i]) <= limit ? 1.0 : limit / std::abs(now[i]);
      normal += weight * row * row.transpose();
      gradient += weight * row * now[i];
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen{Eigen::MatrixXd(normal)};
    // A direction in which the object can slide without a distance changing (a plane has three, a sphere too) has an
    // eigenvalue of nought: no step goes there. Levenberg's damping shortens the others after a step that failed.
    const double strongest = eigen.eigenvalues()[5];
    Vector6 step = Vector6::Zero();
    result.determined_directions = 0;
    for (int k = 0; k < 6; ++k) {
      const double value = eigen.eigenvalues()[k];
      if (!(value > options.weakest_direction * strongest)) continue;
      ++result.determined_directions;
      step -= eigen.eigenvectors().col(k) * (eigen.eigenvectors().col(k).dot(gradient) / (value + damping * strongest));
    }
    const Vec3 turn = step.tail<3>() / spread;
    const double angle = turn.norm();
    const Quat dq = angle > 0.0 ? Quat(Eigen::AngleAxisd(angle, turn / angle)) : Quat::Identity();
    RigidTransform move{dq, about - dq * about + step.head<3>()};
    const RigidTransform candidate = move * best;
    const auto then = distances(surface, centers_W_m, candidate, tip_radius_m);
    if (robust_cost(then, limit) <= robust_cost(now, limit)) {
      best = candidate;
      now = then;
      damping *= 0.1;
      if (step.norm() < 1e-10 * spread) {
        result.converged = true;
        break;
      }
    } else {
      damping = std::max(1e-3, 10.0 * damping);
      if (damping > 1e6 || step.norm() < 1e-10 * spread) {
        result.converged = true;  // no smaller step helps: the minimum up to rounding and the mesh's facets
        break;
      }
    }
  }
  result.correction = best;
  result.residual_after_m = now;
  result.rms_after_m = rms(now);
  for (const Vec3& p : centers_W_m) result.contact_W_m.push_back(surface.closest(best.point(p)).p_W_m);
  return result;
}

}  // namespace touchstone::acquisition
