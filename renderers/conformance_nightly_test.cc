// Every renderer of the catalogue on every surface of synthetic/, with Embree's queries and with the exact ones. The
// surfaces are brought to the size of the suite's own shapes; patches and blocks are touched from above, bodies all
// about. What a renderer declares that it cannot skips with its reason shown.
#include "harness/surface/cgal/exact_surface.h"
#include "renderers/conformance_subjects_for_test.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::renderers {
using namespace touchstone::testing;  // the suite
namespace {

std::string identifier(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

// Within a ball of 34 mm about the origin, or a patch of 40 mm.
testing::ConformanceBody body_of(const synthetic::SurfaceEntry& entry) {
  constexpr double reach_m = 0.034;
  synthetic::ParameterOverrides overrides;
  bool patch = false;
  for (const auto& p : entry.parameters) {
    if (p.name != "half_side_m") continue;
    patch = true;
    overrides["half_side_m"] = 0.02;
  }
  testing::ConformanceBody body;
  body.mesh = synthetic::make_mesh(entry.name, overrides, 1500).mesh;
  body.closed = synthetic::make_surface(entry.name, overrides)->closed();
  body.flat = patch;
  double scale = 1.0;
  if (!patch) {
    const Box3 box = body.mesh.bounds();
    double reach = 0.0;
    for (const Vec3& v : body.mesh.vertices_W_m) reach = std::max(reach, (v - box.center()).norm());
    scale = reach_m / reach;
    body.mesh = moved(body.mesh, Quat::Identity(), -scale * box.center(), scale);
  }
  for (const auto& p : entry.parameters) {
    if (p.name == "thickness_m") body.thickness_m = scale * p.initial;
  }
  return body;
}

std::vector<testing::ConformanceShape> synthetic_shapes() {
  std::vector<testing::ConformanceShape> shapes;
  for (const auto& entry : synthetic::surface_catalogue()) {
    shapes.push_back({"on_" + identifier(entry.name), [&entry] { return body_of(entry); }});
  }
  return shapes;
}

std::string model(const std::string& renderer, const std::string& parameters = "") {
  return R"({"schema": "touchstone-model/1", "renderer": ")" + renderer + R"(", "parameters": {)" + parameters + "}}";
}

// With the exact queries grids are coarse: each of their voxels costs one.
std::vector<RendererSubject> subjects(bool exact) {
  const std::string grid = exact ? R"("resolution": 16)" : R"("resolution": 28)";
  std::vector<RendererSubject> all;
  for (const rendering::RendererEntry& entry : renderer_catalogue()) {
    const bool gridded = entry.name.starts_with("voxel") || entry.name == "implicit";
    const double steepest = entry.name == "spring-quadratic" ? 200.0 : 500.0;
    RendererSubject subject =
        subject_of(identifier(entry.name) + (exact ? "_exact" : ""), model(entry.name, gridded ? grid : ""), steepest);
    if (entry.name == "implicit") subject.thinnest_m = 2.0 * 0.068 / (exact ? 9.0 : 21.0);
    if (exact) {
      subject.queries = surface::make_exact_surface;
      subject.queries_allocate = true;
    }
    all.push_back(std::move(subject));
  }
  return all;
}

std::vector<RendererSubject> exact_subjects() {
  return surface::exact_surface_available() ? subjects(true) : std::vector<RendererSubject>{};
}

INSTANTIATE_TEST_SUITE_P(Synthetic, RendererConformance,
                         ::testing::Combine(::testing::ValuesIn(testing::shared(subjects(false))),
                                            ::testing::ValuesIn(synthetic_shapes())),
                         testing::conformance_name);
INSTANTIATE_TEST_SUITE_P(SyntheticExact, RendererConformance,
                         ::testing::Combine(::testing::ValuesIn(testing::shared(exact_subjects())),
                                            ::testing::ValuesIn(synthetic_shapes())),
                         testing::conformance_name);

}  // namespace
}  // namespace touchstone::renderers
