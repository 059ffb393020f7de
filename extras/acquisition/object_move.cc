#include "object_move.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "contact_registration.h"
#include "harness/base/least_squares.h"

namespace touchstone::acquisition {
namespace {

constexpr double likely_move_sigmas = 2.5;   // of the directions that count to the size of a move that is clear
constexpr double least_noise_m = 1e-6;       // facets of a mesh
constexpr std::size_t fewest_contacts = 26;  // twice the parameters
constexpr int parts = 8;                     // of the contacts: the object may have moved between any two

// The contacts, few enough that their covariance can be factored: neighbours in time are averaged.
struct AveragedContacts {
  Eigen::MatrixXd rows;  // move (6), load, gap
  std::vector<Vec3> place_m;
  double each = 1.0;  // contacts in a row
};
AveragedContacts average(const GapRows& rows, const ContactSamples& contacts) {
  constexpr std::size_t most = 600;
  const std::size_t n = contacts.t_s.size(), each = (n + most - 1) / most, count = n / each;
  AveragedContacts averaged;
  averaged.rows = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(count), 8);
  averaged.place_m.assign(count, Vec3::Zero());
  averaged.each = static_cast<double>(each);
  for (std::size_t i = 0; i < count * each; ++i) {
    const auto from = static_cast<Eigen::Index>(i), to = static_cast<Eigen::Index>(i / each);
    averaged.rows.row(to).head<6>() += rows.move.row(from) / averaged.each;
    averaged.rows(to, 6) += rows.load(from, 0) / averaged.each;
    averaged.rows(to, 7) += rows.gap[from] / averaged.each;
    averaged.place_m[i / each] += contacts.center_W_m[i] / averaged.each;
  }
  return averaged;
}

// Of the gaps: the scan's error along the surface, and noise.
Eigen::LLT<Eigen::MatrixXd> covariance_of(const AveragedContacts& contacts, double length_m, double noise_m) {
  const auto n = static_cast<Eigen::Index>(contacts.place_m.size());
  Eigen::MatrixXd covariance(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const Vec3 apart = contacts.place_m[static_cast<std::size_t>(i)] - contacts.place_m[static_cast<std::size_t>(j)];
      covariance(i, j) = scan_error_m * scan_error_m * std::exp(-apart.norm() / length_m);
    }
    covariance(i, i) += noise_m * noise_m / contacts.each;
  }
  return Eigen::LLT<Eigen::MatrixXd>(covariance);
}

// X' V^-1 X of the columns: place before (6), move after (6), load, gap.
constexpr int move_columns = 14;
using MoveNormal = Eigen::Matrix<double, move_columns, move_columns>;
MoveNormal normal_equations(const AveragedContacts& contacts, const Eigen::LLT<Eigen::MatrixXd>& covariance,
                            Eigen::Index first_late) {
  Eigen::MatrixXd x(contacts.rows.rows(), move_columns);
  x << -contacts.rows.leftCols<6>(), -contacts.rows.leftCols<6>(), contacts.rows.rightCols<2>();
  x.block(0, 6, first_late, 6).setZero();
  covariance.matrixL().solveInPlace(x);
  return x.transpose() * x;
}

// What the normal equations tell of the move, along orthogonal directions of coordinates in which the length of a move
// is its root mean square at the touched places; `to_size` turns a move into these.
struct MoveDirections {
  Vector6 estimate_m, sigma_m;
  Mat3 shift_covariance_m2;  // of the contacts' middle

  [[nodiscard]] double sigmas(int k) const { return std::abs(estimate_m[k]) / sigma_m[k]; }
  [[nodiscard]] double most_sigmas() const { return (estimate_m.array().abs() / sigma_m.array()).maxCoeff(); }
  [[nodiscard]] double gain() const { return (estimate_m.array() / sigma_m.array()).square().sum(); }  // chi-squared
  // Of the directions that are clear enough, and with two standard errors of the others.
  [[nodiscard]] std::array<double, 2> likely_and_possible_size_m() const {
    double likely2 = 0.0, open2 = 0.0;
    for (int k = 0; k < 6; ++k)
      (sigmas(k) > likely_move_sigmas ? likely2 : open2) +=
          sigmas(k) > likely_move_sigmas ? estimate_m[k] * estimate_m[k] : 4.0 * sigma_m[k] * sigma_m[k];
    return {std::sqrt(likely2), std::sqrt(likely2 + open2)};
  }
};
MoveDirections directions_of(const MoveNormal& normal, const Matrix6& marker, const Vector6& from_markers,
                             const Matrix6& to_size) {
  // Place and load are eliminated.
  constexpr std::array<int, 7> others{0, 1, 2, 3, 4, 5, 12};
  constexpr Eigen::Index right = move_columns - 1;
  Eigen::MatrixXd inner = normal(others, others);
  Eigen::VectorXd inner_right = normal(others, right);
  inner.topLeftCorner<6, 6>() += marker;
  inner_right.head<6>() += marker * from_markers;
  const Eigen::MatrixXd mixed = normal.block<6, move_columns>(6, 0)(Eigen::all, others);
  Matrix6 own = normal.block<6, 6>(6, 6);
  for (Eigen::Index k = 0; k < 6; ++k) own.col(k) -= mixed * solve_symmetric(inner, mixed.row(k).transpose());
  const Vector6 score = normal.block<6, 1>(6, right) - mixed * solve_symmetric(inner, inner_right);
  const Matrix6 information = to_size * own * to_size.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen{
      Eigen::MatrixXd(0.5 * (information + information.transpose()))};
  const Vector6 along = eigen.eigenvectors().transpose() * to_size * score;
  MoveDirections result;
  for (int k = 0; k < 6; ++k) {
    const double known = std::max(eigen.eigenvalues()[k], 1e-12 * eigen.eigenvalues()[5]);
    result.estimate_m[k] = along[k] / known;
    result.sigma_m[k] = 1.0 / std::sqrt(known);
  }
  const Matrix6 unscaled = to_size.transpose() * eigen.eigenvectors() * result.sigma_m.asDiagonal();
  result.shift_covariance_m2 = unscaled.topRows<3>() * unscaled.topRows<3>().transpose();
  return result;
}

// What no move at this contact explains: the root mean square, and the noise of one contact, by half seconds where
// their errors are correlated.
struct LeftByMove {
  double rms_m, noise_m;
};
LeftByMove left_by_move(const GapRows& rows, const ContactSamples& contacts, std::size_t first_late) {
  Eigen::MatrixXd all(rows.gap.size(), 13);
  all << rows.move, rows.move, rows.load;
  all.block(0, 6, static_cast<Eigen::Index>(first_late), 6).setZero();
  const Eigen::VectorXd left = rows.gap - all * LeastSquares(all).solve(rows.gap);
  const auto n = static_cast<double>(rows.gap.size());
  double sums2 = 0.0;
  for (std::size_t i = 0, j = 0; i < contacts.t_s.size(); i = j) {
    double sum = 0.0;
    for (; j < contacts.t_s.size() && contacts.t_s[j] < contacts.t_s[i] + independent_s; ++j)
      sum += left[static_cast<Eigen::Index>(j)];
    sums2 += sum * sum;
  }
  return {std::sqrt(left.squaredNorm() / n), std::sqrt(std::max(left.squaredNorm(), sums2) / n)};
}

}  // namespace

Mat3 cross_matrix(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

GapRows gap_rows(const surface::Surface& surface, const ContactSamples& c, double tip_radius_m) {
  const auto n = static_cast<Eigen::Index>(c.t_s.size());
  GapRows rows;
  rows.gap.resize(n), rows.move.resize(n, 6), rows.tip.resize(n, 3), rows.load.resize(n, 1);
  for (const Vec3& p : c.center_W_m) rows.middle_m += p / static_cast<double>(n);
  for (const Vec3& p : c.center_W_m) rows.spread_m = std::max(rows.spread_m, (p - rows.middle_m).norm());
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const BallContact contact = ball_contact(surface, c.center_W_m[k], tip_radius_m);
    rows.gap[i] = contact.gap_m;
    rows.normal.push_back(contact.n_W);
    rows.move.row(i) << contact.n_W.transpose(),
        (c.center_W_m[k] - rows.middle_m).cross(contact.n_W).transpose() / rows.spread_m;
    rows.tip.row(i) = (c.q_WP[k].conjugate() * contact.n_W).transpose();
    rows.load(i, 0) = -std::max(0.0, contact.n_W.dot(c.force_W_N[k]));
  }
  return rows;
}

Vector6 move_of(const GapRows& rows, const RigidTransform& correction) {
  const Eigen::AngleAxisd turn(correction.q);
  const Vec3 begin = correction.q.conjugate() * (rows.middle_m - correction.t_m);
  Vector6 move;
  move << rows.middle_m - begin, rows.spread_m * turn.angle() * turn.axis();
  return move;
}

Matrix6 marker_information(const GapRows& rows, const MarkerRegistration& markers, double mesh_error_m) {
  // FLE^2 = FRE^2 / (1 - 2 / n) over three components (rigid_registration.cc).
  const auto count = static_cast<double>(markers.markers);
  const double variance =
      markers.residual_rms_m * markers.residual_rms_m / (1.0 - 2.0 / count) / 3.0 + mesh_error_m * mesh_error_m;
  Eigen::Matrix<double, 3, 6> centroid;
  centroid << Mat3::Identity(), -cross_matrix(markers.centroid_m - rows.middle_m) / rows.spread_m;
  Matrix6 marker = centroid.transpose() * centroid;
  for (int k = 0; k < 3; ++k) {
    Vector6 about = Vector6::Zero();
    about.tail<3>() = markers.spread_m[k] / rows.spread_m * markers.axes.col(k);
    marker += about * about.transpose();
  }
  return count / variance * marker;
}

double independent_contacts(const ContactSamples& contacts) {
  double count = 0.0, until = -std::numeric_limits<double>::infinity();
  for (const double t : contacts.t_s) {
    if (t > until) count += 1.0, until = t + independent_s;
  }
  return count;
}

ObjectMove object_move(const surface::Surface& surface, const ContactSamples& contacts, double tip_radius_m,
                       double tracker_noise_m, const RigidTransform& correction, const MarkerRegistration& markers) {
  ObjectMove result;
  const std::size_t n = contacts.t_s.size();
  if (n < fewest_contacts) return result;
  const GapRows rows = gap_rows(surface, contacts, tip_radius_m);
  Matrix6 square = Matrix6::Zero();
  for (const Vec3& p : contacts.center_W_m) {
    Eigen::Matrix<double, 3, 6> at;
    at << Mat3::Identity(), -cross_matrix(p - rows.middle_m) / rows.spread_m;
    square += at.transpose() * at / static_cast<double>(n);
  }
  square += 1e-9 * Matrix6::Identity();  // contacts in one line
  const Matrix6 to_size =
      Eigen::LLT<Eigen::MatrixXd>(Eigen::MatrixXd(square)).matrixL().solve(Eigen::MatrixXd::Identity(6, 6));
  Matrix6 marker = Matrix6::Zero();
  if (markers.markers > 3) marker = marker_information(rows, markers, scan_error_m);
  const Vector6 from_markers = -move_of(rows, correction);

  const AveragedContacts averaged = average(rows, contacts);
  std::array<LeftByMove, parts> left{};
  double noise_m = std::numeric_limits<double>::infinity();
  for (std::size_t part = 1; part < parts; ++part) {
    left[part] = left_by_move(rows, contacts, n * part / parts);
    noise_m = std::min(noise_m, left[part].noise_m);
  }
  noise_m = std::max({noise_m, tracker_noise_m, least_noise_m});
  std::array<Eigen::LLT<Eigen::MatrixXd>, 3> covariances;
  for (std::size_t k = 0; k < covariances.size(); ++k)
    covariances[k] = covariance_of(averaged, rows.spread_m / std::exp2(k + 1), noise_m);
  double best_gain = 0.0, most_sigmas = 0.0, unknown_half_way_m = 0.0;
  Mat3 shift_covariance_m2 = Mat3::Zero();
  for (std::size_t part = 1; part < parts; ++part) {
    ObjectMove here;
    here.at_s = contacts.t_s[n * part / parts];
    here.left_rms_m = left[part].rms_m;
    double gain = std::numeric_limits<double>::infinity();
    here.size_m = here.sigmas = gain, here.possible_m = 0.0;
    for (const auto& covariance : covariances) {
      const Eigen::Index first_late = averaged.rows.rows() * static_cast<Eigen::Index>(part) / parts;
      const MoveDirections d =
          directions_of(normal_equations(averaged, covariance, first_late), marker, from_markers, to_size);
      const auto [likely_m, possible_m] = d.likely_and_possible_size_m();
      here.size_m = std::min(here.size_m, likely_m);
      here.possible_m = std::max(here.possible_m, possible_m);
      here.sigmas = std::min(here.sigmas, d.most_sigmas());
      gain = std::min(gain, d.gain());
      if (part != parts / 2) continue;
      unknown_half_way_m = std::max(unknown_half_way_m, d.sigma_m.maxCoeff());
      if (d.shift_covariance_m2.trace() > shift_covariance_m2.trace()) shift_covariance_m2 = d.shift_covariance_m2;
    }
    most_sigmas = std::max(most_sigmas, here.sigmas);
    if (gain > best_gain) best_gain = gain, result = here;
  }
  result.sigmas = most_sigmas;
  result.unnoticed_m = ObjectMove::clear_sigmas * unknown_half_way_m;
  const Eigen::SelfAdjointEigenSolver<Mat3> shift(shift_covariance_m2);
  result.shift_axes = shift.eigenvectors();
  result.unnoticed_shift_m = ObjectMove::clear_sigmas * shift.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return result;
}

std::string ObjectMove::doubt() const {
  constexpr double matters_m = 2e-3, boundless_m = 0.1;
  constexpr std::string_view advice = ": measure the markers again at the end, and compare";
  if (!(unnoticed_m > matters_m)) return {};
  if (!unnoticed_shift_m || unnoticed_shift_m->minCoeff() > boundless_m)
    return fmt::format("the contacts do not show whether the object moved{}", advice);
  const auto size = [](double m) { return m < boundless_m ? fmt::format("{:.2g} mm", 1e3 * m) : "any distance"; };
  std::string text;
  for (int k = 0; k < 3; ++k) {
    // Either way: its largest component is written as positive.
    Vec3 axis = shift_axes.col(k);
    Eigen::Index largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    axis = (std::copysign(100.0, axis[largest]) * axis).array().round() / 100.0;
    text += fmt::format("{}by {} along ({:.2f}, {:.2f}, {:.2f})",
                        k == 0   ? ""
                        : k == 1 ? ", "
                                 : " and ",
                        size((*unnoticed_shift_m)[k]), axis.x() + 0.0, axis.y() + 0.0, axis.z() + 0.0);
  }
  if (unnoticed_shift_m->maxCoeff() <= matters_m)
    text += fmt::format(", and turned by {} at the touched places", size(unnoticed_m));
  return fmt::format("half-way, the object may have moved {} of the mesh's frame, which the contacts do not show{}",
                     text, advice);
}

}  // namespace touchstone::acquisition
