// A plate of 6 mm pressed at its middle: out by either side is right, and at 1 um beside the middle by one alone.
#include "harness/golden/equal_answers.h"

#include <gtest/gtest.h>

#include <cmath>

#include "harness/golden/comparison/tolerance.h"
#include "harness/surface/embree_surface.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::golden {

namespace {

struct Row {
  double z_m, contact_z_m, fz_N;
};

TrajectoryColumns columns(const std::vector<Row>& rows) {
  TrajectoryColumns made{"test", {}};
  for (const char* const name : {"t", "x", "y", "z", "px", "py", "pz", "fx", "fy", "fz", "contact"})
    made.columns.push_back({name, std::vector<double>(rows.size(), 0.0)});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    made.columns[3].values[i] = rows[i].z_m;
    made.columns[6].values[i] = rows[i].contact_z_m;
    made.columns[9].values[i] = rows[i].fz_N;
    made.columns[10].values[i] = 1.0;
  }
  return made;
}

TEST(EqualAnswers, OfTwoEquallyCloseSidesEitherPassesAndNothingElse) {
  surface::TriangleMesh plate = testing::cube(1.0);
  const Box3 box = make_embree_surface(plate)->bounds();
  for (Vec3& v : plate.vertices_W_m)
    v = (v - box.center()).cwiseQuotient(box.sizes()).cwiseProduct(Vec3(0.05, 0.05, 0.006));
  const auto surface = make_embree_surface(plate);
  const Tolerance tolerance = default_tolerance();
  const auto taken = [&](const Row& golden, const Row& other) {
    TrajectoryColumns expected = columns({golden, {0.001, 0.003, 1.0}});
    const TrajectoryColumns obtained = columns({other, {0.001, 0.003, 1.0}});
    const std::size_t count = take_equal_answers(*surface, tolerance, obtained, expected);
    EXPECT_EQ(expected.columns[9].values[0], count == 1 ? other.fz_N : golden.fz_N);
    return count;
  };
  EXPECT_EQ(taken({0, 0.003, 1.5}, {0, -0.003, -1.5}), 1U);
  EXPECT_EQ(taken({0, 0.003, 1.5}, {0, 0.003, 1.5}), 0U) << "the same";
  EXPECT_EQ(taken({0, 0.003, 1.5}, {0, -0.003, -1.4}), 0U) << "another force";
  EXPECT_EQ(taken({0, 0.003, 1.5}, {0, -0.003, 1.5}), 0U) << "into the surface";
  EXPECT_EQ(taken({0, 0.003, 1.5}, {0, -0.002, -1.5}), 0U) << "not on the surface";
  EXPECT_EQ(taken({1e-6, 0.003, 1.4995}, {1e-6, -0.003, -1.4995}), 0U) << "the farther side";
  EXPECT_EQ(taken({0, 0.003, 1.5}, {0, std::nan(""), std::nan("")}), 0U);
  // What is not of the answer stays to be compared.
  TrajectoryColumns expected = columns({{0, 0.003, 1.5}});
  TrajectoryColumns obtained = columns({{0, -0.003, -1.5}});
  obtained.columns[0].values[0] = 0.5;
  obtained.columns[10].values[0] = 0.0;
  EXPECT_EQ(take_equal_answers(*surface, tolerance, obtained, expected), 1U);
  EXPECT_EQ(expected.columns[0].values[0], 0.0);
  EXPECT_EQ(expected.columns[10].values[0], 1.0);
}

}  // namespace
}  // namespace touchstone::golden
