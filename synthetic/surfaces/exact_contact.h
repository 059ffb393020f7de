// The exact answer of a frictionless god-object at rest, from an analytic surface: Zilles and Salisbury 1995 put the
// god-object at the point of the surface nearest to the tip, and the spring between them pulls with k times the
// distance. For a ball tip the god-object is the ball's centre on the offset surface at the ball's radius (Ruspini et
// al. 1997).
//
// Holds while the path to the tip never left the neighbourhood of one sheet of the surface: the depth stays below the
// distance to the medial axis inside, and the ball fits every hollow that it touches (for the sharp hollow between two
// planes see exact_valley_contact). A god-object remembers its path, a closest point does not: beyond that the two
// differ, rightly.
#pragma once

#include "harness/surface/surface.h"

namespace touchstone::synthetic {

struct ExactContact {
  bool contact;    // the ball (or point) overlaps the object
  Vec3 proxy_W_m;  // surface contact point; the ball's centre at the proxy for a ball; the tip itself when free
  Vec3 n_W;        // outward unit normal of the contact
  double depth_m;  // >= 0
  Vec3 f_W_N;      // k depth n, on the probe
};

ExactContact exact_contact(const surface::Surface& surface, const Vec3& tip_W_m, double stiffness_N_per_m,
                           double tip_radius_m);

// Whether the way from a to b, tips of that radius, leaves the neighbourhood of the sheet on which it was: inside the
// object the closest point moves less than twice as far as the tip while the depth stays below half of the reach, the
// distance to the medial axis (H. Federer, "Curvature measures", Transactions of the AMS 93, 1959, theorem 4.8 (8):
// reach / (reach - depth)); where it moves further, exact_contact() and a god-object may have parted. The way is looked
// at in sixteen pieces.
bool leaves_sheet(const surface::Surface& surface, const Vec3& a_W_m, const Vec3& b_W_m, double tip_radius_m);

// Two half-spaces of free room above planes that meet in a line through `line_W_m`, with outward unit normals n1 and
// n2: a groove or a concave crease. The ball's centre is confined to a convex wedge, so that the answer is the
// projection on it and does not depend on the path: on one plane, on the other, or on the line along which the ball
// touches both.
ExactContact exact_valley_contact(const Vec3& line_W_m, const Vec3& n1_W, const Vec3& n2_W, const Vec3& tip_W_m,
                                  double stiffness_N_per_m, double tip_radius_m);

}  // namespace touchstone::synthetic
