// A renderer over an object that moves: a floor that carries the tip along, a wall that comes.
//
// The renderer stands in the object's own frame B, in which the object is at rest, and receives the tip in that frame;
// its answer is turned back:
//   p_B = X_WB(t)^-1 p_W,   f_W = R_WB(t) f_B.
// So everything that a renderer does at a resting object it does at a moving one, and friction acts against the
// velocity relative to the object. Exact where the object is moved by a motor that no contact force disturbs.
// Everything moving together changes nothing: in B the tip does not move.
#pragma once

#include <memory>
#include <string>

#include "harness/base/motion.h"
#include "harness/rendering/pose_track.h"
#include "harness/rendering/renderer.h"

namespace touchstone::rendering {

class MovingObject final : public Renderer {
 public:
  MovingObject(std::unique_ptr<Renderer> over_object, PoseTrack poses);
  // `poses`: X_WB over time (pose_track.h); `source` names them in messages. Throws as PoseTrack does.
  MovingObject(std::unique_ptr<Renderer> over_object, MotionColumns poses, std::string source)
      : MovingObject(std::move(over_object), PoseTrack(std::move(poses), std::move(source))) {}

  [[nodiscard]] std::optional<std::size_t> memory_bytes() const noexcept override {
    return over_object_->memory_bytes();
  }

 private:
  void do_reset() override;
  // Failed where the poses do not reach.
  StepResult do_step(const TipState& tip) noexcept override;
  [[nodiscard]] std::string do_failure() const override;

  std::unique_ptr<Renderer> over_object_;
  PoseTrack poses_;
  std::size_t segment_ = 0;
  bool out_of_reach_ = false;
  double out_of_reach_s_ = 0.0;
};

}  // namespace touchstone::rendering
