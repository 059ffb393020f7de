// The conformance suite of Surface over every analytic surface, scaled, turned and moved.
#include "harness/testing/surface_conformance.h"

#include <algorithm>

#include "synthetic/surface_catalogue.h"
#include "synthetic/surfaces/posed_surface.h"

namespace touchstone::synthetic {
using namespace touchstone::testing;  // the suite
namespace {

std::vector<testing::SurfaceCase> every_surface() {
  std::vector<testing::SurfaceCase> cases;
  for (const synthetic::SurfaceEntry& entry : synthetic::surface_catalogue()) {
    const auto make = [&entry](double scale, const Quat& rotation,
                               const Vec3& shift_m) -> std::shared_ptr<surface::Surface> {
      synthetic::ParameterOverrides overrides;
      for (const synthetic::Parameter& p : entry.parameters) {
        if (p.unit == "m") overrides[p.name] = p.initial * scale;
      }
      return std::make_shared<synthetic::PosedSurface>(synthetic::make_surface(entry.name, overrides), rotation,
                                                       shift_m);
    };
    std::string name = entry.name;
    std::replace(name.begin(), name.end(), '-', '_');
    testing::SurfaceTraits traits;
    // Only patches and blocks can be open. The bodies are not made here: it takes a tenth of a second in each of the
    // processes, one for each case.
    const bool has_side = std::any_of(entry.parameters.begin(), entry.parameters.end(),
                                      [](const auto& p) { return p.name == "half_side_m"; });
    traits.closed = !has_side || synthetic::make_surface(entry.name)->closed();
    traits.queries = 100;
    // Where the foot is searched for, its roundings add up; flat, round and sharp shapes have it in closed form.
    const bool searched = name == "saddle" || name == "gauss" || name == "texture" || name == "bumpy" || name == "duck";
    if (searched) traits.roundings = 16.0;
    cases.push_back({name, make, traits});
  }
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Synthetic, SurfaceConformance, ::testing::ValuesIn(every_surface()),
                         testing::surface_case_name);

}  // namespace
}  // namespace touchstone::synthetic
