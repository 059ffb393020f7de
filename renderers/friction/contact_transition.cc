#include "renderers/friction/contact_transition.h"

#include <cmath>

#include "harness/base/counted.h"

namespace touchstone::renderers {
namespace {

// How the place of rest on the planes of `contact` moves with `way` of its goal.
template <class S>
Vec3Of<S> along_planes(const ContactNormalsOf<S>& contact, const Vec3Of<S>& way) noexcept {
  if (contact.size == 1) return way - dot(contact.n[0], way) * contact.n[0];
  if (contact.size > 2) return Vec3Of<S>::Zero();
  const Vec3Of<S> edge = contact.n[0].cross(contact.n[1]);
  const S squared = squared_norm(edge);
  return squared > S(0.0) ? Vec3Of<S>((dot(edge, way) / squared) * edge) : Vec3Of<S>(Vec3Of<S>::Zero());
}

}  // namespace

template <class S>
JumpOf<S> jump_between(const SlidePlaceOf<S>& inside, const SlidePlaceOf<S>& outside, const Vec3Of<S>& slide,
                       const Vec3Of<S>& p, const S& mu, const S& rounding) noexcept {
  using std::sqrt;
  // The goal moves by -slide per unit of the share.
  const Vec3Of<S> in = along_planes<S>(inside.contact, -slide);
  const Vec3Of<S> out = along_planes<S>(outside.contact, -slide);
  // Where (inside.position + in (s - inside.share)) - (outside.position + out (s - outside.share)) is least.
  const Vec3Of<S> turn = in - out;
  const S squared = squared_norm(turn);
  if (!(squared > S(0.0))) return {};
  const Vec3Of<S> apart = (inside.position - inside.share * in) - (outside.position - outside.share * out);
  const S share = -dot(apart, turn) / squared;
  if (!(share > inside.share && share < outside.share)) return {};
  const auto excess = [&](const SlidePlaceOf<S>& side, const Vec3Of<S>& per_share) {
    const Vec3Of<S> there = side.position + (share - side.share) * per_share;
    const ConeSplitOf<S> split = split_by_normals<S>(side.contact, p - there, rounding);
    return S(norm(split.slide) - mu * split.pressed);
  };
  if (!(excess(inside, in) < S(0.0) && excess(outside, out) > S(0.0))) return {};
  return {share, outside.position + (share - outside.share) * out, S(sqrt(squared))};
}

template JumpOf<double> jump_between(const SlidePlaceOf<double>&, const SlidePlaceOf<double>&, const Vec3&, const Vec3&,
                                     const double&, const double&) noexcept;
template JumpOf<Counted> jump_between(const SlidePlaceOf<Counted>&, const SlidePlaceOf<Counted>&,
                                      const Vec3Of<Counted>&, const Vec3Of<Counted>&, const Counted&,
                                      const Counted&) noexcept;

}  // namespace touchstone::renderers
