// A surface that stands off its mesh by a height h(x, y): the points whose signed distance from the mesh, outward, is h
// at their own x and y (Osher and Fedkiw, Level Set Methods, 2003, chapter 2: F = distance - h, F < 0 inside). In the
// object's frame, in metres, as all of h.
//
// Its closest point to a tip is where the tip stands along the gradient n - grad h, n the mesh's normal. Seen from a
// place S near that point F is nearly linear, so that the tip lies below the raised surface by
//   depth = (distance of the tip below the mesh + h(S) + grad h(S) . (tip - S)) / |n - grad h(S)|,
// exact for a plane raised to another plane whatever S is; else off by half of h'' times the square of S's own
// distance from the closest point. Deep in a soft body that point is not above the mesh's: it moves by the depth times
// the slope. The mesh's normal is the one where the tip stands, so that on a body of radius R the normal is off by that
// way divided by R.
#pragma once

#include "harness/rendering/effect.h"

namespace touchstone::renderers {

struct RaisedBy {
  double height_m = 0.0;
  double along_x = 0.0;  // slope of the height
  double along_y = 0.0;
};

// Raises the surface of a contact, whose proxy_W_m is the closest point of the mesh, by `height_at(x_m, y_m)`, a
// callable that returns a RaisedBy: changes depth, normal and closest point. `looks` is how often the height is asked
// for, each time nearer to the closest point; one suffices for heights that hardly bend over a depth times a slope.
// Allocates nothing. A contact without a normal, far from the surface, stays as it is.
template <typename Height>
void raise_surface(rendering::ContactState& contact, int looks, const Height& height_at) noexcept {
  const Vec3 n = contact.n_W;
  if (n.isZero()) return;
  const double below_m = (contact.proxy_W_m - contact.tip_W_m).dot(n);  // without the tip's own radius
  Vec3 nearest_W_m = contact.proxy_W_m;
  double depth_m = below_m;
  for (int look = 0; look < looks; ++look) {
    const RaisedBy raised = height_at(nearest_W_m.x(), nearest_W_m.y());
    const Vec3 slope(raised.along_x, raised.along_y, 0.0);
    const Vec3 gradient = n - slope;
    const double length = gradient.norm();
    depth_m = (below_m + raised.height_m + slope.dot(contact.tip_W_m - nearest_W_m)) / length;
    contact.n_W = gradient / length;
    nearest_W_m = contact.tip_W_m + depth_m * contact.n_W;
  }
  contact.depth_m += depth_m - below_m;
  contact.proxy_W_m = nearest_W_m;
}

}  // namespace touchstone::renderers
