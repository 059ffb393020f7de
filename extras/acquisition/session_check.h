// Does a session keep what its processing assumes? Each assumption is measured again from the session itself, in free
// air and in contact, and its residual is held against a limit; what breaks one makes a wrong recording out of sound
// numbers. Each check needs its part to show up in the data and says nothing otherwise.
//   In free air the sensor reads bias + m (g - a). Over blocks of half a second the mean of m a is m times the change
//   of
// speed over the block, so that, tip speeds from the tracker, bias, drift, and a turn e of the sensor's frame remain:
//   f - f_tool + m dv / dt = b + d t + e x m g.
// Limits: what is below half of the contact force counts as free air, so a block may be off by that, and bias and drift
// (over the session) by half of it again, since the wrong force is added to every sample of the recording. A frame may
// be turned by 0.05 rad: 5 % of every force, half of what a fit to static poses may leave (frame_check.h).
//   In contact the ball is one radius from the mesh, less what the object gives in (in proportion to the force). A
//   shift
// of the tip in the probe's frame must not explain more than the mesh's own error, and what no cause explains must stay
// within three standard deviations of tracker and mesh. A scan to 0.2 mm is assumed (1-sigma): optical scanners state
// 0.05 to 0.2 mm. Between earlier and later contacts the object may move by 1 mm RMS at the touched places, as far as
// the positions of a right recording may be off, or by what is not clear (object_move.h). The
// refinement may move the surface by what the markers leave open: their expected error there (Fitzpatrick, West and
// Maurer 1998), by Fisher's F with 6 and 3 n - 6 degrees of freedom at one in ten thousand.
//   In sliding contact the tangential force is -mu N v / |v|, so that a part of the normal force that turns with the
// sensor, e x N n, is a turned frame (the same 0.05 rad, and five standard errors from clusters of half a second). A
// part along the surface that friction and inertia (m a, which stays in a recording) leave, constant or drawn to a
// place, is a bias or a cable's pull. Its part along the normal does not show, so that the limit is half that of a bias
// in free air. What the scan's error makes of the push (0.2 mm over 10 mm turn the normal by 0.02 rad) follows the
// push, and a pull does not: what is beyond the limit besides parts that follow the push is a pull, else only what is
// beyond it by that much too; between the two there is doubt.
//   Gains of the sensor's axes, E symmetric and without a trace, make R E R^T N n of a push N n, of which the part
//   along
// the surface turns with the sensor, R: the same fit with five more parameters shows a gain that changed after the
// static poses, if the sensor turns against the surface. Limit: as for static poses (force_gains.h); it is a doubt.
//   A ball of radius r that is pushed by f at its foot -r n has the torque -r n x f about its centre. What is left of
// the measured one, f x e + b in the sensor's frame, is a centre declared e off, and a torque's bias b. Limit: 2 mm, as
// far as positions may be off at their worst, and five standard errors as above.
#pragma once

#include <string>
#include <vector>

#include "contact_registration.h"
#include "harness/recording/tool_load.h"
#include "harness/surface/surface.h"
#include "object_move.h"
#include "rigid_registration.h"

namespace touchstone::acquisition {
using recording::ToolLoad;

// The session at the motion's samples, in the tracker's frame, bias and weight removed.
struct SessionSamples {
  std::vector<double> t_s;
  std::vector<Vec3> tip_T_m, f_T_N;
  std::vector<Quat> q_TS;
  std::vector<bool> free_air;  // nothing can be touched: far from the mesh, or before the first and after the last tap
};

// Empty, or a sentence per broken assumption, with what to do next.
struct FreeAirCheck {
  std::vector<std::string> faults;
  std::string event;       // a single stretch that is off: it harms no other sample
  std::size_t blocks = 0;  // of half a second; 0: there is no free air to check by
  Vec3 bias_N = Vec3::Zero(), drift_N = Vec3::Zero(), turn_rad = Vec3::Zero();  // drift over the session
};
FreeAirCheck check_free_air(const SessionSamples& samples, const ToolLoad& tool, const Vec3& gravity_T_m_per_s2,
                            double contact_force_N);

// How far the surface gives in, from how gaps follow the force across it; 0 where the force hardly varies (by less than
// a tenth of its mean), so that this cannot be told from another place of the object.
double contact_compliance_m_per_N(const surface::Surface& surface, const ContactSamples& contacts, double tip_radius_m);
// The correction that contacts ask for, as far as they know better than the markers: both as normal equations of a
// small move, the markers' about none with their fiducial error, the contacts' with what they leave, the scan's error,
// and as many independent contacts as there are half seconds; how far the surface gives in is eliminated with the
// contacts'. Where contacts hardly tell a direction (along a nearly level surface) the markers keep it.
RigidTransform weighed_correction(const surface::Surface& surface, const ContactSamples& contacts, double tip_radius_m,
                                  const ContactRegistration& refinement, const MarkerRegistration& markers);
// As above; `doubts`: what these contacts do not tell.
struct ContactCheck {
  std::vector<std::string> faults, doubts;
};
ContactCheck check_contacts(const surface::Surface& surface, const ContactSamples& contacts, double tip_radius_m,
                            double tracker_noise_m, double contact_force_N, const ContactRegistration& refinement,
                            const MarkerRegistration& markers, const ObjectMove& move);

}  // namespace touchstone::acquisition
