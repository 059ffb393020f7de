// What of a proxy's pull presses on its contacts and what slides along them: the split that the friction cone
// (cone_friction.h) is about.
#pragma once

#include "renderers/friction/contact_places.h"

namespace touchstone::renderers {

// The pull from a proxy towards its tip, `way`, split by the normals there.
template <class S>
struct ConeSplitOf {
  Vec3Of<S> slide;   // where it would move without friction, to first order: the tangential part
  Vec3Of<S> normal;  // way = slide - normal: the sum of non-negative multiples of the normals
  S pressed{0.0};    // the sum of these multiples, in the unit of `way`: what the walls press, each by itself
};

template <class S>
ConeSplitOf<S> split_by_normals(const ContactNormalsOf<S>& contact, const Vec3Of<S>& way, const S& rounding) noexcept;

}  // namespace touchstone::renderers
