// Renderers of tools against exact answers, a slow exact twin and invariances.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "contacts/exact_cases.h"
#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/base/units.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_file.h"
#include "harness/testing/allocation_guard.h"
#include "harness/tool/faulty_tool.h"
#include "harness/tool/tool_checks.h"
#include "harness/tool/tool_path.h"
#include "tool_renderers/god_object_tool.h"
#include "tool_renderers/tool_catalogue.h"
#include "tool_renderers/voxmap.h"

namespace touchstone::tool_renderers {
using surface::TriangleMesh;
using tool::Coupling;
using tool::Pose;
using tool::Tool;
using tool::tool_fault_names;
using tool::ToolFinding;
using tool::ToolRendererEntry;
using tool::ToolResult;
using tool::ToolSettings;
using tool::ToolSubject;

namespace {

using contacts::Equilibrium;
using contacts::ExactCase;
using contacts::make_exact_case;

constexpr double material_density_kg_per_m3 = 1000.0;

Tool tool_of(const TriangleMesh& mesh) { return {mesh, tool::solid_mass_frame(mesh, material_density_kg_per_m3)}; }

struct Errors {
  double force_N = 0.0;
  double torque_Nm = 0.0;
};

Errors largest_errors(const std::string& renderer_name, const ExactCase& c) {
  const ToolSettings settings;
  const auto renderer = make_tool_renderer(renderer_name, tool_of(c.tool_T), c.object_W, settings);
  Errors errors;
  for (const Pose& handle : c.handles) {
    const Equilibrium truth = quasi_static_equilibrium(c.gaps, handle, settings.coupling);
    const ToolResult result = settle(*renderer, c.free, handle);
    errors.force_N = std::max(errors.force_N, (result.f_W_N - truth.wrench_W.f_N).norm());
    errors.torque_Nm = std::max(errors.torque_Nm, (result.torque_W_Nm - truth.wrench_W.torque_Nm).norm());
  }
  return errors;
}

TEST(GodObjectTool, IsExactWhereTheMeshIs) {
  for (const char* name : {"box-face", "box-edge", "box-corner", "peg-0.5mm", "peg-0.2mm", "peg-0.1mm", "peg-0.05mm"}) {
    const Errors errors = largest_errors("god-object-tool", make_exact_case(name));
    EXPECT_LE(errors.force_N, 1e-9) << name;
    EXPECT_LE(errors.torque_Nm, 1e-9) << name;
  }
}

TEST(GodObjectTool, ErrsByItsMeshOnCurvedBodies) {
  // A facet of longest edge L on a curve of radius R lies below it by at most L^2 / (6 R) (the circumradius of an
  // equilateral one is L / sqrt 3) and leans by L / (sqrt 3 R).
  struct Curved {
    const char* name;
    double tool_radius_m, object_radius_m;  // the smallest radius of curvature; 0: flat
  };
  // The ellipsoid's smallest radius is c^2 / a = 3 mm at its tip.
  for (const Curved& c : {Curved{"sphere-plane", 0.01, 0.0}, Curved{"sphere-sphere", 0.01, 0.03},
                          Curved{"ellipsoid-plane", 0.003, 0.0}, Curved{"two-spheres", 0.005, 0.0}}) {
    const ExactCase made = make_exact_case(c.name);
    double sag = 0.0;
    double lean = 0.0;
    for (const auto& [mesh, radius] :
         {std::pair{&made.tool_T, c.tool_radius_m}, std::pair{&made.object_W, c.object_radius_m}}) {
      if (radius == 0.0) continue;
      // Of the round parts: the bar between the balls has long edges and never touches.
      std::vector<double> edges;
      for (const auto& t : mesh->triangles)
        edges.push_back((mesh->vertices_W_m[surface::at(t[0])] - mesh->vertices_W_m[surface::at(t[1])]).norm());
      std::ranges::sort(edges);
      const double edge = edges[edges.size() * 99 / 100];
      sag += edge * edge / (6.0 * radius);
      lean += edge / (std::sqrt(3.0) * radius);
    }
    const double force = 4.0;  // N: what the cases press with at most
    const Coupling coupling;
    const double force_limit = coupling.stiffness_N_per_m * sag + (c.object_radius_m > 0.0 ? force * lean : 0.0);
    const Errors errors = largest_errors("god-object-tool", made);
    EXPECT_LE(errors.force_N, force_limit) << c.name;
    // The lever is 20 mm at most, and a contact moves over the facet that it is on.
    EXPECT_LE(errors.torque_Nm, 0.02 * force_limit + force * 0.01 * lean) << c.name;
  }
}

TEST(GodObjectTool, ProxyIsOutsideAtRestAndIsPushedOutOnTheWay) {
  const ExactCase c = make_exact_case("peg-0.2mm");
  const auto renderer = make_tool_renderer("god-object-tool", tool_of(c.tool_T), c.object_W, {});
  const auto surface = make_embree_surface(c.object_W);
  Random random(71);
  double deepest = 0.0;
  Pose from = c.free;
  int step = 0;
  for (int leg = 0; leg < 40; ++leg) {
    const Pose to = moved(c.free, {4e-3 * random.direction() + Vec3(0, 0, random.uniform(0.0, 0.03)),
                                   random.uniform(0.0, 0.3) * random.direction()});
    for (int i = 0; i < 60; ++i) {
      const ToolResult result = renderer->step({1e-3 * step++, between(from, to, i / 60.0)});
      for (const Vec3& v : c.tool_T.vertices_W_m)
        deepest = std::max(deepest, -surface->signed_distance(result.proxy.to_W(v)));
    }
    from = to;
    ToolResult rest;
    for (int i = 0; i < 100; ++i) rest = renderer->step({1e-3 * step++, to});
    for (const Vec3& v : c.tool_T.vertices_W_m) EXPECT_LE(-surface->signed_distance(rest.proxy.to_W(v)), 1e-9);
  }
  // What is pushed out again: a deeper overlap would be mistaken for another side of the body.
  EXPECT_LE(deepest, 0.2e-3);
}

// What is kept from one question to the next changes no answer: small steps, leaps, and margins that grow.
TEST(NearPairFinder, AnswersAsOneThatWasAskedNothingBefore) {
  const FeatureMesh tool(contacts::ellipsoid_mesh(Vec3(0, 0, -0.03), Vec3(0.02, 0.018, 0.016), 2000));
  const FeatureMesh object(contacts::box_mesh(Vec3(-0.04, -0.04, -0.02), Vec3(0.04, 0.04, 0.0), 9));
  NearPairFinder kept(tool, object);
  Random random(74);
  std::array<NearPair, 64> found, fresh;
  Pose pose{Vec3(0, 0, 0.046), Quat::Identity()};
  std::size_t pairs = 0;
  for (int i = 0; i < 400; ++i) {
    const double way_m = i % 40 == 0 ? 2e-3 : 0.03e-3;
    pose = moved(pose, {way_m * random.direction(), way_m / 0.05 * random.direction()});
    pose.p_W_m.z() = std::clamp(pose.p_W_m.z(), 0.0455, 0.0465);
    const double margin_m = random.uniform(0.02e-3, 0.5e-3);
    const std::size_t count = kept.find(pose, margin_m, 0.2e-3, found);
    ASSERT_EQ(NearPairFinder(tool, object).find(pose, margin_m, 0.2e-3, fresh), count);
    for (std::size_t k = 0; k < count; ++k) {
      EXPECT_EQ(found[k].gap_m, fresh[k].gap_m);
      EXPECT_EQ(found[k].n_W, fresh[k].n_W);
      EXPECT_EQ(found[k].at_W_m, fresh[k].at_W_m);
    }
    pairs += count;
  }
  EXPECT_GT(pairs, 1000U);
}

// Steps of micrometres, as of a hand in contact: the same pairs to the bit as without what stays awake. Fine facets on
// fine ones, a cube over large triangles (whose corners move against the tool by more than its own points do), and the
// same in millimetres.
TEST(NearPairFinder, AnswersTheSameWhileFeaturesStayAwake) {
  const TriangleMesh ball = contacts::ellipsoid_mesh(Vec3(0, 0, -0.03), Vec3(0.02, 0.018, 0.016), 6000);
  const TriangleMesh cube = contacts::box_mesh(Vec3(-0.01, -0.01, -0.03), Vec3(0.01, 0.01, -0.01), 3);
  const TriangleMesh slab = contacts::box_mesh(Vec3(-0.5, -0.5, -0.02), Vec3(0.5, 0.5, 0.0));
  const TriangleMesh dome = contacts::ellipsoid_mesh(Vec3(0, 0, -0.05), Vec3::Constant(0.05), 6000);
  const TriangleMesh groove = contacts::groove_mesh(0.012, 0.25 * std::numbers::pi, 0.04);
  const TriangleMesh cylinder = contacts::cylinder_mesh(Vec3(0, 0, -0.015), 0.008, 0.03, 90);
  struct Scene {
    const TriangleMesh& tool;
    const TriangleMesh& object;
    double height_m;
    double unit_m;
  };
  Random random(76);
  std::array<NearPair, 256> found, fresh;
  std::size_t pairs = 0;
  for (const Scene& scene : {Scene{ball, dome, 0.046, 1.0},
                             {ball, slab, 0.046, 1.0},
                             {cube, slab, 0.03, 1.0},
                             {cube, dome, 0.03, 1.0},
                             {cylinder, groove, 0.0143, 1.0},
                             {ball, dome, 0.046, 1e-3}}) {
    const auto in_unit = [&](TriangleMesh mesh) {
      for (Vec3& v : mesh.vertices_W_m) v /= scene.unit_m;
      return mesh;
    };
    const FeatureMesh tool(in_unit(scene.tool));
    const FeatureMesh object(in_unit(scene.object));
    NearPairFinder kept(tool, object, scene.unit_m);
    Pose pose{Vec3(0, 0, scene.height_m), tool::rotation_by(0.3 * Vec3(0, 0, random.normal()))};
    for (int i = 0; i < 300; ++i) {
      // Now and then as far as features may stay awake, or far beyond.
      const double way_m = i % 50 == 49 ? 60e-6 : random.uniform(0.2e-6, i % 3 == 0 ? 9e-6 : 3e-6);
      pose = moved(pose, {way_m * random.direction(), way_m / 0.05 * random.direction()});
      pose.p_W_m.z() = std::clamp(pose.p_W_m.z(), scene.height_m - 0.15e-3, scene.height_m + 0.05e-3);
      const double margin_m = i % 7 == 0 ? random.uniform(20e-6, 90e-6) : 20e-6;
      const double unit_m = scene.unit_m;
      const Pose there{pose.p_W_m / unit_m, pose.q_WT};
      const std::size_t count = kept.find(there, margin_m / unit_m, 0.2e-3 / unit_m, found);
      ASSERT_EQ(NearPairFinder(tool, object, unit_m).find(there, margin_m / unit_m, 0.2e-3 / unit_m, fresh), count);
      for (std::size_t k = 0; k < count; ++k) {
        EXPECT_EQ(found[k].gap_m, fresh[k].gap_m);
        EXPECT_EQ(found[k].n_W, fresh[k].n_W);
        EXPECT_EQ(found[k].at_W_m, fresh[k].at_W_m);
      }
      pairs += count;
    }
  }
  EXPECT_GT(pairs, 5000U);
}

// Units so small that the spare way holds every pair of triangles: more than are kept.
TEST(NearPairFinder, MorePairsThanAreKeptAreAskedPartByPart) {
  const FeatureMesh tool(contacts::ellipsoid_mesh(Vec3(0, 0, -0.03), Vec3(0.02, 0.018, 0.016), 2000));
  const FeatureMesh object(contacts::box_mesh(Vec3(-0.04, -0.04, -0.02), Vec3(0.04, 0.04, 0.0), 9));
  constexpr double millimetre_m = 1e-3;
  NearPairFinder kept(tool, object, millimetre_m);
  Random random(75);
  std::array<NearPair, 64> found, fresh;
  Pose pose{Vec3(0, 0, 0.046), Quat::Identity()};
  std::size_t pairs = 0;
  for (int i = 0; i < 4; ++i) {
    pose = moved(pose, {0.03e-3 * random.direction(), 1e-3 * random.direction()});
    pose.p_W_m.z() = std::clamp(pose.p_W_m.z(), 0.0455, 0.0465);
    const std::size_t count = kept.find(pose, 0.3e-3, 0.2e-3, found);
    ASSERT_EQ(NearPairFinder(tool, object, millimetre_m).find(pose, 0.3e-3, 0.2e-3, fresh), count);
    for (std::size_t k = 0; k < count; ++k) EXPECT_EQ(found[k].gap_m, fresh[k].gap_m);
    pairs += count;
  }
  EXPECT_GT(pairs, 4U);
}

TEST(Voxmap, LayersOfABox) {
  const TriangleMesh box = contacts::box_mesh(Vec3::Zero(), Vec3(0.01, 0.02, 0.03));
  const auto surface = make_embree_surface(box);
  const Voxmap map(*surface, 0.5e-3);
  Random random(72);
  for (int i = 0; i < 5000; ++i) {
    const Vec3 p(random.uniform(-0.003, 0.013), random.uniform(-0.003, 0.023), random.uniform(-0.003, 0.033));
    const Voxmap::Place place = map.at_point(p);
    if (place.layer == Voxmap::free_voxel) {
      EXPECT_GT(surface->signed_distance(p), -0.5e-3 * std::numbers::sqrt3) << "free points lie outside, to a voxel";
      continue;
    }
    EXPECT_LE((place.center_W_m - p).cwiseAbs().maxCoeff(), 0.25e-3 + 1e-12);
    const double depth = -surface->signed_distance(place.center_W_m);
    const int layer =
        std::min(static_cast<int>(std::floor(depth / 0.5e-3 + 0.5)) + 1, static_cast<int>(Voxmap::deepest_layer));
    EXPECT_EQ(static_cast<int>(place.layer), layer);
  }
}

TEST(LeastConstraint, SolutionsSatisfyTheConditionsOfOptimality) {
  Random random(73);
  for (int trial = 0; trial < 3000; ++trial) {
    std::vector<HalfSpace6> half_spaces(random.below(40));
    for (HalfSpace6& h : half_spaces) {
      for (int k = 0; k < 6; ++k) h.a[k] = random.normal();
      h.b = -random.uniform(0.0, 1.0);  // 0 is feasible
    }
    Vec6 u;
    for (int k = 0; k < 6; ++k) u[k] = 3.0 * random.normal();
    const LeastConstraint found = least_constraint(half_spaces, u, 1e-12);
    ASSERT_TRUE(found.found);
    Vec6 y = u;
    for (int k = 0; k < found.active_count; ++k) {
      const HalfSpace6& h = half_spaces[std::size_t(found.active[std::size_t(k)])];
      EXPECT_GE(found.multiplier[std::size_t(k)], 0.0);
      EXPECT_NEAR(h.a.dot(found.y), h.b, 1e-9);
      y += found.multiplier[std::size_t(k)] * h.a;
    }
    EXPECT_LE((y - found.y).norm(), 1e-8);
    for (const HalfSpace6& h : half_spaces) EXPECT_GE(h.a.dot(found.y), h.b - 1e-9);
  }
}

TEST(LeastConstraint, ContradictionIsSaid) {
  std::vector<HalfSpace6> half_spaces(2);
  half_spaces[0] = {Vec6::Unit(0), 1.0};
  half_spaces[1] = {-Vec6::Unit(0), 0.0};
  EXPECT_FALSE(least_constraint(half_spaces, Vec6::Zero(), 1e-12).found);
}

std::vector<std::string> faults_named(const ToolSubject& subject) {
  std::vector<std::string> named;
  for (const ToolFinding& finding : check_tool_renderer(subject)) {
    if (!finding.fault.empty()) named.push_back(finding.fault);
  }
  return named;
}

class EveryToolRenderer : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryToolRenderer, PassesTheChecks) {
  for (const ToolFinding& finding :
       check_tool_renderer(subject_of(find_tool_renderer(tool_renderer_catalogue(), GetParam()), {}))) {
    if (!finding.applies) continue;
    EXPECT_TRUE(finding.passed) << finding.check << ": " << finding.measured << " " << finding.unit << ", at most "
                                << finding.limit << " " << finding.fault;
  }
}

TEST_P(EveryToolRenderer, FaultsAreCaughtByName) {
  for (std::size_t f = 0; f < tool_fault_names.size(); ++f) {
    const ToolSubject right = subject_of(find_tool_renderer(tool_renderer_catalogue(), GetParam()), {});
    if (tool_fault_names[f].starts_with("friction")) {
      EXPECT_THROW(with_fault(right, tool_fault_names[f]), UsageError) << "there is none to plant it in";
      continue;
    }
    const ToolSubject subject = with_fault(right, tool_fault_names[f]);
    EXPECT_THAT(faults_named(subject), ::testing::ElementsAre(std::string(tool_fault_names[f])));
  }
}

// A margin of half a millimetre where millimetres are counted.
TEST(GodObjectTool, ALengthOfItsOwnIsCaughtByName) {
  ToolSubject subject = subject_of(find_tool_renderer(tool_renderer_catalogue(), "god-object-tool"), {});
  subject.make_in_unit = [make = subject.make](const Tool& tool, const TriangleMesh& object_W, const Coupling& coupling,
                                               double /*unit_m*/) { return make(tool, object_W, coupling); };
  EXPECT_THAT(faults_named(subject), ::testing::ElementsAre("length-of-its-own"));
}

// The margin in another unit than metres, as a plug-in may declare it: its number follows the power of the metre, and
// where that is not known, nothing is blamed.
TEST(GodObjectTool, AParameterOfAnyUnitFollowsTheUnitOfLength) {
  const ToolRendererEntry& known = find_tool_renderer(tool_renderer_catalogue(), "god-object-tool");
  const auto with_parameter = [&](const char* unit, double of_length, double largest) {
    ToolRendererEntry entry = known;
    const std::size_t own = entry.parameters.size();
    entry.parameters.push_back({"own", unit, 0.0, largest, 4.0, "told apart below"});
    entry.make = [make = known.make, own, of_length, declared = known.parameters](
                     const rendering::Parameters& parameters, const Tool& tool, const TriangleMesh& object_W,
                     const Coupling& coupling) {
      // 4 in metres; anything but what follows the unit makes the coupling another one.
      const double unit_m = parameters.at(tool::unit_parameter_name);
      const double right = 4.0 * std::pow(unit_m, -of_length);
      std::map<std::string, double> rest(parameters.values().begin(), parameters.values().end());
      rest.erase("own");
      return make(
          rendering::Parameters(declared, rest, "renderer", "a test", ""), tool, object_W,
          {coupling.stiffness_N_per_m * parameters.at("own") / right, coupling.rotational_stiffness_Nm_per_rad});
    };
    return entry;
  };
  const auto finding = [](const ToolRendererEntry& entry) {
    const auto findings = check_tool_renderer(subject_of(entry, {}));
    return *std::ranges::find(findings, "other-unit", &ToolFinding::check);
  };
  for (const auto& [unit, of_length] :
       {std::pair{"N s/m", -1.0}, {"1/m^2", -2.0}, {"kg", -1.0}, {"m/s", 1.0}, {"s", 0.0}}) {
    const ToolFinding found = finding(with_parameter(unit, of_length, 1e9));
    EXPECT_TRUE(found.applies && found.passed) << unit << ' ' << found.measured;
  }
  const ToolFinding unknown = finding(with_parameter("furlong", 1.0, 1e9));
  EXPECT_FALSE(unknown.applies);
  EXPECT_THAT(unknown.why_not, ::testing::HasSubstr("own [furlong]"));
  const ToolFinding beyond = finding(with_parameter("m", 1.0, 100.0));
  EXPECT_FALSE(beyond.applies);
  EXPECT_THAT(beyond.why_not, ::testing::HasSubstr("would be 4000"));
}

// Meshes in millimetres, declared so where they are read: the same answer but for rounding.
TEST_P(EveryToolRenderer, MeshesInMillimetresGiveTheSame) {
  const ExactCase c = make_exact_case("peg-0.2mm");
  const auto folder = std::filesystem::path(::testing::TempDir()) / ("tool-unit-" + GetParam());
  std::filesystem::create_directories(folder);
  const auto through_millimetres = [&](TriangleMesh mesh, const char* name) {
    for (Vec3& v : mesh.vertices_W_m) v *= 1000.0;
    save_mesh(mesh, folder / name);
    return surface::load_mesh(folder / name, length_unit_factor("mm"));
  };
  const auto metres = make_tool_renderer(GetParam(), tool_of(c.tool_T), c.object_W, {});
  const auto millimetres = make_tool_renderer(GetParam(), tool_of(through_millimetres(c.tool_T, "tool.obj")),
                                              through_millimetres(c.object_W, "object.obj"), {});
  for (const Pose& handle : c.handles) {
    const ToolResult expected = settle(*metres, c.free, handle);
    const ToolResult obtained = settle(*millimetres, c.free, handle);
    EXPECT_LE((obtained.f_W_N - expected.f_W_N).norm(), 1e-6);
    EXPECT_LE((obtained.torque_W_Nm - expected.torque_W_Nm).norm(), 1e-7);
  }
  std::filesystem::remove_all(folder);
}

TEST_P(EveryToolRenderer, StepAllocatesNothing) {
  if (!touchstone::testing::allocations_are_counted()) GTEST_SKIP() << "allocations are not counted in this build";
  const ExactCase c = make_exact_case("peg-0.2mm");
  const auto renderer = make_tool_renderer(GetParam(), tool_of(c.tool_T), c.object_W, {});
  settle(*renderer, c.free, c.handles[0]);
  const touchstone::testing::AllocationGuard guard;
  bool contact = false;
  for (int i = 0; i < 200; ++i) {
    contact = renderer->step({1.0 + 1e-3 * i, between(c.handles[0], c.handles[1], i / 200.0)}).contact || contact;
  }
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_TRUE(contact);
}

INSTANTIATE_TEST_SUITE_P(Tools, EveryToolRenderer,
                         ::testing::Values("god-object-tool", "voxmap-pointshell", "penalty-coupling"),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

// The shell that a mesh would give, as a tool of its own.
TEST(ToolOfPoints, IsRenderedAsTheMeshThatItWasMadeFrom) {
  const ExactCase c = make_exact_case("box-corner");
  const Tool mesh = tool_of(c.tool_T);
  constexpr double point_spacing_m = 1e-3;
  Tool points;
  points.mass = mesh.mass;
  points.shell = tool::make_point_shell(c.tool_T, point_spacing_m);
  for (const char* name : {"voxmap-pointshell", "penalty-coupling"}) {
    ToolSettings settings;
    settings.parameters["point_spacing_m"] = point_spacing_m;
    const auto of_mesh = make_tool_renderer(name, mesh, c.object_W, settings);
    const auto of_points = make_tool_renderer(name, points, c.object_W, {});
    for (const Pose& handle : c.handles) {
      const ToolResult expected = settle(*of_mesh, c.free, handle);
      const ToolResult obtained = settle(*of_points, c.free, handle);
      EXPECT_TRUE(obtained.contact);
      EXPECT_EQ(obtained.f_W_N, expected.f_W_N) << name;
      EXPECT_EQ(obtained.torque_W_Nm, expected.torque_W_Nm) << name;
    }
  }
  EXPECT_THROW(make_tool_renderer("god-object-tool", points, c.object_W, {}), UsageError) << "it needs the mesh";
}

TEST(ToolCatalogue, SaysWhatIsWrong) {
  const Tool tool = tool_of(contacts::box_mesh(Vec3::Zero(), Vec3::Constant(0.01)));
  EXPECT_THROW(make_tool_renderer("teapot", tool, tool.mesh_T, {}), UsageError);
  TriangleMesh open = tool.mesh_T;
  open.triangles.pop_back();
  EXPECT_THROW(make_tool_renderer("god-object-tool", tool, open, {}), BadData);
  ToolSettings settings;
  settings.parameters["voxel_m"] = -1.0;
  EXPECT_THROW(make_tool_renderer("voxmap-pointshell", tool, tool.mesh_T, settings), UsageError);
  settings.parameters = {{"voxels_m", 1e-3}};
  EXPECT_THROW(make_tool_renderer("voxmap-pointshell", tool, tool.mesh_T, settings), UsageError);
  settings = {};
  settings.coupling.stiffness_N_per_m = 0.0;
  EXPECT_THROW(make_tool_renderer("god-object-tool", tool, tool.mesh_T, settings), UsageError);
}

}  // namespace
}  // namespace touchstone::tool_renderers
