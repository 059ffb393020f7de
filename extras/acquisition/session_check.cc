#include "session_check.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "clustered_fit.h"
#include "force_gains.h"
#include "harness/base/least_squares.h"
#include "harness/stats/distributions.h"
#include "smoothing.h"

namespace touchstone::acquisition {
using surface::Surface;

namespace {

constexpr double air_block_s = 0.5;
constexpr double largest_turn_rad = 0.05;
constexpr double one_in_ten_thousand = 1e-4;
constexpr double clear_sigmas = 5.0;
constexpr double largest_lever_error_m = 2e-3;
constexpr double slowest_sliding_m_per_s = 5e-3;
constexpr double largest_move_m = 1e-3;

// The mean of half a second of free air: force left, and the tool's weight, in the sensor's frame.
struct Block {
  double t_s;
  Vec3 left_N, weight_N;
};

std::vector<Block> blocks_of(const SessionSamples& s, const ToolLoad& tool, const Vec3& gravity_T) {
  std::vector<Block> blocks;
  const double interval = sample_interval_s(s.t_s);
  // Speeds from places a few frames apart: 0.1 mm of noise over 50 ms are 3 mm/s, 6 mm/s^2 over a block.
  const auto reach = std::max<std::size_t>(1, static_cast<std::size_t>(0.025 / interval));
  for (std::size_t first = 0, last = 0; first < s.t_s.size(); first = last) {
    last = first + 1;
    if (!s.free_air[first]) continue;
    while (last < s.t_s.size() && s.free_air[last] && s.t_s[last] - s.t_s[last - 1] < 2.5 * interval &&
           s.t_s[last] < s.t_s[first] + air_block_s)
      ++last;
    const double length = s.t_s[last - 1] - s.t_s[first];
    if (length < 0.9 * air_block_s || last - first < 2 * reach + 2) continue;
    Vec3 left = Vec3::Zero(), weight = Vec3::Zero();
    for (std::size_t i = first; i < last; ++i) {
      left += s.q_TS[i].conjugate() * s.f_T_N[i] / static_cast<double>(last - first);
      weight += s.q_TS[i].conjugate() * (tool.mass_kg * gravity_T) / static_cast<double>(last - first);
    }
    const auto speed = [&](std::size_t from) -> Vec3 {
      return (s.tip_T_m[from + reach] - s.tip_T_m[from]) / (s.t_s[from + reach] - s.t_s[from]);
    };
    const Vec3 gained = speed(last - 1 - reach) - speed(first);
    left += tool.mass_kg / length * (s.q_TS[(first + last) / 2].conjugate() * gained);
    blocks.push_back({s.t_s[first] + 0.5 * length, left, weight});
  }
  return blocks;
}

// What is left of the blocks after a cause with these columns, and its estimate.
struct CauseFit {
  Eigen::VectorXd estimate;
  double left2 = 0.0;  // sum of squares
  Eigen::Index rank = 0;
};
CauseFit fit_cause(const Eigen::MatrixXd& columns, const Eigen::VectorXd& left) {
  const LeastSquares qr(columns);
  CauseFit fit;
  fit.estimate = qr.solve(left);
  fit.left2 = (left - columns * fit.estimate).squaredNorm();
  fit.rank = qr.rank();
  return fit;
}

// Whether `extra` more parameters explain more than chance, of `rows` rows.
bool explains(double without2, double with2, Eigen::Index extra, Eigen::Index free_rows) {
  if (free_rows < 1 || !(without2 > with2)) return false;
  const double f = (without2 - with2) / static_cast<double>(extra) / (with2 / static_cast<double>(free_rows));
  return !std::isfinite(f) ||
         stats::f_tail(f, static_cast<double>(extra), static_cast<double>(free_rows)) < one_in_ten_thousand;
}

}  // namespace

FreeAirCheck check_free_air(const SessionSamples& samples, const ToolLoad& tool, const Vec3& gravity_T,
                            double contact_force_N) {
  FreeAirCheck check;
  const auto blocks = blocks_of(samples, tool, gravity_T);
  check.blocks = blocks.size();
  if (blocks.size() < 2) {
    check.blocks = 0;
    return check;
  }
  const auto n = static_cast<Eigen::Index>(blocks.size());
  const double begin = samples.t_s.front(), span = samples.t_s.back() - begin;
  Eigen::MatrixXd bias = Eigen::MatrixXd::Zero(3 * n, 3), drift = Eigen::MatrixXd::Zero(3 * n, 6),
                  turn = Eigen::MatrixXd::Zero(3 * n, 3);
  Eigen::VectorXd left(3 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Block& b = blocks[static_cast<std::size_t>(i)];
    left.segment<3>(3 * i) = b.left_N;
    bias.block<3, 3>(3 * i, 0).setIdentity();
    drift.block<3, 3>(3 * i, 0).setIdentity();
    drift.block<3, 3>(3 * i, 3) = ((b.t_s - begin) / span - 0.5) * Mat3::Identity();
    turn.block<3, 3>(3 * i, 0) = -cross_matrix(b.weight_N);
  }
  const CauseFit constant = fit_cause(bias, left), moving = fit_cause(drift, left), turned = fit_cause(turn, left);
  check.bias_N = constant.estimate;
  if (moving.rank == 6) check.drift_N = moving.estimate.tail<3>();
  if (turned.rank == 3) check.turn_rad = turned.estimate;
  const double most_N = 0.25 * contact_force_N;
  // A turned frame is one cause for what would else be a bias that follows the attitude.
  if (check.turn_rad.norm() > largest_turn_rad && turned.left2 < constant.left2 && turned.left2 < moving.left2 &&
      explains(left.squaredNorm(), turned.left2, 3, 3 * n - 3)) {
    check.faults.push_back(fmt::format(
        "in free air the tool's weight is turned by {:.2g} rad against where it should point (limit {:.2g}): check "
        "/probe/q_PS, the attitude of the sensor on the probe, and /tool/gravity_T_m_per_s2",
        check.turn_rad.norm(), largest_turn_rad));
    return check;
  }
  const auto worst = std::ranges::max_element(blocks, {}, [](const Block& b) { return b.left_N.norm(); });
  if (check.drift_N.norm() > most_N && explains(constant.left2, moving.left2, 3, 3 * n - 6)) {
    check.faults.push_back(fmt::format(
        "the force's bias moved by {:.3g} N during the session (limit {:.3g} N, a quarter of the contact force); worst "
        "at {:.2f} s with {:.3g} N in free air: did something knock the tool, or is the sensor warming up? Record "
        "again",
        check.drift_N.norm(), most_N, worst->t_s, worst->left_N.norm()));
  } else if (check.bias_N.norm() > most_N && explains(left.squaredNorm(), constant.left2, 3, 3 * n - 3)) {
    check.faults.push_back(fmt::format(
        "in free air the force is off by {:.3g} N all along (limit {:.3g} N, a quarter of the contact force): give a "
        "stretch of free air as /force/bias_from_s and bias_to_s, or measure the tool's static poses again",
        check.bias_N.norm(), most_N));
  } else if (worst->left_N.norm() > 0.5 * contact_force_N) {
    check.event = fmt::format(
        "contact: in free air the force is off by {:.3g} N at {:.2f} s (limit {:.3g} N, half of the contact force): "
        "something touched or knocked the tool there; leave this time out",
        worst->left_N.norm(), worst->t_s, 0.5 * contact_force_N);
  }
  return check;
}

namespace {

double left_by(const Eigen::VectorXd& gap, const std::vector<const Eigen::MatrixXd*>& causes, Eigen::VectorXd& fit) {
  Eigen::Index columns = 0;
  for (const auto* cause : causes) columns += cause->cols();
  Eigen::MatrixXd all(gap.size(), columns);
  columns = 0;
  for (const auto* cause : causes) {
    all.middleCols(columns, cause->cols()) = *cause;
    columns += cause->cols();
  }
  const CauseFit found = fit_cause(all, gap);
  fit = found.estimate;
  return std::sqrt(found.left2 / static_cast<double>(gap.size()));
}

// Three parameters of these clusters from `first` on; those within five standard errors of nothing are nothing. Empty
// where all are, or the clusters do not tell.
std::optional<Vec3> clear_vector(const std::vector<NormalEquations>& clusters, Eigen::Index first) {
  if (clusters.size() < 8) return std::nullopt;
  const ClusteredFit fit(clusters);
  if (!fit.determined()) return std::nullopt;
  Vec3 clear = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    Eigen::VectorXd one = Eigen::VectorXd::Zero(fit.estimate().size());
    one[first + k] = 1.0;
    if (const double value = fit.estimate()[first + k]; std::abs(value) > clear_sigmas * fit.error_of(one).sigma)
      clear[k] = value;
  }
  return clear.isZero(0.0) ? std::nullopt : std::optional(clear);
}

// Of the last `own` parameters of these clusters the part that is clear, along the directions in which the rows tell
// them, all other parameters aside. Nothing where the clusters do not tell.
Eigen::VectorXd clear_part(const std::vector<NormalEquations>& clusters, Eigen::Index own) {
  Eigen::VectorXd clear = Eigen::VectorXd::Zero(own);
  if (clusters.size() < 8) return clear;
  const ClusteredFit fit(clusters);
  if (!fit.determined()) return clear;
  const Eigen::Index others = fit.estimate().size() - own;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(fit.estimate().size(), fit.estimate().size());
  for (const auto& cluster : clusters) all += cluster.normal;
  const Eigen::MatrixXd mixed = all.bottomLeftCorner(own, others);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> directions(Eigen::MatrixXd(
      all.bottomRightCorner(own, own) - mixed * all.topLeftCorner(others, others).ldlt().solve(mixed.transpose())));
  for (Eigen::Index k = 0; k < own; ++k) {
    Eigen::VectorXd contrast = Eigen::VectorXd::Zero(all.rows());
    contrast.tail(own) = directions.eigenvectors().col(k);
    const double value = contrast.dot(fit.estimate());
    if (std::abs(value) > clear_sigmas * fit.error_of(contrast).sigma) clear += value * contrast.tail(own);
  }
  return clear;
}

// The turn of the sensor's frame that sliding contact shows, by clusters of half a second.
std::optional<Vec3> turn_by_sliding(const ContactSamples& c, const std::vector<Vec3>& normals, double sliding_m_per_s) {
  std::vector<NormalEquations> clusters;
  double until = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < c.t_s.size(); ++i) {
    const Vec3& n = normals[i];
    const Vec3 along = c.velocity_W_m_per_s[i] - n * n.dot(c.velocity_W_m_per_s[i]);
    const double load = n.dot(c.force_W_N[i]);
    if (!(along.norm() > sliding_m_per_s) || !(load > 0.0)) continue;
    if (c.t_s[i] > until) {
      clusters.push_back({Eigen::MatrixXd::Zero(4, 4), Eigen::VectorXd::Zero(4)});
      until = c.t_s[i] + air_block_s;
    }
    const Vec3 tangential = c.force_W_N[i] - load * n;
    Eigen::MatrixXd rows(3, 4);
    rows.col(0) = -load * along.normalized();
    rows.rightCols<3>() = -load * cross_matrix(n) * c.q_WS[i].toRotationMatrix();
    clusters.back().normal += rows.transpose() * rows;
    clusters.back().right += rows.transpose() * tangential;
  }
  return clear_vector(clusters, 1);
}

// Accelerations over a tenth of a second, of velocities of one contact after the other; zero where there is a gap.
std::vector<Vec3> accelerations(const ContactSamples& c) {
  constexpr double over_s = 0.1;
  std::vector<Vec3> all(c.t_s.size(), Vec3::Zero());
  for (std::size_t i = 0, first = 0, last = 0; i < all.size(); ++i) {
    while (c.t_s[i] - c.t_s[first] > 0.5 * over_s) ++first;
    while (last + 1 < all.size() && c.t_s[last + 1] - c.t_s[i] <= 0.5 * over_s) ++last;
    const double span = c.t_s[last] - c.t_s[first];
    if (span > 0.5 * over_s) all[i] = (c.velocity_W_m_per_s[last] - c.velocity_W_m_per_s[first]) / span;
  }
  return all;
}

// A force along the surface that is neither friction nor inertia: constant, or drawn to a place as by a cable, root
// mean square [N], by its parts that are clear, by clusters of half a second. With `besides_scan` it does not count
// either what follows the load in the same way, as an error of the normal makes it.
double steady_pull_N(const ContactSamples& c, const std::vector<Vec3>& normals, double sliding_m_per_s,
                     bool besides_scan) {
  const auto n = static_cast<double>(c.t_s.size());
  Vec3 middle = Vec3::Zero();
  double spread2 = 0.0, used = 0.0;
  for (const Vec3& p : c.center_W_m) middle += p / n;
  for (const Vec3& p : c.center_W_m) spread2 += (p - middle).squaredNorm() / n;
  const auto acceleration = accelerations(c);
  // What does not show, as a constant along the normal of a level surface, is held at nothing.
  constexpr Eigen::Index pulls = 4;
  constexpr double held = 1e-6;
  const Eigen::Index others = besides_scan ? 2 + pulls : 2;
  std::vector<NormalEquations> clusters;
  Eigen::Matrix<double, pulls, pulls> square = Eigen::Matrix<double, pulls, pulls>::Zero();
  double until = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < c.t_s.size(); ++i) {
    const Mat3 along = Mat3::Identity() - normals[i] * normals[i].transpose();
    const Vec3 slip = along * c.velocity_W_m_per_s[i];
    const double load = normals[i].dot(c.force_W_N[i]);
    if (!(slip.norm() > sliding_m_per_s) || !(load > 0.0)) continue;
    if (c.t_s[i] > until) {
      clusters.push_back(
          {Eigen::MatrixXd::Zero(others + pulls, others + pulls), Eigen::VectorXd::Zero(others + pulls)});
      clusters.back().normal.diagonal().tail(others + pulls - 2).setConstant(held);
      until = c.t_s[i] + air_block_s;
    }
    Eigen::Matrix<double, 3, pulls> pull;
    pull << along * (c.center_W_m[i] - middle) / std::sqrt(spread2), along;
    Eigen::MatrixXd rows(3, others + pulls);
    rows.col(0) = -load * slip.normalized();
    rows.col(1) = -along * acceleration[i];
    if (besides_scan) rows.middleCols<pulls>(2) = load * pull;
    rows.rightCols<pulls>() = pull;
    clusters.back().normal += rows.transpose() * rows;
    clusters.back().right += rows.transpose() * (along * c.force_W_N[i]);
    square += pull.transpose() * pull;
    used += 1.0;
  }
  if (!(spread2 > 0.0) || !(used > 0.0)) return 0.0;
  const Eigen::VectorXd pull = clear_part(clusters, pulls);
  return std::sqrt(pull.dot(square * pull) / used);
}

// Gains of the sensor's axes and crosstalk between them that sliding contact shows: what they make of the push lies
// along the surface, and turns with the sensor. The root mean square error of the contact forces [N], by the parts that
// are clear; the gain that all axes share does not show, so that any axis may be the right one (force_gains.h).
double gain_error_by_sliding_N(const ContactSamples& c, const std::vector<Vec3>& normals, double sliding_m_per_s) {
  constexpr Eigen::Index others = 4, gains = 5;  // friction and a turn; symmetric, without a trace
  constexpr double held = 1e-6;
  const auto matrix_of = [](const Eigen::VectorXd& g) {
    Mat3 m;
    m << g[0], g[2], g[3], g[2], g[1], g[4], g[3], g[4], -g[0] - g[1];
    return m;
  };
  std::vector<NormalEquations> clusters;
  Mat3 moments = Mat3::Zero();
  double until = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < c.t_s.size(); ++i) {
    const Vec3 f_S = c.q_WS[i].conjugate() * c.force_W_N[i];
    moments += f_S * f_S.transpose() / static_cast<double>(c.t_s.size());
    const Mat3 along = Mat3::Identity() - normals[i] * normals[i].transpose();
    const Vec3 slip = along * c.velocity_W_m_per_s[i];
    const double load = normals[i].dot(c.force_W_N[i]);
    if (!(slip.norm() > sliding_m_per_s) || !(load > 0.0)) continue;
    if (c.t_s[i] > until) {
      clusters.push_back(
          {Eigen::MatrixXd::Zero(others + gains, others + gains), Eigen::VectorXd::Zero(others + gains)});
      clusters.back().normal.diagonal().tail<gains>().setConstant(held);
      until = c.t_s[i] + air_block_s;
    }
    const Mat3 r_WS = c.q_WS[i].toRotationMatrix();
    Eigen::MatrixXd rows(3, others + gains);
    rows.col(0) = -load * slip.normalized();
    rows.middleCols<3>(1) = -load * cross_matrix(normals[i]) * r_WS;
    for (Eigen::Index k = 0; k < gains; ++k)
      rows.col(others + k) =
          load * along * r_WS * matrix_of(Eigen::VectorXd::Unit(gains, k)) * r_WS.transpose() * normals[i];
    clusters.back().normal += rows.transpose() * rows;
    clusters.back().right += rows.transpose() * (along * c.force_W_N[i]);
  }
  const Mat3 off = matrix_of(clear_part(clusters, gains));
  double worst2 = 0.0;
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(off, Eigen::EigenvaluesOnly);
  for (const double right : solver.eigenvalues()) {
    const Mat3 error = off - right * Mat3::Identity();
    worst2 = std::max(worst2, (error * moments * error.transpose()).trace());
  }
  return std::sqrt(worst2);
}

// How far off the ball's centre the torque acts, in the sensor's frame, by clusters of half a second; empty without a
// torque. The tool's inertia acts at its centre of mass, d from the ball: its torque d x (-m a) is a column too.
std::optional<Vec3> lever_error(const ContactSamples& c, const std::vector<Vec3>& normals, double tip_radius_m) {
  if (std::ranges::all_of(c.torque_W_Nm, [](const Vec3& torque) { return torque.isZero(0.0); })) return std::nullopt;
  constexpr Eigen::Index unknowns = 9;  // of the lever, the torque's bias, and m d
  const auto acceleration = accelerations(c);
  std::vector<NormalEquations> clusters;
  double until = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < c.t_s.size(); ++i) {
    if (c.t_s[i] > until) {
      clusters.push_back({Eigen::MatrixXd::Zero(unknowns, unknowns), Eigen::VectorXd::Zero(unknowns)});
      until = c.t_s[i] + air_block_s;
    }
    const Vec3 left = c.torque_W_Nm[i] + tip_radius_m * normals[i].cross(c.force_W_N[i]);
    const Quat q_SW = c.q_WS[i].conjugate();
    Eigen::MatrixXd rows(3, unknowns);
    rows << cross_matrix(q_SW * c.force_W_N[i]), Mat3::Identity(), cross_matrix(q_SW * acceleration[i]);
    clusters.back().normal += rows.transpose() * rows;
    clusters.back().right += rows.transpose() * (q_SW * left);
  }
  return clear_vector(clusters, 0);
}

}  // namespace

double contact_compliance_m_per_N(const Surface& surface, const ContactSamples& contacts, double tip_radius_m) {
  constexpr double least_variation = 0.1;
  if (contacts.t_s.size() < 8) return 0.0;
  const GapRows rows = gap_rows(surface, contacts, tip_radius_m);
  const Eigen::VectorXd load = rows.load.col(0);
  const Eigen::VectorXd own = load - rows.move * LeastSquares(rows.move).solve(load);
  if (!(own.squaredNorm() > least_variation * least_variation * load.squaredNorm())) return 0.0;
  return std::max(0.0, own.dot(rows.gap) / own.squaredNorm());
}

RigidTransform weighed_correction(const Surface& surface, const ContactSamples& contacts, double tip_radius_m,
                                  const ContactRegistration& refinement, const MarkerRegistration& markers) {
  if (markers.markers < 4) return refinement.correction;
  const GapRows rows = gap_rows(surface, contacts, tip_radius_m);
  const Vector6 asked = move_of(rows, refinement.correction);
  const Vec3 begin = rows.middle_m - asked.head<3>();
  const auto n = static_cast<double>(rows.gap.size());
  const double left = refinement.rms_after_m, contact_variance = left * left + scan_error_m * scan_error_m;
  const Eigen::VectorXd load = rows.load.col(0), along = rows.move.transpose() * load;
  Matrix6 contact = rows.move.transpose() * rows.move;
  if (load.squaredNorm() > 0.0) contact -= along * along.transpose() / load.squaredNorm();
  contact *= independent_contacts(contacts) / n / contact_variance;
  if (!(markers.residual_rms_m > 0.0)) return {};  // exact markers
  const Matrix6 marker = marker_information(rows, markers, 0.0);
  const Vector6 move = solve_symmetric(contact + marker, contact * asked);
  const Vec3 angle = move.tail<3>() / rows.spread_m;
  const Quat q = angle.norm() > 0.0 ? Quat(Eigen::AngleAxisd(angle.norm(), angle.normalized())) : Quat::Identity();
  return {q, begin + move.head<3>() - q * begin};
}

ContactCheck check_contacts(const Surface& surface, const ContactSamples& contacts, double tip_radius_m,
                            double tracker_noise_m, double contact_force_N, const ContactRegistration& refinement,
                            const MarkerRegistration& markers, const ObjectMove& move) {
  ContactCheck check;
  auto& faults = check.faults;
  const GapRows rows = gap_rows(surface, contacts, tip_radius_m);
  const auto n = static_cast<double>(rows.gap.size());
  Eigen::VectorXd fit;
  const double plain = left_by(rows.gap, {&rows.move, &rows.load}, fit);
  const double with_tip = left_by(rows.gap, {&rows.move, &rows.load, &rows.tip}, fit);
  const double tip_off = fit.tail<3>().norm();
  const double most = 3.0 * std::hypot(tracker_noise_m, scan_error_m);
  const bool tip = plain * plain - with_tip * with_tip > scan_error_m * scan_error_m && plain > 2.0 * tracker_noise_m;
  const bool moved = move.clear() && move.possible_m > largest_move_m;
  if (tip && (!moved || with_tip <= move.left_rms_m)) {
    faults.push_back(fmt::format(
        "the contacts fit the mesh to {:.2g} mm RMS instead of {:.2g} mm if the tip lies {:.2g} mm elsewhere on the "
        "probe: measure /probe/tip_P_m again (pivot the tip in a dimple)",
        1e3 * with_tip, 1e3 * plain, 1e3 * tip_off));
  } else if (moved) {
    faults.push_back(fmt::format(
        "the earlier and the later contacts fit the mesh at two places {:.2g} mm apart ({:.2g} standard errors), or up "
        "to {:.2g} mm with what the contacts leave open (limit {:.2g} mm): the object moved against the tracker around "
        "{:.2f} s; fix it and record again",
        1e3 * move.size_m, move.sigmas, 1e3 * move.possible_m, 1e3 * largest_move_m, move.at_s));
  } else if (plain > most) {
    faults.push_back(fmt::format(
        "the contacts leave {:.2g} mm RMS off the mesh, more than tracker and scan explain ({:.2g} mm): is it the "
        "object's mesh in the right unit, and what was touched? If the object is soft or its shape unknown, leave out "
        "/registration/mesh",
        1e3 * plain, 1e3 * most));
  }
  if (markers.markers > 3 && faults.empty()) {
    double moved2 = 0.0, open2 = 0.0;
    for (std::size_t i = 0; i < contacts.t_s.size(); ++i) {
      moved2 += std::pow(refinement.residual_before_m[i] - refinement.residual_after_m[i], 2) / n;
      open2 += std::pow(markers.expected_error_m(contacts.center_W_m[i]), 2) / (3.0 * n);
    }
    open2 += scan_error_m * scan_error_m;
    if (stats::f_tail(moved2 / open2, 6.0, 3.0 * static_cast<double>(markers.markers) - 6.0) < one_in_ten_thousand) {
      faults.push_back(fmt::format(
          "the contacts would move the object's surface by {:.2g} mm RMS, while the markers leave {:.2g} mm open: "
          "check "
          "the markers' places on the object, /probe/tip_P_m and the tip's radius, or leave out /registration/mesh",
          1e3 * std::sqrt(moved2), 1e3 * std::sqrt(open2)));
    }
  }
  // Ten standard errors of a speed over a tenth of a second: its direction is good to 0.1 rad.
  const double sliding_m_per_s =
      std::max(slowest_sliding_m_per_s, 10.0 * std::sqrt(2.0) * tracker_noise_m / speed_span_s);
  if (const auto turn = turn_by_sliding(contacts, rows.normal, sliding_m_per_s);
      turn && turn->norm() > largest_turn_rad) {
    faults.push_back(fmt::format(
        "while the tip slides, the surface's push is turned by {:.2g} rad in the sensor's frame (limit {:.2g}): check "
        "/probe/q_PS, the attitude of the sensor on the probe, and the force's bias",
        turn->norm(), largest_turn_rad));
  }
  double push_N = 0.0;
  for (std::size_t i = 0; i < contacts.t_s.size(); ++i)
    push_N += std::max(0.0, rows.normal[i].dot(contacts.force_W_N[i])) / n;
  // Over 10 mm, a short stroke, the scan's error turns the normal, and so much of the push lies along the surface. A
  // pull that does not follow the push is none of it.
  constexpr double scan_slope_rad = scan_error_m / 0.01;
  const double pull = steady_pull_N(contacts, rows.normal, sliding_m_per_s, false),
               besides = steady_pull_N(contacts, rows.normal, sliding_m_per_s, true),
               most_pull = 0.125 * contact_force_N;
  if (pull > most_pull + scan_slope_rad * push_N || besides > most_pull) {
    faults.push_back(fmt::format(
        "while the tip slides, {:.2g} N along the surface are neither friction nor the tool's inertia (limit {:.2g} N, "
        "an eighth of the contact force, and {:.2g} N more if they may be the scan's error): does a cable or a hose "
        "pull at the tool? Lead it along the arm, or hang it up, and record again",
        std::max(pull, besides), most_pull, scan_slope_rad * push_N));
  } else if (pull > most_pull) {
    check.doubts.push_back(fmt::format(
        "cannot tell whether something pulls at the tool: {:.2g} N along the surface (limit {:.2g} N, an eighth of the "
        "contact force) may be a cable's pull or the scan's error; push harder and softer in turn, which tells them "
        "apart",
        pull, most_pull));
  }
  const double gain_N = gain_error_by_sliding_N(contacts, rows.normal, sliding_m_per_s),
               most_gain_N = std::max(0.25 * contact_force_N, largest_gain_error * push_N);
  // The scan's error may look so, and where the sensor hardly turns, noise.
  if (gain_N > most_gain_N) {
    check.doubts.push_back(fmt::format(
        "cannot tell whether the force's axes still have one gain: while the tip slides, a part of the surface's push "
        "turns with the sensor; if gains make it, the force is off by up to {:.2g} N (limit {:.2g} N, a quarter of the "
        "contact force or 3 % of the push): measure the tool's static poses again, and check the scan of the object",
        gain_N, most_gain_N));
  }
  if (const auto off = lever_error(contacts, rows.normal, tip_radius_m); off && off->norm() > largest_lever_error_m) {
    faults.push_back(fmt::format(
        "in contact the torque acts {:.2g} mm beside the tip, by ({:.2g}, {:.2g}, {:.2g}) mm in the sensor's frame "
        "(limit {:.2g} mm): check /probe/tip_S_m, and that the sensor's torques and forces have the same signs",
        1e3 * off->norm(), 1e3 * off->x(), 1e3 * off->y(), 1e3 * off->z(), 1e3 * largest_lever_error_m));
  }
  return check;
}

}  // namespace touchstone::acquisition
