// A map over a surface that does not lie in the object's xy plane (harness/rendering/surface_frame.h): the effect runs
// in the map's own frame, on the same contact.
#pragma once

#include <memory>
#include <utility>

#include "harness/rendering/effect.h"
#include "harness/rendering/surface_frame.h"

namespace touchstone::renderers {

class InFrame final : public rendering::Effect {
 public:
  InFrame(const rendering::SurfaceFrame& frame, std::unique_ptr<rendering::Effect> map)
      : frame_(frame), map_(std::move(map)) {}
  void reset() noexcept override { map_->reset(); }
  void apply(rendering::ContactState& contact) noexcept override {
    rendering::ContactState seen = contact;
    seen.tip_W_m = frame_.place(contact.tip_W_m);
    seen.proxy_W_m = frame_.place(contact.proxy_W_m);
    for (Vec3 rendering::ContactState::*const vector :
         {&rendering::ContactState::tip_step_W_m, &rendering::ContactState::n_W,
          &rendering::ContactState::tangential_W_N})
      seen.*vector = frame_.direction(contact.*vector);
    const Vec3 n_F = seen.n_W;
    const Vec3 proxy_F_m = seen.proxy_W_m;
    map_->apply(seen);
    // What the map left alone keeps its bits.
    const Vec3 tip_W_m = contact.tip_W_m;
    const Vec3 tip_step_W_m = contact.tip_step_W_m;
    const Vec3 n_W = seen.n_W == n_F ? contact.n_W : Vec3(frame_.q_WF * seen.n_W);
    const Vec3 proxy_W_m =
        seen.proxy_W_m == proxy_F_m ? contact.proxy_W_m : Vec3(frame_.q_WF * seen.proxy_W_m + frame_.origin_W_m);
    contact = seen;
    contact.tip_W_m = tip_W_m;
    contact.tip_step_W_m = tip_step_W_m;
    contact.n_W = n_W;
    contact.proxy_W_m = proxy_W_m;
    contact.tangential_W_N = frame_.q_WF * seen.tangential_W_N;
  }

 private:
  rendering::SurfaceFrame frame_;
  std::unique_ptr<rendering::Effect> map_;
};

// The map as it is where its frame is the object's. `values`: all of the map's, its frame's last.
inline std::unique_ptr<rendering::Effect> in_frame(std::span<const double> values,
                                                   std::unique_ptr<rendering::Effect> map) {
  const rendering::SurfaceFrame frame = rendering::frame_of(values);
  if (frame.is_objects()) return map;
  return std::make_unique<InFrame>(frame, std::move(map));
}

}  // namespace touchstone::renderers
