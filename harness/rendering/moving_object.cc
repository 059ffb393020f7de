#include "harness/rendering/moving_object.h"

namespace touchstone::rendering {

MovingObject::MovingObject(std::unique_ptr<Renderer> over_object, PoseTrack poses)
    : over_object_(std::move(over_object)), poses_(std::move(poses)) {}

void MovingObject::do_reset() {
  segment_ = 0;
  out_of_reach_ = false;
  over_object_->reset();
}

StepResult MovingObject::do_step(const TipState& tip) noexcept {
  StepResult result;
  result.status = StepStatus::failed;
  if (out_of_reach_) return result;
  if (!poses_.covers(tip.t_s)) {
    out_of_reach_ = true;
    out_of_reach_s_ = tip.t_s;
    return result;
  }
  const auto [origin_W_m, q_WB] = poses_.at(tip.t_s, segment_);
  const Quat q_BW = q_WB.conjugate();

  result = over_object_->step({tip.t_s, q_BW * (tip.p_W_m - origin_W_m), q_BW * tip.q_WS});
  result.f_W_N = q_WB * result.f_W_N;
  result.n_W = q_WB * result.n_W;
  // Free, it is the tip itself, to the bit.
  result.contact_W_m = result.contact ? Vec3(origin_W_m + q_WB * result.contact_W_m) : tip.p_W_m;
  return result;
}

std::string MovingObject::do_failure() const {
  if (!out_of_reach_) return over_object_->failure();
  return poses_.out_of_reach(out_of_reach_s_);
}

}  // namespace touchstone::rendering
