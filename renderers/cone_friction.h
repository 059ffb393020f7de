// Friction inside the proxy's step: the friction cone.
//
// Source: W. S. Harwin and N. Melder, "Improved haptic rendering for multi-finger manipulation using friction cone
// based god-objects", EuroHaptics 2002; N. Melder and W. S. Harwin, "Extending the friction cone algorithm for
// arbitrary polygon based haptic objects", Haptic Symposium 2004. A cone with its apex at the god-object opens into the
// object about the inward normal with half angle atan(mu). While the tip is inside, the god-object stays; else it moves
// over the surface, towards where it would rest without friction, until the tip lies on the cone. At depth h over a
// plane the cone is a circle of radius mu h about the tip's foot point. Two cones make break-away: a god-object that
// stays is held by mu_static; once it moves it goes on to the cone of mu_dynamic, and is held by mu_static again after
// the first step in which it did not have to move.
//
// The force k (g - p) then lies in the cone: |f_t| <= mu |f_n|. Passivity: moving the tip with the god-object at rest
// stores k/2 |g - p|^2 to the hand's work exactly; the god-object only moves where that makes |g - p| smaller.
// Where several triangles press (a valley) the cone stands about the resultant of their normal forces; Coulomb's law at
// each of them would allow more.
#pragma once

#include <cmath>

#include "renderers/contact_places.h"
#include "renderers/nearest_in_polyhedron.h"

namespace touchstone {

struct ConeFriction {
  double mu_static = 0.0;   // >= mu_dynamic
  double mu_dynamic = 0.0;  // >= 0

  [[nodiscard]] bool none() const noexcept { return !(mu_static > 0.0); }
};

// The pull from a proxy towards its tip, `way`, split by the normals there.
struct ConeSplit {
  Vec3 slide;   // where it would move without friction, to first order: the tangential part
  Vec3 normal;  // way = slide - normal: the sum of non-negative multiples of the normals
};

ConeSplit split_by_normals(const ContactNormals& contact, const Vec3& way, double rounding) noexcept;

// A proxy that moves towards goals (nothing, until it is held) made to stop at the cone: it is sent to the goal that it
// reaches without friction where the tip lies on the cone, found by iterating on the normals at the place reached; on a
// plane once is enough.
// Proxy: position(), touching(), contact_normals(), pull(goal) that moves it without friction.
class ConeFollower {
 public:
  ConeFollower() = default;
  explicit ConeFollower(const ConeFriction& friction) : friction_(friction) {}

  void stick() noexcept { sliding_ = false; }
  [[nodiscard]] bool sliding() const noexcept { return sliding_; }
  [[nodiscard]] const ConeFriction& friction() const noexcept { return friction_; }

  template <class Proxy>
  void follow(Proxy& proxy, const Vec3& p, double rounding) noexcept {
    const bool was_sliding = sliding_;
    sliding_ = false;
    if (!proxy.touching()) return land(proxy, p, rounding);
    ConeSplit split = split_by_normals(proxy.contact_normals(), p - proxy.position(), rounding);
    double normal_m = split.normal.norm();
    const double hold = was_sliding ? friction_.mu_dynamic : friction_.mu_static;
    if (normal_m > 0.0 && split.slide.norm() <= hold * normal_m + rounding) return;
    slide(proxy, p, split, normal_m, rounding);
  }

 private:
  // From the air: held where it came through the surface, if the cone allows.
  template <class Proxy>
  void land(Proxy& proxy, const Vec3& p, double rounding) noexcept {
    const Vec3 from = proxy.position();
    proxy.pull(p);
    if (!proxy.touching()) return;
    const Vec3 normal = proxy.position() - p;
    const double depth_m = normal.norm();
    const double sink = normal.dot(p - from);
    if (!(depth_m > 0.0) || !(sink < 0.0)) return;
    // Where the way meets the plane through the proxy, seen from the proxy.
    const Vec3 entry = p + (normal.squaredNorm() / -sink) * (from - p) - proxy.position();
    const double away = entry.norm();
    // Held, or dragged to the cone.
    const bool held = away <= friction_.mu_static * depth_m;
    const double share = held ? 1.0 : friction_.mu_dynamic * depth_m / away;
    if (away > rounding) proxy.pull(p + share * entry);
    ConeSplit split = split_by_normals(proxy.contact_normals(), p - proxy.position(), rounding);
    const double normal_m = split.normal.norm();
    const double hold = held ? friction_.mu_static : friction_.mu_dynamic;
    if (!proxy.touching() || split.slide.norm() > hold * normal_m + rounding)
      slide(proxy, p, split, normal_m, rounding);
    sliding_ = sliding_ || !held;
  }

  // Goals between the tip (without friction: inside the cone) and the point below the proxy (held: outside). On a plane
  // the first one is right; over curves the secant method finds it.
  template <class Proxy>
  void slide(Proxy& proxy, const Vec3& p, const ConeSplit& split, double normal_m, double rounding) noexcept {
    constexpr int kRounds = 16;
    constexpr double kConverged = 1e-12;  // of the normal part
    const double mu = friction_.mu_dynamic;
    const double slide_m = split.slide.norm();
    sliding_ = true;
    if (!(normal_m > 0.0) || !(slide_m > 0.0)) return proxy.pull(p);
    double inside = 0.0;
    double outside = 1.0;
    double last = 1.0;
    double last_excess = slide_m - mu * normal_m;
    double share = mu * normal_m / slide_m;
    for (int round = 0; round < kRounds; ++round) {
      proxy.pull(p - share * split.slide);
      if (!proxy.touching()) return proxy.pull(p);
      const ContactNormals contact = proxy.contact_normals();
      const ConeSplit now = split_by_normals(contact, p - proxy.position(), rounding);
      const double limit = mu * now.normal.norm();
      const double excess = now.slide.norm() - limit;
      if (std::abs(excess) <= kConverged * now.normal.norm() + rounding) return;
      // Caught in a valley, where less than sliding friction holds it.
      if (contact.size > 1 && excess < -0.5 * limit) return;
      (excess < 0.0 ? inside : outside) = share;
      double next = share - excess * (share - last) / (excess - last_excess);
      if (!(next > inside && next < outside)) next = 0.5 * (inside + outside);
      last = share;
      last_excess = excess;
      share = next;
    }
    // A place where the proxy jumps: the side of the jump that is inside the cone.
    proxy.pull(p - inside * split.slide);
  }

  ConeFriction friction_;
  bool sliding_ = false;
};

// The unit normal that the cone stands about; of a proxy without friction's part of the push.
template <class Proxy>
Vec3 cone_normal(const Proxy& proxy, const Vec3& p, double rounding) noexcept {
  if (!proxy.touching()) return Vec3::Zero();
  const ContactNormals contact = proxy.contact_normals();
  if (contact.size == 1) return contact.n[0];
  const Vec3 normal = split_by_normals(contact, p - proxy.position(), rounding).normal;
  const double length = normal.norm();
  return length > 0.0 ? Vec3(normal / length) : contact.n[0];
}

}  // namespace touchstone
