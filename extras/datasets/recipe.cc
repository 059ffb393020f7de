#include "recipe.h"

#include <fmt/format.h>

#include "harness/base/error.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::datasets {
using synthetic::AnalyticSurface;
using synthetic::HeightField;
using synthetic::make_surface;
using synthetic::RadialBody;

namespace {

std::unique_ptr<const Guide> height_field_guide(const AnalyticSurface& surface) {
  return std::make_unique<HeightFieldGuide>(dynamic_cast<const HeightField&>(surface));
}
std::unique_ptr<const Guide> radial_guide(const AnalyticSurface& surface) {
  return std::make_unique<RadialGuide>(dynamic_cast<const RadialBody&>(surface));
}

// Two taps at one place, from a hover to a hover.
void add_taps(std::vector<Leg>& legs, const Vec3& at) {
  legs.push_back({Touch::tap, 0.25, at});
  legs.push_back({Touch::free, 0.35, at});
  legs.push_back({Touch::tap, 0.25, at});
}

// Figure 2 of the paper: to and fro along y, with taps before and after.
ScanScript plane_script(std::uint64_t seed) {
  const Vec3 start(-0.012, -0.035, 0.0);
  std::vector<Leg> legs{{Touch::free, 0.9, start}};
  add_taps(legs, start);
  legs.push_back({Touch::free, 0.6, start});
  Vec3 at = start;
  for (int line = 0; line < 7; ++line) {
    if (line > 0) legs.push_back({Touch::slide, 0.4, at += Vec3(0.004, 0.0, 0.0)});
    at.y() = -at.y();
    legs.push_back({Touch::slide, line % 2 == 0 ? 1.6 : 2.0, at});
  }
  legs.push_back({Touch::free, 0.6, at});
  add_taps(legs, at);
  legs.push_back({Touch::free, 0.9, at});
  return ScanScript(start, std::move(legs), HandModel{}, seed);
}

// Over the back, around both sides, the head and the tail; targets are directions from the body's middle.
ScanScript duck_script(std::uint64_t seed) {
  const std::vector<Vec3> way{{-0.50, 0.00, 0.85},  {-0.35, 0.60, 0.65}, {0.35, 0.80, 0.40},  {0.75, 0.45, 0.45},
                              {0.55, 0.00, 0.84},   {0.75, -0.40, 0.45}, {0.20, -0.85, 0.35}, {-0.55, -0.60, 0.50},
                              {-0.92, -0.05, 0.40}, {-0.60, 0.10, 0.80}, {0.05, 0.00, 1.00},  {0.55, 0.10, 0.80},
                              {-0.45, -0.15, 0.85}};
  std::vector<Leg> legs{{Touch::free, 0.9, way.front()}};
  add_taps(legs, way.front());
  legs.push_back({Touch::free, 0.6, way.front()});
  for (std::size_t i = 1; i < way.size(); ++i) legs.push_back({Touch::slide, 1.9, way[i].normalized()});
  legs.push_back({Touch::free, 0.6, way.back().normalized()});
  add_taps(legs, way.back().normalized());
  legs.push_back({Touch::free, 0.9, way.back().normalized()});
  HandModel hand;
  // Directions tremble by angles: as much on the surface, about 50 mm out.
  hand.tremor = 1e-3;
  return ScanScript(way.front().normalized(), std::move(legs), hand, seed);
}

}  // namespace

std::span<const Recipe> recipes() {
  static const std::vector<Recipe> all{
      {"plane",
       "a rigid flat plate, 120 mm x 120 mm, its surface at z = 0",
       "a scan mainly along y with two taps before and after it, as in figure 2 of Ruffaldi et al. 2006",
       "plane",
       {{"half_side_m", 0.06}},
       2048,
       "plane.obj",
       "mm",
       Contact{.tip_radius_m = 0.0015, .mu = 0.20},
       500.0,
       ForceSensor{},
       Tracker{},
       height_field_guide,
       plane_script},
      {"duck",
       "a rigid, smooth, closed body like a bath duck, 114 mm from tail to bill",
       "a scan over back, sides, head and tail with two taps before and after it",
       "duck",
       {{"length_m", 0.1}},
       16820,
       "duck.ply",
       "m",
       Contact{.tip_radius_m = 0.0015, .mu = 0.25},
       500.0,
       ForceSensor{},
       Tracker{},
       radial_guide,
       duck_script},
  };
  return all;
}

const Recipe& recipe(std::string_view name) {
  std::string known;
  for (const auto& list : {recipes(), families()}) {
    for (const Recipe& r : list) {
      if (r.name == name) return r;
      known += (known.empty() ? "" : ", ") + r.name;
    }
  }
  throw UsageError(fmt::format("no data set is called '{}'; there are: {}", name, known));
}

RigidScan make_scan(const Recipe& recipe, std::uint64_t seed) {
  struct Kept {
    std::unique_ptr<const AnalyticSurface> surface;
    std::unique_ptr<const Guide> guide;
  };
  const auto kept = std::make_shared<Kept>();
  kept->surface = make_surface(recipe.surface, recipe.parameters);
  kept->guide = recipe.guide(*kept->surface);
  return RigidScan(std::shared_ptr<const Guide>(kept, kept->guide.get()), recipe.script(seed), recipe.contact);
}

}  // namespace touchstone::datasets
