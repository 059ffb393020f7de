#include "harness/tool/tool_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "harness/base/random.h"
#include "harness/surface/box_mesh.h"
#include "harness/tool/tool_path.h"
#include "harness/tool/worse.h"

namespace touchstone::tool {
using surface::TriangleMesh;

namespace {

constexpr double material_density_kg_per_m3 = 1000.0;
constexpr double half_m = 0.01;                     // of the cube
const Vec3 cube_center_T_m(0.005, -0.002, -0.015);  // of the cube in the tool's frame: every contact has a lever
constexpr double reach_m = 0.04;                    // no point of the tool is farther from its origin
// Rounding and what a settled run leaves, for methods that resolve the surface exactly.
constexpr double floor_m = 1e-6;

TriangleMesh cube(const Vec3& center) {
  return surface::box_mesh(center - Vec3::Constant(half_m), center + Vec3::Constant(half_m));
}
TriangleMesh slab() { return surface::box_mesh(Vec3(-0.05, -0.05, -0.02), Vec3(0.05, 0.05, 0.0)); }
Tool tool_of(const TriangleMesh& mesh) { return solid_tool(mesh, material_density_kg_per_m3); }

TriangleMesh moved_mesh(TriangleMesh mesh, const Pose& by) {
  for (Vec3& v : mesh.vertices_W_m) v = by.to_W(v);
  return mesh;
}

double lowest_m(const TriangleMesh& mesh_T, const Quat& q) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Vec3& v : mesh_T.vertices_W_m) lowest = std::min(lowest, (q * v).z());
  return lowest;
}

// Turned about all three axes: a corner of the cube is lowest, and no two orders of the turns agree.
Quat oblique() { return rotation_by(Vec3(0, 0, 0.9)) * rotation_by(Vec3(0, 0.5, 0)) * rotation_by(Vec3(0.7, 0, 0)); }
// Touching the slab, lowered by `depth_m`.
Pose lowered(const TriangleMesh& mesh_T, const Quat& q, double depth_m) {
  return {Vec3(0, 0, -lowest_m(mesh_T, q) - depth_m), q};
}
Pose lifted(const Pose& pose, double by_m) { return {pose.p_W_m + Vec3(0, 0, by_m), pose.q_WT}; }

class Checks {
 public:
  explicit Checks(const ToolSubject& subject) : subject_(subject), resolution_m_(subject.resolution_m + floor_m) {}

  std::vector<ToolFinding> run() {
    torque_about_handle();
    order_of_rotations();
    contacts_are_of_this_step();
    no_torque_without_lever();
    never_pulls();
    free_when_away();
    moved_scene();
    other_unit();
    swapped_bodies();
    closed_path_gives_no_energy();
    same_answer_again();
    friction_when_sliding();
    sticks_below_the_cone();
    return findings_;
  }

 private:
  [[nodiscard]] double force_limit() const { return coupling_.stiffness_N_per_m * resolution_m_; }
  // Of a torque: the force's share at the farthest lever, and the turn that the resolution leaves over a face.
  [[nodiscard]] double torque_limit() const {
    return force_limit() * reach_m + coupling_.rotational_stiffness_Nm_per_rad * resolution_m_ / half_m;
  }
  ToolFinding& add(const std::string& check, double measured, double limit, const std::string& unit) {
    findings_.push_back({check, measured <= limit, true, measured, limit, unit, "", ""});
    return findings_.back();
  }
  static void needs(ToolFinding& finding, bool has, const std::string& why_not) {
    finding.applies = has;
    if (!has) finding.why_not = why_not;
  }
  static constexpr const char* own_normals = "its normals are the tool's own";

  // A corner carries all of the force, so that the torque about the handle is r x f with r the way to that corner.
  void torque_about_handle() {
    const Tool tool = tool_of(cube(cube_center_T_m));
    const auto renderer = subject_.make(tool, slab(), coupling_);
    const Pose handle = lowered(tool.mesh_T, oblique(), 0.003);
    const ToolResult result = settle(*renderer, lifted(handle, 0.006), handle);
    Vec3 corner = result.proxy.to_W(tool.mesh_T.vertices_W_m[0]);
    for (const Vec3& v : tool.mesh_T.vertices_W_m) {
      if (result.proxy.to_W(v).z() < corner.z()) corner = result.proxy.to_W(v);
    }
    const Vec3 expected = (corner - result.proxy.p_W_m).cross(result.f_W_N);
    const auto error = [&](const Vec3& torque) { return (result.torque_W_Nm - torque).norm(); };
    // The contact may lie a little beside the corner.
    const double limit = result.f_W_N.norm() * 2.0 * resolution_m_ + floor_m;
    ToolFinding& finding = add("torque-about-handle",
                               result.contact ? error(expected) : std::numeric_limits<double>::infinity(), limit, "Nm");
    if (finding.passed || !result.contact) return;
    // The explanation that comes nearest, if it is near: a fifth of the torque is more than method and coupling blur,
    // and less than the explanations differ by.
    constexpr double near = 0.2;
    double nearest = std::max(limit, near * expected.norm());
    const auto explain = [&](const Vec3& torque, const char* fault) {
      if (error(torque) > nearest) return;
      nearest = error(torque);
      finding.fault = fault;
    };
    explain(-expected, "torque-sign");
    explain(handle.q_WT.conjugate() * expected, "torque-frame");
    explain((corner - result.proxy.to_W(tool.mass.center_T_m)).cross(result.f_W_N), "wrong-lever-arm");
  }

  // The height at which a turned tool first touches tells which rotation the renderer used.
  void order_of_rotations() {
    const Tool tool = tool_of(cube(cube_center_T_m));
    const auto renderer = subject_.make(tool, slab(), coupling_);
    const Quat q = oblique();
    constexpr double step_m = 0.05e-3;
    const double start = -lowest_m(tool.mesh_T, q) + 0.015;
    double height = start;
    renderer->reset();
    for (int i = 0; i < 700; ++i) {
      height = start - step_m * i;
      if (step_or_throw(*renderer, {1e-3 * i, {Vec3(0, 0, height), q}}).contact) break;
    }
    const auto error = [&](const Quat& rotation) { return std::abs(height + lowest_m(tool.mesh_T, rotation)); };
    // A method with mass notices a few steps late.
    const double limit = 2.0 * resolution_m_ + 8.0 * step_m;
    ToolFinding& finding = add("order-of-rotations", error(q), limit, "m");
    const Vec3 zyx = q.toRotationMatrix().eulerAngles(2, 1, 0);
    const Quat other =
        rotation_by(zyx[2] * Vec3::UnitX()) * rotation_by(zyx[1] * Vec3::UnitY()) * rotation_by(zyx[0] * Vec3::UnitZ());
    if (!finding.passed && (error(other) <= limit || error(q.conjugate()) <= limit)) finding.fault = "rotation-order";
  }

  // While the tool slides, each contact that is reported lies on the tool where its proxy is now.
  void contacts_are_of_this_step() {
    const Tool tool = tool_of(cube(cube_center_T_m));
    const auto renderer = subject_.make(tool, slab(), coupling_);
    const Pose first = lowered(tool.mesh_T, Quat::Identity(), 0.002);
    settle(*renderer, lifted(first, 0.006), first);
    double farthest = 0.0;
    bool any = false;
    for (int i = 1; i <= 200; ++i) {
      const Pose handle{first.p_W_m + Vec3(1e-4 * i, 0, 0), first.q_WT};
      const ToolResult result = step_or_throw(*renderer, {1.0 + 1e-3 * i, handle});
      for (const ToolContact& contact : result.contacts) {
        any = true;
        const Vec3 inside = (result.proxy.to_T(contact.p_W_m) - cube_center_T_m).cwiseAbs() - Vec3::Constant(half_m);
        for (int k = 0; k < 3; ++k) farthest = worse(farthest, inside[k]);
        farthest = worse(farthest, -inside.maxCoeff());
      }
    }
    // A method may list the contacts that moved the proxy in this step: two steps of the hand.
    ToolFinding& finding = add("contacts-of-this-step", any ? farthest : std::numeric_limits<double>::infinity(),
                               2e-4 + 2.0 * resolution_m_, "m");
    if (!finding.passed && any) finding.fault = "stale-contact";
  }

  void no_torque_without_lever() {
    const Tool tool = tool_of(cube(Vec3::Zero()));
    const auto renderer = subject_.make(tool, slab(), coupling_);
    const Pose handle = lowered(tool.mesh_T, Quat::Identity(), 0.002);
    const ToolResult result = settle(*renderer, lifted(handle, 0.006), handle);
    add("no-torque-without-lever", result.contact ? result.torque_W_Nm.norm() : std::numeric_limits<double>::infinity(),
        torque_limit(), "Nm");
  }

  // Into the slab: a force that pulls.
  void never_pulls() {
    const Tool tool = tool_of(cube(cube_center_T_m));
    const auto renderer = subject_.make(tool, slab(), coupling_);
    Random random(61);
    double pull = 0.0;
    for (int i = 0; i < 10; ++i) {
      const Pose handle = lowered(tool.mesh_T, random.rotation(), random.uniform(0.0005, 0.003));
      pull = worse(pull, -settle(*renderer, lifted(handle, 0.006), handle).f_W_N.z());
    }
    add("never-pulls", pull, force_limit(), "N");
  }

  void free_when_away() {
    const Tool tool = tool_of(cube(cube_center_T_m));
    const auto renderer = subject_.make(tool, slab(), coupling_);
    const Pose handle = lowered(tool.mesh_T, oblique(), 0.002);
    settle(*renderer, lifted(handle, 0.006), handle);
    ToolResult result;
    for (int i = 1; i <= 400; ++i)
      result = step_or_throw(*renderer, {1.0 + 1e-3 * i, lifted(handle, 1e-4 * std::min(i, 100))});
    add("free-when-away", result.contact ? result.f_W_N.norm() + 1.0 : result.f_W_N.norm() + result.torque_W_Nm.norm(),
        0.0, "N");
  }

  // The whole scene in another frame: the same wrench in that frame.
  void moved_scene() {
    const Tool tool = tool_of(cube(cube_center_T_m));
    Random random(62);
    const Pose handle = lowered(tool.mesh_T, rotation_by(Vec3(0.02, -0.03, 0.4)), 0.002);
    const ToolResult here = settle(*subject_.make(tool, slab(), coupling_), lifted(handle, 0.006), handle);
    double worst = 0.0;
    for (int i = 0; i < 3; ++i) {
      const Pose by{0.2 * random.direction(), random.rotation()};
      const auto renderer = subject_.make(tool, moved_mesh(slab(), by), coupling_);
      const ToolResult there = settle(*renderer, by * lifted(handle, 0.006), by * handle);
      worst = worse(worst, (there.f_W_N - by.q_WT * here.f_W_N).norm() / force_limit());
      worst = worse(worst, (there.torque_W_Nm - by.q_WT * here.torque_W_Nm).norm() / torque_limit());
    }
    needs(add("moved-scene", worst, 2.0, "limits of force and torque"), subject_.exact_normals, own_normals);
  }

  // Lengths counted in millimetres, or in units of ten metres: the same force, and the same torque in that unit.
  // Kilograms go with the unit too, so that newtons are kilograms times that unit over seconds squared.
  void other_unit() {
    if (!subject_.only_in_metres.empty()) {
      needs(add("other-unit", 0.0, 1.0, "limits of force and torque"), false, subject_.only_in_metres);
      return;
    }
    const Tool tool = tool_of(cube(cube_center_T_m));
    const Pose handle = lowered(tool.mesh_T, oblique(), 0.002);
    const ToolResult here = settle(*subject_.make(tool, slab(), coupling_), lifted(handle, 0.006), handle);
    double worst = here.contact ? 0.0 : std::numeric_limits<double>::infinity();
    for (const double unit_m : other_units_m) {
      const auto in_unit = [&](const Pose& pose) { return Pose{pose.p_W_m / unit_m, pose.q_WT}; };
      const auto mesh_in_unit = [&](TriangleMesh mesh) {
        for (Vec3& v : mesh.vertices_W_m) v /= unit_m;
        return mesh;
      };
      const Tool same{mesh_in_unit(tool.mesh_T),
                      {tool.mass.mass_kg * unit_m, tool.mass.center_T_m / unit_m, tool.mass.inertia_T_kg_m2 / unit_m}};
      const Coupling coupling{coupling_.stiffness_N_per_m * unit_m, coupling_.rotational_stiffness_Nm_per_rad / unit_m};
      const auto renderer = subject_.make_in_unit(same, mesh_in_unit(slab()), coupling, unit_m);
      const ToolResult there = settle(*renderer, in_unit(lifted(handle, 0.006)), in_unit(handle));
      worst = worse(worst, (there.f_W_N - here.f_W_N).norm() / force_limit());
      worst = worse(worst, (there.torque_W_Nm * unit_m - here.torque_W_Nm).norm() / torque_limit());
    }
    ToolFinding& finding = add("other-unit", worst, 1.0, "limits of force and torque");
    if (!finding.passed && here.contact) finding.fault = "length-of-its-own";
  }

  // Tool and object change their parts: the opposite wrench. A coupling that hardly turns, so that it is the same in
  // both: a pure translation along the normal.
  void swapped_bodies() {
    const Coupling stiff{coupling_.stiffness_N_per_m, 2000.0};
    const TriangleMesh body = cube(cube_center_T_m);
    const Pose handle = lowered(body, rotation_by(Vec3(0, 0, 0.3)), 0.002);
    const Pose away = lifted(handle, 0.006);
    const ToolResult tool = settle(*subject_.make(tool_of(body), slab(), stiff), away, handle);
    const ToolResult object = settle(*subject_.make(tool_of(slab()), body, stiff), away.inverse(), handle.inverse());
    // The wrench on the slab is the opposite one; about the slab's own origin, which is the handle there, and in the
    // axes of the cube, which is the world there.
    const Wrench expected =
        rotated(handle.q_WT.conjugate(), wrench_about({-tool.f_W_N, -tool.torque_W_Nm}, -handle.p_W_m));
    const double turn = stiff.rotational_stiffness_Nm_per_rad * resolution_m_ / half_m;
    const double worst = worse((object.f_W_N - expected.f_N).norm() / force_limit(),
                               (object.torque_W_Nm - expected.torque_Nm).norm() / (force_limit() * reach_m + turn));
    needs(add("swapped-bodies", tool.contact && object.contact ? worst : std::numeric_limits<double>::infinity(), 2.0,
              "limits of force and torque"),
          subject_.exact_normals, own_normals);
  }

  // Around a loop of positions and orientations in contact, ten times: a renderer without a motor gives back no more
  // than it took. What sampling at 1 kHz leaves is the difference between the sum from the left and the right ends.
  void closed_path_gives_no_energy() {
    const Tool tool = tool_of(cube(cube_center_T_m));
    const auto renderer = subject_.make(tool, slab(), coupling_);
    const Pose center = lowered(tool.mesh_T, rotation_by(Vec3(0.3, 0.2, 0.0)), 0.002);
    const auto at_phase = [&](double phase) {
      const Vec3 aside(2e-3 * std::cos(phase), 2e-3 * std::sin(2.0 * phase), 1e-3 * std::sin(phase));
      return moved(center,
                   {aside, Vec3(0.05 * std::sin(phase), 0.05 * std::cos(phase) - 0.05, 0.03 * std::sin(2.0 * phase))});
    };
    settle(*renderer, lifted(center, 0.006), at_phase(0.0));
    constexpr int loop = 1000;
    double given = 0.0;
    double turned_over = 0.0;
    Pose before = at_phase(0.0);
    ToolResult last;
    for (int i = 1; i <= 11 * loop; ++i) {
      const Pose handle = at_phase(2.0 * std::numbers::pi * i / loop);
      const ToolResult now = step_or_throw(*renderer, {1.0 + 1e-3 * i, handle});
      const Displacement way = displacement(before, handle);
      const double work = 0.5 * (dot(now.f_W_N + last.f_W_N, way.translation_m) +
                                 dot(now.torque_W_Nm + last.torque_W_Nm, way.rotation_rad));
      if (i > loop) {  // the first loop settles
        given += work;
        turned_over += std::abs(work);
      }
      before = handle;
      last = now;
    }
    // One part in two hundred of what went to and fro: the trapezoidal rule over a thousand steps is far better, a
    // wrong sign or lever of the torque far worse.
    add("closed-path-gives-no-energy", given / turned_over, 5e-3, "of the energy turned over");
  }

  void same_answer_again() {
    const Tool tool = tool_of(cube(cube_center_T_m));
    const Pose handle = lowered(tool.mesh_T, oblique(), 0.002);
    const auto renderer = subject_.make(tool, slab(), coupling_);
    const ToolResult first = settle(*renderer, lifted(handle, 0.006), handle);
    const ToolResult second = settle(*subject_.make(tool, slab(), coupling_), lifted(handle, 0.006), handle);
    const ToolResult third = settle(*renderer, lifted(handle, 0.006), handle);
    add("same-answer-again",
        (first.f_W_N - second.f_W_N).norm() + (first.torque_W_Nm - second.torque_W_Nm).norm() +
            (first.f_W_N - third.f_W_N).norm() + (first.torque_W_Nm - third.torque_W_Nm).norm(),
        0.0, "N and Nm");
  }

  // A cube that is dragged flat over the slab: mu times the normal force against the motion, nothing aside; and no
  // contact leaves its cone on the way.
  void friction_when_sliding() {
    const Tool tool = tool_of(cube(Vec3::Zero()));
    const auto renderer = subject_.make(tool, slab(), coupling_);
    const Pose first = lowered(tool.mesh_T, Quat::Identity(), 0.002);
    settle(*renderer, lifted(first, 0.006), first);
    ToolResult result;
    double outside = 0.0;
    for (int i = 1; i <= 300; ++i) {
      result = step_or_throw(*renderer, {1.0 + 1e-3 * i, {first.p_W_m + Vec3(1e-4 * i, 0, 0), first.q_WT}});
      for (const ToolContact& contact : result.contacts) {
        const double f_n = contact.f_W_N.dot(contact.n_W);
        const double f_t = (contact.f_W_N - f_n * contact.n_W).norm();
        outside = worse(outside, worse(-f_n, f_t - subject_.mu * f_n));
      }
    }
    const double f_n = result.f_W_N.z();
    const Vec3 f_t(result.f_W_N.x(), result.f_W_N.y(), 0.0);
    const auto error = [&](double mu) { return (f_t + Vec3(mu * f_n, 0, 0)).norm(); };
    ToolFinding& finding =
        add("friction-when-sliding", result.contact ? error(subject_.mu) : std::numeric_limits<double>::infinity(),
            force_limit(), "N");
    if (!finding.passed && result.contact) {
      if (error(0.0) <= force_limit()) finding.fault = "friction-lost";
      if (error(2.0 * subject_.mu) <= force_limit()) finding.fault = "friction-doubled";
    }
    needs(finding, subject_.exact_normals, own_normals);
    // Rounding of forces of some newtons.
    add("inside-friction-cones", outside, 1e-9, "N");
  }

  // Pulled aside by less than friction holds, and left there for half a second: it stays where it is.
  void sticks_below_the_cone() {
    const Tool tool = tool_of(cube(Vec3::Zero()));
    const auto renderer = subject_.make(tool, slab(), coupling_);
    const Pose first = lowered(tool.mesh_T, Quat::Identity(), 0.003);
    const double f_n = settle(*renderer, lifted(first, 0.006), first).f_W_N.z();
    // Half of what holds, and less than what turns the cube over.
    const double pull = 0.5 * std::min(subject_.mu, 0.5) * f_n;
    const double way = pull / coupling_.stiffness_N_per_m;
    ToolResult result;
    for (int i = 1; i <= 600; ++i) {
      const Vec3 aside(way * std::min(1.0, 0.01 * i), 0, 0);
      result = step_or_throw(*renderer, {1.0 + 1e-3 * i, {first.p_W_m + aside, first.q_WT}});
    }
    needs(add("sticks-below-the-cone", (result.f_W_N - Vec3(-pull, 0, f_n)).norm(), force_limit(), "N"),
          subject_.mu > 0.0, "it has no friction");
  }

  const ToolSubject& subject_;
  double resolution_m_;
  Coupling coupling_;
  std::vector<ToolFinding> findings_;
};

}  // namespace

std::vector<ToolFinding> check_tool_renderer(const ToolSubject& subject) { return Checks(subject).run(); }

bool passed(const std::vector<ToolFinding>& findings) {
  return std::ranges::all_of(findings, [](const ToolFinding& finding) { return finding.passed || !finding.applies; });
}

std::string findings_to_text(const std::string& renderer, const std::vector<ToolFinding>& findings) {
  std::string text;
  std::size_t failed = 0, count = 0;
  for (const ToolFinding& finding : findings) {
    if (!finding.applies) {
      text += fmt::format("  n/a   {:<30} {}\n", finding.check, finding.why_not);
      continue;
    }
    ++count;
    failed += finding.passed ? 0U : 1U;
    text +=
        fmt::format("  {:<5} {:<30} {:.3g} of at most {:.3g} {}{}\n", finding.passed ? "ok" : "WRONG", finding.check,
                    finding.measured, finding.limit, finding.unit, finding.fault.empty() ? "" : ": " + finding.fault);
  }
  return text + fmt::format("{}: {} of {} checks passed\n", renderer, count - failed, count);
}

}  // namespace touchstone::tool
