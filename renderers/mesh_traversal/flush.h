// What counts as flush: surfaces of bodies that were put side by side to make one floor lie in one plane only as
// exactly as their files say. Coordinates in single precision, as binary STL has them and as most programs compute
// them, are off by up to half a unit in the last place, 2^-24 of the largest coordinate along each axis: below sqrt(3)
// 2^-24 in space. Of two bodies: below 2 sqrt(3) 2^-24 < 2^-22 (24 nm on an object of 0.1 m). Steps and gaps up to that
// count as none if bodies meet; whatever is larger is an obstacle to a point.
#pragma once

namespace touchstone::renderers {

// `magnitude_m`: the largest magnitude of a coordinate of the mesh.
constexpr double flush_m(double magnitude_m) noexcept { return 0x1p-22 * magnitude_m; }

}  // namespace touchstone::renderers
