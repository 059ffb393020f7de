// Where a proxy that slides with friction jumps.
//
// A proxy with the friction cone (cone_friction.h) is sent to goals on the way from its tip to the point below it, and
// the one is looked for where the tip lies on the cone. Where a contact comes or goes between two goals, what presses
// jumps with the direction in which it presses: on one side the tip is inside the cone, on the other outside, and no
// goal is on it. Halving finds that place by one binary digit a search; here two places of rest tell it. On given
// planes the place of rest is linear in the goal (C. B. Zilles and J. K. Salisbury, "A constraint-based god-object
// method for haptic display", IROS 1995, section 4), so that the lines through both meet where the contact comes or
// goes.
#pragma once

#include <algorithm>

#include "renderers/friction/cone_split.h"
#include "renderers/friction/fixed_order.h"

namespace touchstone::renderers {

// Where the proxy comes to rest when it is sent to the goal p - share * slide.
template <class S>
struct SlidePlaceOf {
  S share{0.0};
  Vec3Of<S> position = Vec3Of<S>::Zero();
  ContactNormalsOf<S> contact;
};

// Between a place inside of the cone and one outside: the share at which the proxy goes over from the contacts of the
// one to those of the other, and the place of rest there. On given planes that place is linear in the share (Zilles and
// Salisbury 1995, section 4), so that two lines meet where a contact comes or goes.
template <class S>
struct JumpOf {
  S share{-1.0};  // < 0: the lines do not meet, or one of them reaches the cone before, so that nothing jumps
  Vec3Of<S> position = Vec3Of<S>::Zero();
  S turn_m{0.0};  // per share: how fast the lines part
};
template <class S>
JumpOf<S> jump_between(const SlidePlaceOf<S>& inside, const SlidePlaceOf<S>& outside, const Vec3Of<S>& slide,
                       const Vec3Of<S>& p, const S& mu, const S& rounding) noexcept;

// Goals on both sides of a jump, the side inside of the cone first.
template <class S>
class JumpSeeker {
 public:
  // The next share to try; < 0: no jump is in sight.
  S next(const SlidePlaceOf<S>& inside, const SlidePlaceOf<S>& outside, const Vec3Of<S>& slide, const Vec3Of<S>& p,
         const S& mu, const S& rounding) noexcept {
    const int before = side_;
    side_ = 0;
    if (misses_ > misses || inside.contact.size == 0 || outside.contact.size == 0) return S(-1.0);
    jump_ = jump_between<S>(inside, outside, slide, p, mu, rounding);
    if (jump_.share < S(0.0)) return S(-1.0);
    slide_m_ = norm(slide);
    near_ = std::max(S(near), S(apart * rounding / jump_.turn_m));
    side_ = before < 0 ? 1 : -1;
    return jump_.share + S(side_) * near_;
  }

  // Whether `here`, reached from the share that next() gave, is the jump: inside of the cone, where the lines meet.
  [[nodiscard]] bool arrived(const SlidePlaceOf<S>& here, bool is_inside, const S& rounding) noexcept {
    if (side_ == 0) return false;
    if (is_inside != (side_ < 0)) ++misses_;
    return is_inside && side_ < 0 &&
           distance<S>(here.position, jump_.position) <= near_ * slide_m_ + S(apart) * rounding;
  }

 private:
  static constexpr double near = 1e-9;  // share of the slide, to each side of the jump
  static constexpr double apart = 8.0;  // roundings between two places that are not the same
  static constexpr int misses = 3;      // of jumps that were elsewhere than the planes put them, before it gives up
  JumpOf<S> jump_;
  S near_{0.0};
  S slide_m_{0.0};
  int side_ = 0;  // of the jump, of the share asked for last; -1: inside of the cone, 0: no jump was in sight
  int misses_ = 0;
};

}  // namespace touchstone::renderers
