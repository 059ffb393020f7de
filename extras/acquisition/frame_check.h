// Are static poses written in the frames that the caller assumes? Fits the tool anew under each mistake that files of
// this kind hold (force by the tool's holder, orientation inverted, quaternion in another order, wrench already turned
// into the world, axes mirrored, exchanged or of unequal gain) and compares what the best tool of each leaves. Nothing
// is applied: the caller names the repair.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "force_gains.h"
#include "harness/recording/tool_load.h"

namespace touchstone::acquisition {
using recording::StaticPose;
using recording::ToolIdentification;

enum class WrenchFrame { sensor, world };
enum class OrientationReading { given, inverse, scalar_last };

// How a table of poses is read. The default is what the format asks for.
struct PoseReading {
  WrenchFrame wrench = WrenchFrame::sensor;
  OrientationReading orientation = OrientationReading::given;
  bool flip_force = false;  // negate force and torque

  // The flags of `touchstone acquire tool` that ask for this reading: "--wrench-frame world"; empty for the default.
  [[nodiscard]] std::string flags() const;
  // What it says of the file: "the wrench is in the world's frame"; empty for the default.
  [[nodiscard]] std::string meaning() const;
};

// The poses as `reading` has them: wrench in the sensor's frame, orientation from the sensor's frame to the world's.
std::vector<StaticPose> read_as(const std::vector<StaticPose>& poses, const PoseReading& reading);

// The share of the tool's own weight that its best fit leaves, as a length: 0 fits exactly.
double share_of_weight_left(const ToolIdentification& found, const Vec3& gravity_W_m_per_s2);

// More of the weight than this left means a bad fit: that is an error of 0.1 rad (6 degrees) in every orientation,
// which no arm and no tracker that can be used makes.
inline constexpr double most_weight_left = 0.1;

struct FrameCheck {
  bool bad_fit = false;     // as it was read
  double share_left = 0.0;  // of the weight
  // The reading that fits best, with its tool; nothing where no other reading has a positive mass and a good fit.
  std::optional<PoseReading> repair;
  ToolIdentification repaired;
  // Where no reading fits: exchanged or mirrored axes of the force that do ("fx has the other sign"), with the mass and
  // the force per component that is left so; empty where none of the 48 signed orders fits.
  std::string axes;
  double axes_mass_kg = 0.0, axes_left_N = 0.0;
  // Where the forces fit: mirrored or exchanged axes of the torque that leave less than half of what the file's leave,
  // by more than chance ("tz has the other sign"), and what is left per component; empty otherwise. An order and its
  // reverse fit alike, with the centre of mass on the other side.
  std::string torque_axes;
  double torque_left_Nm = 0.0;
  // Where gains of its own for each axis of the force explain what is left, beyond chance: these, and what they leave.
  std::optional<ForceGains> gains;

  // One tool, or one with a gain for each axis, explains the forces.
  [[nodiscard]] bool forces_fit() const { return !bad_fit || gains || !torque_axes.empty(); }
  // Empty, or what a user must know, with the flags of the repair.
  [[nodiscard]] std::string message(const ToolIdentification& as_read, const std::string& source) const;
};

// `poses` as they stand in the file, `as_read` the tool that was found under `reading`.
FrameCheck check_frames(const std::vector<StaticPose>& poses, const PoseReading& reading,
                        const ToolIdentification& as_read, const Vec3& gravity_W_m_per_s2, const std::string& source);

}  // namespace touchstone::acquisition
