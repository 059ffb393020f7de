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
// Where several triangles press (a valley) each has its own cone (Coulomb's law at each contact; K. L. Johnson, Contact
// Mechanics, 1985, section 7.1). The normal part of the pull is k sum l_i n_i, l_i >= 0, and the rest of it, s, is
// tangential to every wall that presses, so that it may be shared out as s l_i / sum l. Each share is in its wall's
// cone exactly where |s| <= mu sum l_i: the walls' own depths count, not the length of their resultant. Along a groove
// whose two walls rise by the angle a, pressed by N along its middle, l_1 = l_2 = N / (2 k cos a) and the friction is
// mu N / cos a: 0.424 N for a = 45 degrees and mu = 0.3. While it slides nothing else is possible, since the groove is
// the direction of slip on both walls; at rest walls that face each other could hold more by wedging, which is not
// determined by the motion and left out.
#pragma once

#include <cmath>

#include "renderers/friction/cone_split.h"
#include "renderers/friction/contact_places.h"
#include "renderers/friction/contact_transition.h"
#include "renderers/friction/fixed_order.h"

namespace touchstone::renderers {

struct ConeFriction {
  double mu_static = 0.0;   // >= mu_dynamic
  double mu_dynamic = 0.0;  // >= 0

  [[nodiscard]] bool none() const noexcept { return !(mu_static > 0.0); }
};

// A proxy that moves towards goals (nothing, until it is held) made to stop at the cone: it is sent to the goal that it
// reaches without friction where the tip lies on the cone, found by iterating on the normals at the place reached; on a
// plane once is enough.
// Proxy: a Scalar, position(), touching(), contact_normals(), pull(goal) that moves it without friction.
class ConeFollower {
 public:
  ConeFollower() = default;
  explicit ConeFollower(const ConeFriction& friction) : friction_(friction) {}

  void stick() noexcept { sliding_ = false; }
  void resume(bool sliding) noexcept { sliding_ = sliding; }
  [[nodiscard]] bool sliding() const noexcept { return sliding_; }
  [[nodiscard]] const ConeFriction& friction() const noexcept { return friction_; }

  template <class Proxy, class S = typename Proxy::Scalar>
  void follow(Proxy& proxy, const Vec3Of<S>& p, const S& rounding) noexcept {
    const bool was_sliding = sliding_;
    sliding_ = false;
    if (!proxy.touching()) return land(proxy, p, rounding);
    const ConeSplitOf<S> split = split_at(proxy, p, rounding);
    const S hold(was_sliding ? friction_.mu_dynamic : friction_.mu_static);
    if (split.pressed > S(0.0) && norm(split.slide) <= hold * split.pressed + rounding) return;
    slide(proxy, p, split, rounding);
  }

 private:
  template <class Proxy, class S = typename Proxy::Scalar>
  static ConeSplitOf<S> split_at(const Proxy& proxy, const Vec3Of<S>& p, const S& rounding) noexcept {
    return split_by_normals<S>(proxy.contact_normals(), p - proxy.position(), rounding);
  }

  // From the air: held where it came through the surface, if the cone allows.
  template <class Proxy, class S = typename Proxy::Scalar>
  void land(Proxy& proxy, const Vec3Of<S>& p, const S& rounding) noexcept {
    const Vec3Of<S> from = proxy.position();
    proxy.pull(p);
    if (!proxy.touching()) return;
    const Vec3Of<S> normal = proxy.position() - p;
    const S depth_m = norm(normal);
    const S sink = dot(normal, p - from);
    if (!(depth_m > S(0.0)) || !(sink < S(0.0))) return;
    // Where the way meets the plane through the proxy, seen from the proxy.
    const S pressed_m = proxy.contact_normals().size > 1 ? split_at(proxy, p, rounding).pressed : depth_m;
    const Vec3Of<S> entry = p + (squared_norm(normal) / -sink) * (from - p) - proxy.position();
    const S away = norm(entry);
    // Held, or dragged to the cone.
    const bool held = away <= S(friction_.mu_static) * pressed_m;
    const S share = held ? S(1.0) : S(S(friction_.mu_dynamic) * pressed_m / away);
    if (away > rounding) proxy.pull(p + share * entry);
    const ConeSplitOf<S> split = split_at(proxy, p, rounding);
    const S hold(held ? friction_.mu_static : friction_.mu_dynamic);
    if (!proxy.touching() || norm(split.slide) > hold * split.pressed + rounding) slide(proxy, p, split, rounding);
    sliding_ = sliding_ || !held;
  }

  // Goals between the tip (without friction: inside the cone) and the point below the proxy (held: outside). On a plane
  // the first one is right; over curves the secant method finds it. Where a contact comes or goes between two goals,
  // what presses jumps, and it may be that no goal puts the tip on the cone: then the proxy goes to the jump, to the
  // side of it that is inside the cone.
  template <class Proxy, class S = typename Proxy::Scalar>
  void slide(Proxy& proxy, const Vec3Of<S>& p, const ConeSplitOf<S>& split, const S& rounding) noexcept {
    using std::abs;
    constexpr int rounds = 16;
    constexpr double converged = 1e-12;  // of what presses
    const S mu(friction_.mu_dynamic);
    const S slide_m = norm(split.slide);
    sliding_ = true;
    if (!(split.pressed > S(0.0)) || !(slide_m > S(0.0))) return proxy.pull(p);
    SlidePlaceOf<S> inside;
    SlidePlaceOf<S> outside;
    outside.share = S(1.0);
    JumpSeeker<S> seeker;
    S last(1.0);
    S last_excess = slide_m - mu * split.pressed;
    S share = mu * split.pressed / slide_m;
    for (int round = 0; round < rounds; ++round) {
      proxy.pull(p - share * split.slide);
      if (!proxy.touching()) return proxy.pull(p);
      const SlidePlaceOf<S> here{share, proxy.position(), proxy.contact_normals()};
      const ConeSplitOf<S> now = split_by_normals<S>(here.contact, p - here.position, rounding);
      const S limit = mu * now.pressed;
      const S excess = norm(now.slide) - limit;
      if (abs(excess) <= S(converged) * now.pressed + rounding) return;
      // Caught in a valley, where less than sliding friction holds it.
      if (here.contact.size > 1 && excess < S(-0.5) * limit) return;
      const bool is_inside = excess < S(0.0);
      (is_inside ? inside : outside) = here;
      if (seeker.arrived(here, is_inside, rounding)) return;
      S next = seeker.next(inside, outside, split.slide, p, mu, rounding);
      if (!(next > inside.share && next < outside.share))
        next = share - excess * (share - last) / (excess - last_excess);
      if (!(next > inside.share && next < outside.share)) next = S(0.5) * (inside.share + outside.share);
      last = share;
      last_excess = excess;
      share = next;
    }
    // A place where the proxy jumps: the side of the jump that is inside the cone.
    proxy.pull(p - inside.share * split.slide);
  }

  ConeFriction friction_;
  bool sliding_ = false;
};

// The unit normal that the cone stands about; of a proxy without friction's part of the push.
template <class Proxy, class S = typename Proxy::Scalar>
Vec3Of<S> cone_normal(const Proxy& proxy, const Vec3Of<S>& p, const S& rounding) noexcept {
  if (!proxy.touching()) return Vec3Of<S>::Zero();
  const ContactNormalsOf<S> contact = proxy.contact_normals();
  if (contact.size == 1) return contact.n[0];
  const Vec3Of<S> normal = split_by_normals<S>(contact, p - proxy.position(), rounding).normal;
  const S length = norm(normal);
  return length > S(0.0) ? Vec3Of<S>(normal / length) : contact.n[0];
}

}  // namespace touchstone::renderers
