#include "harness/rendering/pose_track.h"

#include <fmt/format.h>

#include "harness/base/error.h"

namespace touchstone::rendering {

PoseTrack::PoseTrack(const BodyPose& pose) {
  poses_.t_s = {0.0};
  poses_.p_W_m = {pose.p_W_m};
  poses_.q_WS = {pose.q_WB};
}

PoseTrack::PoseTrack(MotionColumns poses, std::string source) : poses_(std::move(poses)), source_(std::move(source)) {
  if (poses_.q_WS.size() != poses_.size()) {
    throw BadData(fmt::format(
        "{}: no orientation: the poses of a moving object need the columns qw, qx, qy and qz beside t_s, x_m, y_m and "
        "z_m",
        source_));
  }
  if (poses_.size() < 2) {
    throw BadData(fmt::format("{}: {} poses of the object; at least two were expected", source_, poses_.size()));
  }
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    if (poses_.t_s[i] > poses_.t_s[i - 1]) continue;
    throw BadData(
        fmt::format("{}: pose {}: t_s = {} does not come after {}", source_, i, poses_.t_s[i], poses_.t_s[i - 1]));
  }
}

PoseTrack PoseTrack::following(std::shared_ptr<const BodyPose> live) {
  PoseTrack track;
  track.live_ = std::move(live);
  return track;
}

BodyPose PoseTrack::at(double t_s, std::size_t& segment) const noexcept {
  if (live_) return *live_;
  if (poses_.size() < 2) return {poses_.p_W_m.front(), poses_.q_WS.front()};
  // Time advances but for a reset: the segment is found by going on from the last one.
  while (segment > 0 && t_s < poses_.t_s[segment]) --segment;
  while (segment + 2 < poses_.size() && t_s >= poses_.t_s[segment + 1]) ++segment;
  const double begin_s = poses_.t_s[segment];
  const double share = (t_s - begin_s) / (poses_.t_s[segment + 1] - begin_s);
  return {(1.0 - share) * poses_.p_W_m[segment] + share * poses_.p_W_m[segment + 1],
          poses_.q_WS[segment].slerp(share, poses_.q_WS[segment + 1]).normalized()};
}

BodyPose PoseTrack::first() const noexcept {
  return live_ ? *live_ : BodyPose{poses_.p_W_m.front(), poses_.q_WS.front()};
}

std::string PoseTrack::out_of_reach(double t_s) const {
  return fmt::format("{}: the object's poses go from t_s = {} to {}; the trajectory has t_s = {}", source_,
                     poses_.t_s.front(), poses_.t_s.back(), t_s);
}

void PoseTrack::rescale(double scale, double speed) {
  for (Vec3& p : poses_.p_W_m) p *= scale;
  for (double& t : poses_.t_s) t /= speed;
}

}  // namespace touchstone::rendering
