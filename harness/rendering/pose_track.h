// Where a body is over time: X_WB(t), its pose in the world.
//
// A pose takes coordinates of the body's frame B to the world's W: x_W = p_W + R(q_WB) x_B. Between the poses of a
// track the origin moves on a straight line at constant speed and the rotation about one axis (spherical linear
// interpolation: K. Shoemake, "Animating rotation with quaternion curves", SIGGRAPH 1985). Outside its poses a track is
// not defined.
#pragma once

#include <memory>
#include <string>

#include "harness/base/motion.h"

namespace touchstone::rendering {

struct BodyPose {
  Vec3 p_W_m = Vec3::Zero();  // of B's origin
  Quat q_WB = Quat::Identity();

  [[nodiscard]] Vec3 to_W(const Vec3& x_B) const { return p_W_m + q_WB * x_B; }
  [[nodiscard]] Vec3 to_B(const Vec3& x_W) const { return q_WB.conjugate() * (x_W - p_W_m); }
};

class PoseTrack {
 public:
  // At rest.
  explicit PoseTrack(const BodyPose& pose = {});
  // `source` names the poses in messages. Throws BadData for fewer than two poses, poses without orientation, and times
  // that do not increase.
  PoseTrack(MotionColumns poses, std::string source);
  // Wherever *live says at the moment of the question, whatever the time: for a servo loop that knows the poses itself.
  static PoseTrack following(std::shared_ptr<const BodyPose> live);

  [[nodiscard]] bool moves() const noexcept { return live_ != nullptr || poses_.size() > 1; }
  [[nodiscard]] bool covers(double t_s) const noexcept {
    return !(poses_.size() > 1) || (t_s >= poses_.t_s.front() && t_s <= poses_.t_s.back());
  }
  // The time must be covered. `segment` is where the last question ended: 0 at first.
  [[nodiscard]] BodyPose at(double t_s, std::size_t& segment) const noexcept;
  // At the beginning of the track.
  [[nodiscard]] BodyPose first() const noexcept;
  // Why a time is not covered.
  [[nodiscard]] std::string out_of_reach(double t_s) const;
  // Every length times `scale`, the motion `speed` times as fast.
  void rescale(double scale, double speed);

 private:
  MotionColumns poses_;  // one where it is at rest
  std::string source_;
  std::shared_ptr<const BodyPose> live_;
};

}  // namespace touchstone::rendering
