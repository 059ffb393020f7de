// How much each of several contacts presses on a proxy.
#pragma once

#include <algorithm>

#include "renderers/friction/contact_places.h"
#include "renderers/friction/fixed_order.h"

namespace touchstone::renderers {

// How much each contact presses: n = sum w_i n_i, least squares; zeros where the normals cannot be told apart.
template <class S>
Vec3Of<S> shares(const ContactPlacesOf<S>& contact, const Vec3Of<S>& n) noexcept {
  const S none(0.0);
  const S one(1.0);
  Vec3Of<S> share = Vec3Of<S>::Zero();
  if (contact.size == 2) {
    const S c = dot(contact.place[0].n, contact.place[1].n);
    const S a = dot(contact.place[0].n, n);
    const S b = dot(contact.place[1].n, n);
    const S apart = one - c * c;
    if (apart > none) share = {(a - c * b) / apart, (b - c * a) / apart, none};
  } else {
    Eigen::Matrix<S, 3, 3> normals;
    for (int i = 0; i < 3; ++i) normals.col(i) = contact.place[static_cast<std::size_t>(i)].n;
    Eigen::Matrix<S, 3, 3> inverse;
    if (invert<S>(normals, 1e-12, inverse)) share = product(inverse, n);
  }
  for (S& part : share) part = std::max(none, part);
  return share;
}

}  // namespace touchstone::renderers
