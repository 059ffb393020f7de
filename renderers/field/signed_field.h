// A signed distance field as the implicit renderer wants it: a value and a gradient anywhere. Either an analytic
// surface's own distance, or samples of a mesh's distance on a grid with cubic interpolation.
#pragma once

#include <cstddef>
#include <memory>

#include "harness/base/counted.h"
#include "harness/base/vec.h"
#include "harness/surface/surface.h"

namespace touchstone::renderers {

// Over another scalar than double its operations are counted (harness/base/counted.h).
template <class S>
class SignedFieldOf {
 public:
  virtual ~SignedFieldOf() = default;
  // Negative inside. Never more than the distance to the surface times steepness().
  [[nodiscard]] virtual S value_m(const Vec3Of<S>& p_W_m) const = 0;
  [[nodiscard]] virtual Vec3Of<S> gradient(const Vec3Of<S>& p_W_m) const = 0;
  // How much faster than distance the value may grow.
  [[nodiscard]] virtual double steepness() const noexcept { return 1.0; }
  // The body's size: what tolerances are relative to.
  [[nodiscard]] virtual double size_m() const noexcept = 0;
  [[nodiscard]] virtual std::size_t memory_bytes() const noexcept { return 0; }
};
using SignedField = SignedFieldOf<double>;

// Surface::signed_distance, with its gradient by the central difference of fourth order, (8 (f(d) - f(-d)) - (f(2d) -
// f(-2d))) / 12 d at d = 1e-4 of the body's size: neither normals nor foot points of the surface are used, so that an
// error in those shows against this field.
std::unique_ptr<SignedField> make_analytic_field(std::shared_ptr<const surface::Surface> surface);

// Signed distances of a surface at the nodes of a grid along the axes, `resolution` of them along the body's longest
// side, tricubic convolution between (R. G. Keys, "Cubic convolution interpolation for digital image processing", IEEE
// TASSP 29(6), 1981, a = -1/2, in each direction): continuous with its gradient, third order where the distance is
// smooth. What is finer than two nodes is not seen. Outside the grid the value is the distance to the body's box. Built
// in parallel; the same to the bit whatever the number of threads.
std::unique_ptr<SignedField> make_sampled_field(const surface::Surface& surface, int resolution);
// The same with its operations counted, to the bit. Not counted: taking the samples.
std::unique_ptr<SignedFieldOf<Counted>> make_counted_field(const surface::Surface& surface, int resolution);

}  // namespace touchstone::renderers
