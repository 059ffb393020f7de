// The tool that hangs on a force sensor: its mass, centre of mass and the sensor's bias from static orientations, and
// the removal of its weight by the measured orientation (2006 paper, section 2).
//   F = b_F + m g_S,   T = b_T + c x m g_S = b_T - [g_S]x (m c),   g_S = R_WS^T g_W:
// linear in the ten unknowns (m, m c, b_F, b_T). Columns are scaled to unit length and solved by singular values, so
// the rank says what a set of orientations can tell: 6 of 10 from one orientation, 9 from two, 10 from three.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "harness/base/wrench.h"

namespace touchstone::recording {

// A sensor at rest in one orientation. The wrench is in the sensor's frame, as read.
struct StaticPose {
  Quat q_WS = Quat::Identity();
  Wrench measured;
};

struct ToolLoad {
  double mass_kg = 0.0;
  Vec3 center_S_m = Vec3::Zero();  // of mass, from the sensor's origin
  Wrench bias;
};

// Misfit of force [N] and torque [N m]. `component` is the root mean square over all components of all samples,
// `vector` over the lengths of the error vectors (sqrt(3) times larger).
struct WrenchResidual {
  double force_component_N = 0.0;
  double force_vector_N = 0.0;
  double torque_component_Nm = 0.0;
  Vec3 force_axis_N = Vec3::Zero();  // per axis
  std::size_t samples = 0;
};

struct ToolIdentification {
  ToolLoad load;
  // Standard uncertainties from the residuals of this fit (white errors assumed).
  double mass_sigma_kg = 0.0;
  Vec3 center_sigma_m = Vec3::Zero();
  Vec3 bias_force_sigma_N = Vec3::Zero();
  WrenchResidual fit;
  // Each pose predicted from a fit to the others; samples is 0 where leaving one out leaves too few orientations.
  WrenchResidual held_out;
  double condition = 0.0;  // of the scaled system
};

// Static orientations of a tool from a table: fx_N .. tz_Nm (or without units where they are SI) and qw.. or r11..r33.
std::vector<StaticPose> read_static_poses(const std::filesystem::path& path, bool bare_is_si);

// Throws BadData when the orientations cannot tell the ten unknowns apart, saying what is missing.
ToolIdentification identify_tool(const std::vector<StaticPose>& poses, const Vec3& gravity_W_m_per_s2,
                                 const std::string& source);

// The wrench that the tool alone gives in this orientation, bias included.
Wrench tool_wrench(const ToolLoad& load, const Quat& q_WS, const Vec3& gravity_W_m_per_s2);

// What the surface does to the tip: bias and weight removed, torque about the tip, in the sensor's frame.
Wrench contact_wrench_at_tip(const Wrench& measured, const ToolLoad& load, const Quat& q_WS,
                             const Vec3& gravity_W_m_per_s2, const Vec3& tip_S_m);

WrenchResidual residual_of(const std::vector<Wrench>& errors);

}  // namespace touchstone::recording
