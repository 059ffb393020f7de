#include "synthetic/surface_catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/base/error.h"
#include "synthetic/surfaces/extrusion.h"
#include "synthetic/surfaces/height_fields.h"
#include "synthetic/surfaces/radial_bodies.h"
#include "synthetic/surfaces/revolution.h"
#include "synthetic/surfaces/sliver_patch.h"
#include "synthetic/surfaces/sphere.h"

namespace touchstone::synthetic {
namespace {

constexpr double pi = std::numbers::pi;
using Made = std::unique_ptr<AnalyticSurface>;

Parameter length(std::string name, double initial, std::string meaning) {
  return {std::move(name), "m", 1e-9, 1e6, initial, std::move(meaning)};
}
Parameter radius_or_none(std::string name, std::string meaning) {
  return {std::move(name), "m", 0.0, 1e6, 0.0, std::move(meaning)};
}
Parameter angle(std::string name, double minimum, double maximum, double initial, std::string meaning) {
  return {std::move(name), "rad", minimum, maximum, initial, std::move(meaning)};
}
Parameter half_side() { return length("half_side_m", 0.05, "half the side of the square patch or block"); }
Parameter edge_radius() {
  return radius_or_none("edge_radius_m", "of every edge along the shape; 0: sharp, the mesh is exact");
}

Made plane(const ParameterValues& v) { return std::make_unique<Plane>(v["half_side_m"]); }
Made saddle(const ParameterValues& v) { return std::make_unique<Saddle>(v["radius_m"], v["half_side_m"]); }
Made gauss(const ParameterValues& v) {
  return std::make_unique<GaussianBump>(v["amplitude_m"], v["width_m"], v["half_side_m"]);
}
Made texture(const ParameterValues& v) {
  return std::make_unique<Sinusoid>(v["amplitude_m"], v["wavelength_m"], v["half_side_m"]);
}
Made slivers(const ParameterValues& v) {
  if (v["smallest_m"] >= v["half_side_m"]) v.refuse("smallest_m must be less than half_side_m");
  return std::make_unique<SliverPatch>(v["half_side_m"], v["smallest_m"], v["aspect"]);
}
Made sphere(const ParameterValues& v) { return std::make_unique<Sphere>(v["radius_m"]); }

Made cylinder(const ParameterValues& v) {
  const double h = 0.5 * v["height_m"];
  const double r = v["radius_m"];
  const double edge = v["edge_radius_m"];
  return std::make_unique<Revolution>(Profile::through({{{0, -h}}, {{r, -h}, edge}, {{r, h}, edge}, {{0, h}}}, false));
}
Made torus(const ParameterValues& v) {
  if (v["tube_radius_m"] >= v["ring_radius_m"]) v.refuse("tube_radius_m must be less than ring_radius_m");
  return std::make_unique<Revolution>(
      Profile({profile_arc({v["ring_radius_m"], 0.0}, v["tube_radius_m"], 0.0, 2.0 * pi)}, true));
}
Made bump(const ParameterValues& v) {
  const double edge = v["edge_radius_m"];
  const double side = v["half_side_m"];
  const double foot = v["top_radius_m"] + v["height_m"] / std::tan(v["side_angle_rad"]);
  if (foot >= side) v.refuse("the bump's foot does not fit on its base: half_side_m is too small or the side too flat");
  const double floor = -0.5 * side;
  return std::make_unique<Revolution>(Profile::through({{{0, floor}},
                                                        {{side, floor}},
                                                        {{side, 0}},
                                                        {{foot, 0}, edge},
                                                        {{v["top_radius_m"], v["height_m"]}, edge},
                                                        {{0, v["height_m"]}}},
                                                       false));
}
Made bowl(const ParameterValues& v) {
  const double outer = v["radius_m"];
  const double inner = outer - v["thickness_m"];
  if (inner <= 0.0) v.refuse("thickness_m must be less than radius_m");
  ProfileElement outside = profile_arc({0, 0}, outer, -0.5 * pi, 0.5 * pi);
  ProfileElement inside = profile_arc({0, 0}, inner, 0.0, -0.5 * pi);
  outside.start.x() = 0.0;
  outside.end = {outer, 0.0};
  inside.end.x() = 0.0;
  return std::make_unique<Revolution>(Profile({outside, profile_line(outside.end, inside.start), inside}, false));
}

Made block(const std::vector<Corner>& top, const ParameterValues& v) {
  double lowest = top.front().p.y();
  for (const Corner& corner : top) lowest = std::min(lowest, corner.p.y());
  return std::make_unique<Extrusion>(top, lowest - 0.5 * v["half_side_m"], v["half_side_m"]);
}
Made ridge(const ParameterValues& v) {
  const double side = v["half_side_m"];
  const double top = 0.5 * v["top_width_m"];
  const double h = v["height_m"];
  const double foot = top + h / std::tan(v["side_angle_rad"]);
  if (foot >= side)
    v.refuse("the extrusion's foot does not fit on its block: half_side_m is too small or the side too flat");
  const double edge = v["edge_radius_m"];
  return block({{{side, 0}}, {{foot, 0}, edge}, {{top, h}, edge}, {{-top, h}, edge}, {{-foot, 0}, edge}, {{-side, 0}}},
               v);
}
Made step(const ParameterValues& v) {
  const double side = v["half_side_m"];
  // An upright riser stands at x = 0 exactly.
  const double run = v["riser_angle_rad"] < 0.5 * pi ? 0.5 * v["height_m"] / std::tan(v["riser_angle_rad"]) : 0.0;
  if (run >= side) v.refuse("the riser is too flat for the block: its run exceeds half_side_m");
  const double edge = v["edge_radius_m"];
  return block({{{side, 0}}, {{run, 0}, edge}, {{-run, v["height_m"]}, edge}, {{-side, v["height_m"]}}}, v);
}
Made wedge(const ParameterValues& v) {
  const double side = v["half_side_m"];
  const double drop = side / std::tan(0.5 * v["opening_rad"]);
  return block({{{side, -drop}}, {{0, 0}, v["edge_radius_m"]}, {{-side, -drop}}}, v);
}
Made v_groove(const ParameterValues& v) {
  const double side = v["half_side_m"];
  const double half = v["depth_m"] * std::tan(0.5 * v["opening_rad"]);
  if (half >= side) v.refuse("the groove is wider than its block: half_side_m is too small");
  const double edge = v["edge_radius_m"];
  return block({{{side, 0}}, {{half, 0}, edge}, {{0, -v["depth_m"]}, edge}, {{-half, 0}, edge}, {{-side, 0}}}, v);
}
Made crease(const ParameterValues& v) {
  const double side = v["half_side_m"];
  const double fall = side * std::tan(0.5 * v["bend_rad"]);
  return block({{{side, -fall}}, {{0, 0}}, {{-side, -fall}}}, v);
}
Made thin_shell(const ParameterValues& v) {
  const double side = v["half_side_m"];
  return std::make_unique<Extrusion>(std::vector<Corner>{{{side, 0}}, {{-side, 0}}}, -v["thickness_m"], side);
}
Made gap(const ParameterValues& v) {
  const double side = v["half_side_m"];
  const double half = 0.5 * v["width_m"];
  if (half >= side) v.refuse("the gap is wider than its block: half_side_m is too small");
  const double d = -v["depth_m"];
  return block({{{side, 0}}, {{half, 0}}, {{half, d}}, {{-half, d}}, {{-half, 0}}, {{-side, 0}}}, v);
}
Made bumpy(const ParameterValues& v) { return bumpy_body(v["radius_m"]); }
Made duck(const ParameterValues& v) { return duck_body(0.5 * v["length_m"]); }

}  // namespace

std::span<const SurfaceEntry> surface_catalogue() {
  const double right = 0.5 * pi;
  static const std::vector<SurfaceEntry> entries{
      {"plane", "flat open patch z = 0, single-sided", {half_side()}, plane},
      {"saddle",
       "open patch z = (x^2 - y^2) / (2 R)",
       {length("radius_m", 0.05, "R, both principal radii at the middle"), half_side()},
       saddle},
      {"gauss",
       "open patch z = A exp(-(x^2 + y^2) / (2 s^2))",
       {length("amplitude_m", 0.002, "A"), length("width_m", 0.004, "s"), half_side()},
       gauss},
      {"texture",
       "open patch z = A sin(2 pi x / wavelength)",
       {length("amplitude_m", 1e-4, "A"), length("wavelength_m", 0.002, "along x"), half_side()},
       texture},
      {"slivers",
       "flat open patch z = 0 in nested slivers and tiny triangles",
       {half_side(),
        length("smallest_m", 1e-6, "side of the innermost square"),
        {"aspect", "1", 4.0, 1e9, 1e6, "length over width of the slivers"}},
       slivers},
      {"sphere", "ball about the origin, triangles of nearly equal size", {length("radius_m", 0.03, "radius")}, sphere},
      {"cylinder",
       "upright closed cylinder about z",
       {length("radius_m", 0.02, "radius"), length("height_m", 0.05, "height"), edge_radius()},
       cylinder},
      {"torus",
       "ring about z",
       {length("ring_radius_m", 0.03, "from the axis to the middle of the tube"),
        length("tube_radius_m", 0.01, "of the tube")},
       torus},
      {"bump",
       "round bump with slanted side on a disc-shaped base",
       {length("height_m", 0.003, "above the base"), length("top_radius_m", 0.005, "of the flat top"),
        angle("side_angle_rad", 1e-3, right, 1.0, "of the side against the base: sharpness"), edge_radius(),
        half_side()},
       bump},
      {"extrusion",
       "ridge along y with slanted sides on a block (figure 8 of Ruffaldi et al. 2006)",
       {length("height_m", 0.003, "above the block"), length("top_width_m", 0.008, "of the flat top"),
        angle("side_angle_rad", 1e-3, right, 1.0, "of the sides against the block: sharpness"), edge_radius(),
        half_side()},
       ridge},
      {"step",
       "step along y, high for x < 0",
       {length("height_m", 0.002, "of the riser"), angle("riser_angle_rad", 1e-3, right, right, "against the floor"),
        edge_radius(), half_side()},
       step},
      {"wedge",
       "roof along y, its edge at the origin",
       {angle("opening_rad", 0.05, 3.1, right, "between the two faces, inside the solid"), edge_radius(), half_side()},
       wedge},
      {"v-groove",
       "groove along y in a block",
       {angle("opening_rad", 0.05, 3.1, right, "between the two walls, outside the solid"),
        length("depth_m", 0.005, "of the groove"), edge_radius(), half_side()},
       v_groove},
      {"crease",
       "two nearly flat faces meeting along y",
       {angle("bend_rad", -3.0, 3.0, 1e-6, "between the faces' normals; positive convex, negative concave"),
        half_side()},
       crease},
      {"thin-shell",
       "flat plate, double-sided and closed, its upper side at z = 0",
       {length("thickness_m", 0.001, "2 mm to 0.05 mm are the hard ones"), half_side()},
       thin_shell},
      {"bowl",
       "half a hollow ball, open above: a curved double-sided shell",
       {length("radius_m", 0.03, "outside"), length("thickness_m", 0.001, "of the wall")},
       bowl},
      {"gap",
       "slot along y with upright walls in a block",
       {length("width_m", 0.001, "between the walls"), length("depth_m", 0.005, "of the slot"), half_side()},
       gap},
      {"bumpy",
       "r = R (1 + 0.30 x y + 0.08 sin(3x+1) cos(2z) + 0.05 sin(5y)) over unit directions",
       {length("radius_m", 0.03, "R")},
       bumpy},
      {"duck",
       "smooth bath-duck-like body: ellipsoid with head, bill and tail",
       {length("length_m", 0.1, "of the body")},
       duck},
  };
  return entries;
}

namespace {

const SurfaceEntry& find(std::string_view name) {
  std::string known;
  for (const SurfaceEntry& entry : surface_catalogue()) {
    if (entry.name == name) return entry;
    known += (known.empty() ? "" : ", ") + entry.name;
  }
  throw UsageError(fmt::format("no surface is called '{}'; there are: {}", name, known));
}

}  // namespace

std::unique_ptr<AnalyticSurface> make_surface(std::string_view name, const ParameterOverrides& overrides) {
  const SurfaceEntry& entry = find(name);
  return entry.make(ParameterValues("surface " + entry.name, entry.parameters, overrides));
}

Tessellation make_mesh(std::string_view name, const ParameterOverrides& overrides, std::size_t triangles) {
  constexpr std::size_t most = 20'000'000;
  if (triangles == 0 || triangles > most) {
    throw UsageError(fmt::format("a mesh of {} triangles is asked for; 1 to {} can be made", triangles, most));
  }
  const SurfaceEntry& entry = find(name);
  const ParameterValues values("surface " + entry.name, entry.parameters, overrides);
  Tessellation result = entry.make(values)->tessellate(triangles);
  result.mesh.source = "synthetic " + entry.name;
  for (const Parameter& p : entry.parameters) result.mesh.source += fmt::format(" {}={}", p.name, values[p.name]);
  return result;
}

}  // namespace touchstone::synthetic
