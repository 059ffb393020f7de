// Line spectral frequencies against a published example, and against their own inverse at every order.
#include "line_spectrum.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <vector>

#include "delaunay.h"
#include "texture_model.h"

namespace touchstone::texture {
namespace {

using ::testing::DoubleNear;
using ::testing::Pointwise;

// By the step-up recursion from reflection coefficients within `most`: stable by construction.
std::vector<double> stable_polynomial(std::size_t order, double most, std::mt19937_64& engine) {
  std::uniform_real_distribution<double> uniform(-most, most);
  std::vector<double> a{1.0};
  for (std::size_t m = 1; m <= order; ++m) {
    const double k = uniform(engine);
    std::vector<double> next = a;
    next.push_back(0.0);
    for (std::size_t i = 1; i <= m; ++i) next[i] += k * a[m - i];
    a = next;
  }
  return a;
}

// The example of MATLAB's poly2lsf, with the digits that EngeeDSP's page of the same function prints for it.
TEST(LineSpectrum, ThePublishedExample) {
  const std::vector<double> a{1.0, 0.6149, 0.9899, 0.0, 0.0031, -0.0082};
  const std::vector<double> expected{0.7841730812677572, 1.560541479153228, 1.8776458548335448, 1.898431256865375,
                                     2.3592523239476946};
  EXPECT_THAT(line_spectral_frequencies(a), Pointwise(DoubleNear(1e-12), expected));
  std::vector<double> back(a.size());
  polynomial_of(expected, back);
  EXPECT_THAT(back, Pointwise(DoubleNear(1e-13), a));
}

TEST(LineSpectrum, TheInverseIsExactAtEveryOrder) {
  std::mt19937_64 engine(17);
  for (std::size_t order = 1; order <= most_coefficients; ++order) {
    for (int i = 0; i < 20; ++i) {
      const std::vector<double> a = stable_polynomial(order, 0.9, engine);
      std::vector<double> back(a.size());
      polynomial_of(line_spectral_frequencies(a), back);
      double scale = 0.0;
      for (const double c : a) scale = std::max(scale, std::abs(c));
      EXPECT_THAT(back, Pointwise(DoubleNear(1e-8 * scale), a)) << "order " << order;
    }
  }
}

TEST(LineSpectrum, AFilterThatIsNotStableHasNone) {
  EXPECT_THROW(line_spectral_frequencies(std::vector<double>{1.0, 0.0, 1.02}), std::domain_error);
  EXPECT_THROW(line_spectral_frequencies(std::vector<double>{1.0, -1.0}), std::domain_error);
}

// No point inside the circle through the corners of any triangle, and the triangles fill the square.
TEST(Delaunay, HasEmptyCirclesAndFillsTheHull) {
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<std::array<double, 2>> points{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5, 0}, {0.25, 1}};
  for (int i = 0; i < 40; ++i) points.push_back({uniform(engine), uniform(engine)});
  double area = 0.0;
  for (const auto& [a, b, c] : delaunay(points)) {
    const auto [ax, ay] = points[a];
    const auto [bx, by] = points[b];
    const auto [cx, cy] = points[c];
    const double twice = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    ASSERT_GT(twice, 0.0) << "counterclockwise";
    area += 0.5 * twice;
    for (const auto& [px, py] : points) {
      const double dax = ax - px, day = ay - py, dbx = bx - px, dby = by - py, dcx = cx - px, dcy = cy - py;
      const double inside = (dax * dax + day * day) * (dbx * dcy - dcx * dby) -
                            (dbx * dbx + dby * dby) * (dax * dcy - dcx * day) +
                            (dcx * dcx + dcy * dcy) * (dax * dby - dbx * day);
      EXPECT_LE(inside, 1e-6);
    }
  }
  EXPECT_NEAR(area, 1.0, 1e-6);
}

}  // namespace
}  // namespace touchstone::texture
