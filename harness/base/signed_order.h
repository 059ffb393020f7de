// The 48 ways in which three columns of a vector can be exchanged and have the other sign: six orders times eight
// signs. Half of them are mirror images, as of a left-handed frame; the others are turns by right angles.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "harness/base/vec.h"

namespace touchstone {

struct SignedOrder {
  std::array<int, 3> from{0, 1, 2};  // component k is `sign[k]` times the column `from[k]` of the file
  std::array<int, 3> sign{1, 1, 1};

  [[nodiscard]] Vec3 applied(const Vec3& v) const {
    return {sign[0] * v[from[0]], sign[1] * v[from[1]], sign[2] * v[from[2]]};
  }
  [[nodiscard]] bool as_it_stands() const { return from == std::array{0, 1, 2} && sign == std::array{1, 1, 1}; }
  [[nodiscard]] bool reversed() const { return from == std::array{0, 1, 2} && sign == std::array{-1, -1, -1}; }
  // "fx has the other sign", "fy and fz are exchanged" of a vector f; empty for the order as it stands.
  [[nodiscard]] std::string meaning(char vector = 'f') const;
};

// All 48, those that change the least first.
std::vector<SignedOrder> signed_orders();

}  // namespace touchstone
