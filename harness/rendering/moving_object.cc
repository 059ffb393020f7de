#include "harness/rendering/moving_object.h"

#include <fmt/format.h>

#include "harness/base/error.h"

namespace touchstone::rendering {

MovingObject::MovingObject(std::unique_ptr<Renderer> over_object, MotionColumns poses, std::string source)
    : over_object_(std::move(over_object)), poses_(std::move(poses)), source_(std::move(source)) {
  if (poses_.q_WS.size() != poses_.size()) {
    throw BadData(fmt::format(
        "{}: no orientation: the poses of a moving object need the columns qw, qx, qy and qz beside t_s, x_m, y_m and "
        "z_m",
        source_));
  }
  if (poses_.size() < 2) {
    throw BadData(fmt::format("{}: {} poses of the object; at least two were expected", source_, poses_.size()));
  }
}

void MovingObject::do_reset() {
  segment_ = 0;
  out_of_reach_ = false;
  over_object_->reset();
}

StepResult MovingObject::do_step(const TipState& tip) noexcept {
  StepResult result;
  result.status = StepStatus::failed;
  if (out_of_reach_) return result;
  if (!(tip.t_s >= poses_.t_s.front() && tip.t_s <= poses_.t_s.back())) {
    out_of_reach_ = true;
    out_of_reach_s_ = tip.t_s;
    return result;
  }
  // Time advances: the segment is found by going on from the last one.
  while (segment_ + 2 < poses_.size() && tip.t_s >= poses_.t_s[segment_ + 1]) ++segment_;
  const double begin_s = poses_.t_s[segment_];
  const double share = (tip.t_s - begin_s) / (poses_.t_s[segment_ + 1] - begin_s);
  const Vec3 origin_W_m = (1.0 - share) * poses_.p_W_m[segment_] + share * poses_.p_W_m[segment_ + 1];
  const Quat q_WB = poses_.q_WS[segment_].slerp(share, poses_.q_WS[segment_ + 1]).normalized();
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
  return fmt::format("{}: the object's poses go from t_s = {} to {}; the trajectory has t_s = {}", source_,
                     poses_.t_s.front(), poses_.t_s.back(), out_of_reach_s_);
}

}  // namespace touchstone::rendering
