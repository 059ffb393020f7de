// A plane curve of straight lines and circular arcs with an inside and an outside: what is extruded into wedges, steps,
// grooves and shells, and revolved into spheres, tori and bumps. Coordinates (s, z) in metres; the outside lies to the
// right of the direction of travel. Closest point and signed distance are closed forms, exact to rounding.
#pragma once

#include <cstddef>
#include <vector>

#include "harness/base/vec.h"

namespace touchstone::synthetic {

using Vec2 = Eigen::Vector2d;

struct ProfileElement {
  bool is_arc;
  Vec2 start, end;
  Vec2 normal;         // of a line: outward unit normal
  Vec2 centre;         // of an arc
  double radius;       // of an arc
  double start_angle;  // of an arc, rad
  double sweep;        // of an arc, rad; positive is counter-clockwise: convex
  [[nodiscard]] double length() const;
  [[nodiscard]] Vec2 at(double fraction) const;
};

ProfileElement profile_line(const Vec2& start, const Vec2& end);
// A sweep of +-2 pi is a full circle.
ProfileElement profile_arc(const Vec2& centre, double radius, double start_angle, double sweep);

struct ProfilePoint {
  Vec2 p;
  Vec2 n;                  // outward unit normal; at a corner the sum of its two sides' normals, normalised
  double signed_distance;  // negative inside
  bool corner;             // a sharp one: p - query is not along n
};

struct Corner {
  Vec2 p;
  double radius = 0.0;  // of the fillet, 0: sharp
};

class Profile {
 public:
  // Through the corners in order; fillets touch both sides. Throws UsageError where a fillet does not fit.
  static Profile through(const std::vector<Corner>& corners, bool closed);
  // Elements in order, each starting at the very point where the one before ends.
  Profile(std::vector<ProfileElement> elements, bool closed);

  [[nodiscard]] ProfilePoint closest(const Vec2& p) const;
  [[nodiscard]] const std::vector<ProfileElement>& elements() const noexcept { return elements_; }
  [[nodiscard]] bool closed() const noexcept { return closed_; }
  [[nodiscard]] double length() const;

  struct Samples {
    std::vector<Vec2> points;  // every corner is among them; a closed profile's first point is not repeated
    double sagitta;            // no chord is further than this from its arc
  };
  // About `count` chords, shared among the elements by length and, among arcs, by the angle they turn.
  [[nodiscard]] Samples sample(std::size_t count) const;

 private:
  std::vector<ProfileElement> elements_;
  struct Joint {
    Vec2 n;
    bool sharp;
  };
  std::vector<Joint> joints_;  // at the start of element i; one more for the end of an open profile
  bool closed_;
};

}  // namespace touchstone::synthetic
