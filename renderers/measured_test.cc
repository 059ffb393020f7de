#include "renderers/measured.h"

#include "harness/rendering/measured_renderer.h"
#include "harness/surface/embree_surface.h"
#include "renderers/catalogue.h"

namespace touchstone::renderers {
using rendering::Model;

namespace {

// A plate of 100 mm x 100 mm at z = 0, outward +z.
std::shared_ptr<const surface::Surface> plate() {
  surface::TriangleMesh mesh;
  mesh.vertices_W_m = {{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.1, 0}, {0, 0.1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return make_embree_surface(mesh);
}

Model spring(double stiffness_N_per_m) {
  Model model;
  model.renderer = "god-object";
  model.parameters["stiffness_N_per_m"] = stiffness_N_per_m;
  model.source = "test";
  return model;
}

TEST(MeasuredRenderer, InstrumentEntriesStayOutOfTheRenderer) {
  Model model = spring(500.0);
  model.instrument.push_back({"force-bias", {{"fx_N", 1.0}, {"fy_N", 0.0}, {"fz_N", 0.0}}, "/instrument/0"});
  const rendering::MeasuredRenderer comparison = make_measured_renderer(model, plate());
  const rendering::TipState tip{0.0, Vec3(0.05, 0.05, 0.01), Quat::Identity()};
  EXPECT_EQ(comparison.renderer().step(tip).f_W_N, Vec3(0, 0, 0));
  std::vector<double> t_s{0.0};
  std::vector<Vec3> p{tip.p_W_m}, f{Vec3::Zero()};
  std::vector<Quat> q{tip.q_WS};
  comparison.apply({t_s, p, q}, f);
  EXPECT_EQ(f[0], Vec3(1, 0, 0));
}

}  // namespace
}  // namespace touchstone::renderers
