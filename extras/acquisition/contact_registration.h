// The registration refined by where the tip touched: the rigid correction that puts every ball centre one radius above
// the surface. Iterated closest points with distances to tangent planes (Chen and Medioni 1992; Besl and McKay 1992),
// Huber weights, and no movement along directions that the contacts do not determine (a plane tells 3 of 6).
#pragma once

#include <string>
#include <vector>

#include "harness/surface/surface.h"
#include "rigid_registration.h"

namespace touchstone::acquisition {

struct ContactRegistrationOptions {
  int most_iterations = 100;
  double weakest_direction = 1e-4;  // of the strongest; what moves the distances less than this is left alone
  double huber_sigmas = 2.5;        // beyond this many (robust) sigmas a contact counts less
};

struct ContactRegistration {
  RigidTransform correction;              // after the marker registration; about the object's origin
  std::vector<double> residual_before_m;  // per contact: signed distance of the centre minus the tip's radius
  std::vector<double> residual_after_m;   // the residual map, in the order of the contacts
  std::vector<Vec3> contact_W_m;          // the surface points touched, after the correction
  double rms_before_m = 0.0;
  double rms_after_m = 0.0;
  int determined_directions = 0;  // of 6
  int iterations = 0;
  bool converged = false;
};

// `centers_W_m`: ball centres while in contact. Throws BadData for fewer than 6 contacts.
ContactRegistration register_contacts(const surface::Surface& surface, const std::vector<Vec3>& centers_W_m,
                                      double tip_radius_m, const ContactRegistrationOptions& options,
                                      const std::string& source);

// The surface point that a ball touches: from its centre along the surface's normal. `gap_m` is the distance between
// ball and surface, negative where they overlap.
struct BallContact {
  Vec3 contact_W_m;
  Vec3 n_W;
  double gap_m;
};
BallContact ball_contact(const surface::Surface& surface, const Vec3& center_W_m, double tip_radius_m);

}  // namespace touchstone::acquisition
