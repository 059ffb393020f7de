#include <cmath>
#include <numbers>

#include "recipe.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::datasets {
using synthetic::AnalyticSurface;
using synthetic::HeightField;
using synthetic::make_mesh;
using synthetic::ParameterOverrides;
using synthetic::RadialBody;
using synthetic::Tessellation;

namespace {

constexpr double half_side_m = 0.04;  // of the patches and blocks
constexpr double above_m = 0.010;     // of targets that are carried to the closest point of the surface

std::unique_ptr<const Guide> field_guide(const AnalyticSurface& surface) {
  return std::make_unique<HeightFieldGuide>(dynamic_cast<const HeightField&>(surface));
}
std::unique_ptr<const Guide> body_guide(const AnalyticSurface& surface) {
  return std::make_unique<RadialGuide>(dynamic_cast<const RadialBody&>(surface));
}
std::unique_ptr<const Guide> closest_guide(const AnalyticSurface& surface) {
  return std::make_unique<ClosestPointGuide>(surface);
}

// Two blocks side by side, each closed, whose tops are one plane: a wall of each stands inside of the body.
Tessellation flush_blocks() {
  Tessellation both;
  both.mesh.source = "two blocks of 40 mm x 40 mm x 10 mm, flush at x = 0";
  for (const double middle_m : {-0.5 * half_side_m, 0.5 * half_side_m}) {
    const Tessellation one = make_mesh("thin-shell", {{"thickness_m", 0.01}, {"half_side_m", 0.5 * half_side_m}}, 6000);
    const auto first = static_cast<std::int32_t>(both.mesh.vertices_W_m.size());
    for (const Vec3& v : one.mesh.vertices_W_m) both.mesh.vertices_W_m.push_back(v + Vec3(middle_m, 0.0, 0.0));
    for (const auto& t : one.mesh.triangles) both.mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return both;
}

// A table that goes to and fro by 20 mm and turns by 0.2 rad, slower than the hand.
Tracker::Pose swaying_table(double t_s) {
  return {Vec3(0.02 * std::sin(0.8 * t_s), 0.01 * std::sin(0.5 * t_s), 0.0),
          Quat(Eigen::AngleAxisd(0.2 * std::sin(0.6 * t_s), Vec3::UnitZ()))};
}

// A tap, five lines to and fro along x that step along y, a tap: over the middle of a patch and whatever stands there.
ScanScript raster_script(std::uint64_t seed) {
  Vec3 at(-0.020, -0.012, above_m);
  const Vec3 start = at;
  std::vector<Leg> legs{{Touch::free, 0.6, at}, {Touch::tap, 0.25, at}, {Touch::free, 0.6, at}};
  for (int line = 0; line < 5; ++line) {
    if (line > 0) legs.push_back({Touch::slide, 0.5, at += Vec3(0.0, 0.006, 0.0)});
    at.x() = -at.x();
    legs.push_back({Touch::slide, 3.0, at});
  }
  for (const Touch touch : {Touch::free, Touch::tap, Touch::free})
    legs.push_back({touch, touch == Touch::tap ? 0.25 : 0.6, at});
  return ScanScript(start, std::move(legs), HandModel{}, seed);
}

// Around a closed body: once about the equator and over the top; targets are directions.
ScanScript around_script(std::uint64_t seed) {
  const auto direction = [](double turn, double rise) {
    const double angle = 2.0 * std::numbers::pi * turn;
    return Vec3(std::cos(angle), std::sin(angle), rise).normalized();
  };
  const Vec3 start = direction(0.0, 0.3);
  std::vector<Leg> legs{{Touch::free, 0.6, start}, {Touch::tap, 0.25, start}, {Touch::free, 0.6, start}};
  for (int i = 1; i <= 8; ++i) legs.push_back({Touch::slide, 1.6, direction(0.125 * i, 0.3 + 0.2 * i)});
  const Vec3 end = direction(1.0, 1.9);
  for (const Touch touch : {Touch::free, Touch::tap, Touch::free})
    legs.push_back({touch, touch == Touch::tap ? 0.25 : 0.6, end});
  HandModel hand;
  hand.tremor = 1e-3;  // of a direction: an angle
  return ScanScript(start, std::move(legs), hand, seed);
}

Recipe family(std::string name, std::string object, std::string surface, ParameterOverrides parameters,
              decltype(Recipe::guide) guide, decltype(Recipe::script) script) {
  const bool closed = script == around_script;
  return {
      name,
      std::move(object),
      closed ? "a scan around the body with a tap before and after it" : "lines to and fro with a tap before and after",
      std::move(surface),
      std::move(parameters),
      12000,
      name + ".ply",
      "m",
      Contact{.tip_radius_m = 0.0015, .mu = 0.20},
      500.0,
      ForceSensor{},
      Tracker{},
      guide,
      script};
}

}  // namespace

namespace {

Recipe flush() {
  Recipe out = family("flush", "two rigid blocks, flush with one another", "thin-shell",
                      {{"thickness_m", 0.01}, {"half_side_m", half_side_m}}, closest_guide, raster_script);
  out.mesh = flush_blocks;
  return out;
}

Recipe moving() {
  Recipe out =
      family("moving", "a rigid plate with a smooth bump of 3 mm, which moves while it is scanned", "gauss",
             {{"amplitude_m", 0.003}, {"width_m", 0.008}, {"half_side_m", half_side_m}}, field_guide, raster_script);
  out.object_pose = swaying_table;
  out.motion =
      "x = 20 mm sin(0.8 t), y = 10 mm sin(0.5 t), turned about z by 0.2 rad sin(0.6 t); the tracker measured probe "
      "and "
      "object, and the recording is in the object's frame";
  return out;
}

}  // namespace

std::span<const Recipe> families() {
  static const std::vector<Recipe> all{
      family("bump-smooth", "a rigid plate with a smooth bump of 3 mm", "gauss",
             {{"amplitude_m", 0.003}, {"width_m", 0.008}, {"half_side_m", half_side_m}}, field_guide, raster_script),
      family("bump-round", "a rigid disc with a round bump of 3 mm and a slanted side", "bump",
             {{"height_m", 0.003}, {"edge_radius_m", 0.003}, {"half_side_m", half_side_m}}, closest_guide,
             raster_script),
      family("saddle", "a rigid saddle, radii of 50 mm", "saddle", {{"radius_m", 0.05}, {"half_side_m", half_side_m}},
             field_guide, raster_script),
      family("bumpy", "a rigid closed body with lobes, about 60 mm", "bumpy", {{"radius_m", 0.03}}, body_guide,
             around_script),
      family("crease", "a rigid roof with a convex crease of 0.5 rad", "crease",
             {{"bend_rad", 0.5}, {"half_side_m", half_side_m}}, closest_guide, raster_script),
      family("thin-shell", "a rigid sheet 1 mm thick", "thin-shell",
             {{"thickness_m", 0.001}, {"half_side_m", half_side_m}}, closest_guide, raster_script),
      flush(),
      moving(),
  };
  return all;
}

}  // namespace touchstone::datasets
