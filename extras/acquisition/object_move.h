// Did the object move between earlier and later contacts? A rigid move m of the object after a time T, six parameters
// and their standard errors, from the gaps between ball and mesh:
//   gap_i = -J_i (c + [t_i > T] m) + k N_i + e(place_i) + noise_i,
// with J how a gap changes if the ball moves, c the object's place before T, of which the markers, measured before the
// session, know something too, and k how far the surface gives in. T runs over the eighths of the contacts.
//   The scan's error e is the same whenever the tip comes back to a place, so that two passes of one place compare
// without it and two places do not: a Gaussian process of 0.2 mm (1-sigma) with covariance exp(-distance / length).
// Nothing is known of its length: a half, a quarter and an eighth of the contacts' spread are tried, and the least
// certain answer counts. Noise is what the best fit leaves of one contact; if contacts within half a second have a
// common error, as if it had been seen once.
// Source: generalised least squares with a Gaussian process as the model's error (Kennedy and O'Hagan, J. Royal
// Statistical Society B 63 (2001), 425-464, section 4; Rasmussen and Williams 2006, section 2.7).
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "harness/base/vec.h"
#include "harness/surface/surface.h"
#include "rigid_registration.h"

namespace touchstone::acquisition {

constexpr double scan_error_m = 0.2e-3;
constexpr double independent_s = 0.5;  // contacts this far apart in time have independent errors of the tracker
constexpr double speed_span_s = 0.1;   // of the contacts' velocities: of 0.1 mm of noise it makes 1.4 mm/s

// Contacts on the registered object; all lists have one entry per contact, in the order of time.
struct ContactSamples {
  std::vector<double> t_s;
  std::vector<Vec3> center_W_m, force_W_N, torque_W_Nm, velocity_W_m_per_s;  // torque about the centre
  std::vector<Quat> q_WP, q_WS;  // the tracked body's and the sensor's attitude
};

// Gaps between ball and mesh and how they change with what may be wrong, one row per contact.
struct GapRows {
  Eigen::VectorXd gap;
  Eigen::MatrixXd move, tip, load;  // the object's six, the tip's three in the probe's frame, the force
  std::vector<Vec3> normal;
  Vec3 middle_m = Vec3::Zero();  // turns are about it, as arc lengths at the spread
  double spread_m = 0.0;
};
Mat3 cross_matrix(const Vec3& v);  // v x
GapRows gap_rows(const surface::Surface& surface, const ContactSamples& contacts, double tip_radius_m);

// A move in the six coordinates of the rows, and what the markers know of it: the inverse of its covariance.
Vector6 move_of(const GapRows& rows, const RigidTransform& correction);
Matrix6 marker_information(const GapRows& rows, const MarkerRegistration& markers, double mesh_error_m);
// How many of the contacts are independent: half seconds with contact.
double independent_contacts(const ContactSamples& contacts);

// The move that explains the gaps best, at the least certain correlation length. Sizes are root mean squares at the
// touched places.
struct ObjectMove {
  static constexpr double unlimited_m = std::numeric_limits<double>::infinity();
  static constexpr double clear_sigmas = 3.5;  // 6 directions at 7 times by chance: in 2 % of sessions or fewer
  double at_s = 0.0;                           // between the contacts before this time and those after
  double sigmas = 0.0;                         // standard errors of the clearest direction, at any time
  double size_m = 0.0;                         // in the directions beyond 2.5 standard errors
  double possible_m = unlimited_m;             // with two standard errors of all other directions
  double unnoticed_m = unlimited_m;            // half-way, in the least known direction, what would not be clear
  double left_rms_m = unlimited_m;             // of the gaps, after the move
  // Along which orthogonal directions of the mesh's frame the contacts' middle may have shifted half-way, turned or
  // not, by how much without being clear; nothing below 26 contacts.
  Mat3 shift_axes = Mat3::Identity();
  std::optional<Vec3> unnoticed_shift_m;

  [[nodiscard]] bool clear() const { return sigmas > clear_sigmas; }
  // Empty where every move beyond 2 mm would be clear; else what may have moved, direction by direction.
  [[nodiscard]] std::string doubt() const;
};
// `contacts` lie where markers and contacts together place the object, `correction` from where the markers do: the gaps
// are linear in moves of a few millimetres only. With fewer than 26 contacts (twice the parameters) nothing is known.
ObjectMove object_move(const surface::Surface& surface, const ContactSamples& contacts, double tip_radius_m,
                       double tracker_noise_m, const RigidTransform& correction, const MarkerRegistration& markers);

}  // namespace touchstone::acquisition
