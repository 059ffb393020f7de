// How what an object does at contact and on leaving grows with the speed of the hand. Two recordings by hands of
// different speeds are compared at one speed, and the law that takes the one there is trusted the less the more the
// speeds differ: at a factor of two the growth may be by eight powers of the speed more than the law's (a blow that
// rises through a band's edge), or none at all, in proportion to the logarithm below. The width is ours; it is what
// dampers, rings and snaps need that are recorded at half and at twice the speed.
#pragma once

namespace touchstone::perception {

struct GrowthBounds {
  double by_law = 1.0;  // factor from the rendered hand's speed to the real one's
  double least = 1.0;
  double most = 1.0;
};

// `speed`: the real hand's over the rendered one's; `power`: the law's, of the speed.
GrowthBounds growth_bounds(double speed, double power);

}  // namespace touchstone::perception
