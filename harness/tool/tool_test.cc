#include "harness/tool/tool.h"

#include <gtest/gtest.h>

#include <limits>

#include "harness/base/error.h"
#include "harness/surface/box_mesh.h"
#include "harness/tool/tool_renderer.h"

namespace touchstone::tool {
using surface::TriangleMesh;

namespace {

TEST(MassFrame, OfABoxIsTheTextbooks) {
  const Vec3 low(0.01, -0.02, 0.03);
  const Vec3 size(0.02, 0.05, 0.08);
  constexpr double density = 7800.0;
  const MassFrame frame = solid_mass_frame(surface::box_mesh(low, low + size), density);
  const double mass = density * size.prod();
  EXPECT_NEAR(frame.mass_kg, mass, 1e-12 * mass);
  EXPECT_LE((frame.center_T_m - (low + 0.5 * size)).norm(), 1e-15);
  const Vec3 s2 = size.cwiseProduct(size);
  const Mat3 expected =
      Vec3(mass / 12.0 * (s2.y() + s2.z()), mass / 12.0 * (s2.x() + s2.z()), mass / 12.0 * (s2.x() + s2.y()))
          .asDiagonal();
  EXPECT_LE((frame.inertia_T_kg_m2 - expected).norm(), 1e-12 * expected.norm());
}

TEST(MassFrame, RefusesAMeshThatIsInsideOut) {
  TriangleMesh mesh = surface::box_mesh(Vec3::Zero(), Vec3::Ones());
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  EXPECT_THROW(static_cast<void>(solid_mass_frame(mesh, 1000.0)), BadData);
}

TEST(PointShell, KeepsCornersAndCoversTheSurface) {
  const TriangleMesh mesh = surface::box_mesh(Vec3::Zero(), Vec3(0.02, 0.02, 0.02));
  const PointShell shell = make_point_shell(mesh, 0.002);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(shell.p_T_m[i], mesh.vertices_W_m[i]);
  // 2400 mm^2 in cells of 4 mm^2: about 600.
  EXPECT_GT(shell.size(), 500U);
  EXPECT_LT(shell.size(), 900U);
  for (std::size_t i = 0; i < shell.size(); ++i) {
    EXPECT_NEAR(shell.inward_T[i].norm(), 1.0, 1e-12);
    const Vec3 inside = shell.p_T_m[i] + 1e-4 * shell.inward_T[i];
    EXPECT_LT((inside - Vec3::Constant(0.01)).norm(), (shell.p_T_m[i] - Vec3::Constant(0.01)).norm());
  }
  EXPECT_THROW(static_cast<void>(make_point_shell(mesh, 0.0)), UsageError);
}

// The eight corners of a box, an eighth of its mass each: the textbook's formula for points.
TEST(PointTool, MassFrameOfPoints) {
  PointShell shell;
  const TriangleMesh box = surface::box_mesh(Vec3(0.01, 0.0, 0.0), Vec3(0.03, 0.04, 0.06));
  for (const Vec3& v : box.vertices_W_m) {
    shell.p_T_m.push_back(v);
    shell.inward_T.push_back(Vec3::UnitZ());
  }
  const Tool tool = point_tool(shell, 0.4);
  EXPECT_EQ(tool.mass.mass_kg, 0.4);
  EXPECT_LE((tool.mass.center_T_m - Vec3(0.02, 0.02, 0.03)).norm(), 1e-15);
  const Vec3 half2(1e-4, 4e-4, 9e-4);
  const Mat3 expected =
      0.4 * Mat3(Vec3(half2.y() + half2.z(), half2.x() + half2.z(), half2.x() + half2.y()).asDiagonal());
  EXPECT_LE((tool.mass.inertia_T_kg_m2 - expected).norm(), 1e-15);
  EXPECT_EQ(shell_of(tool, 1.0).size(), 8U) << "its own, whatever the spacing";
  EXPECT_THROW(static_cast<void>(point_tool(shell, 0.0)), UsageError);
  for (std::size_t i = 0; i < 8; ++i) shell.p_T_m[i] = 0.001 * double(i) * Vec3(1, 2, 3);
  EXPECT_THROW(static_cast<void>(point_tool(shell, 0.4)), BadData) << "on a line";
}

class Echo : public ToolRenderer {
 protected:
  void do_reset() override {}
  ToolResult do_step(const ToolState& state, double dt_s) noexcept override {
    ToolResult result;
    result.f_W_N = Vec3(dt_s, state.handle.q_WT.norm(), 1.0);
    return result;
  }
};

TEST(ToolRenderer, RefusesWhatIsNoPose) {
  Echo echo;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(echo.step({0.0, {}}).status, ToolStatus::ok);
  EXPECT_EQ(echo.step({0.0, {}}).status, ToolStatus::refused) << "time stands still";
  EXPECT_EQ(echo.step({nan, {}}).status, ToolStatus::refused);
  EXPECT_EQ(echo.step({0.1, {Vec3(nan, 0, 0), Quat::Identity()}}).status, ToolStatus::refused);
  EXPECT_EQ(echo.step({0.1, {Vec3::Zero(), Quat(0.5, 0, 0, 0)}}).status, ToolStatus::refused) << "no rotation";
  const ToolResult result = echo.step({0.1, {Vec3::Zero(), Quat(1.0005, 0, 0, 0)}});
  EXPECT_EQ(result.status, ToolStatus::ok);
  EXPECT_DOUBLE_EQ(result.f_W_N.x(), 0.1) << "since the last step that was taken";
  EXPECT_DOUBLE_EQ(result.f_W_N.y(), 1.0) << "normalised";
  echo.reset();
  EXPECT_EQ(echo.step({0.0, {}}).status, ToolStatus::ok);
}

}  // namespace
}  // namespace touchstone::tool
