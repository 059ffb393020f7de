// What a measurement adds to a contact: sensor bias, tool weight, cross-talk, ... Only the comparison with a recording
// runs these; they are no property of the object and no renderer sees them.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "harness/base/vec.h"
#include "harness/rendering/effect.h"
#include "harness/rendering/renderer.h"

namespace touchstone::rendering {

// The order in which a measurement comes about; effects run in this order, then in the model file's.
enum class InstrumentStage : std::uint8_t {
  pose,           // where the tip truly was, given where it was measured; runs before the renderer
  geometry,       // where the true surface differs from the mesh; runs inside the contact, in the comparison only
  object_frame,   // forces of the tool itself
  sensor_linear,  // cross-talk, in the sensor's frame
  sensor_offset,  // bias and drift, in the sensor's frame
  saturation,     // in the sensor's frame
  time,           // force later than position
};

// Accelerations of one motion that were worked out before, by the window of their fit: a fit of the mass that they act
// on asks for them again and again. For many threads.
class AccelerationMemo {
 public:
  template <class WorkOut>
  std::shared_ptr<const std::vector<Vec3>> of(double window_s, const WorkOut& work_out) {
    const std::lock_guard lock(mutex_);
    auto& known = known_[window_s];
    if (known == nullptr) known = std::make_shared<const std::vector<Vec3>>(work_out());
    return known;
  }

 private:
  std::mutex mutex_;
  std::map<double, std::shared_ptr<const std::vector<Vec3>>> known_;
};

// Synchronous columns; q_WS may be empty: the sensor's frame is then the object's.
struct MotionView {
  std::span<const double> t_s;
  std::span<const Vec3> p_W_m;
  std::span<const Quat> q_WS;
  AccelerationMemo* accelerations = nullptr;  // of this motion, where somebody keeps one
};

class InstrumentEffect {
 public:
  virtual ~InstrumentEffect() = default;
  // Forces in the object's frame, changed in place to what the sensor would have said, turned back to the object's
  // frame.
  virtual void apply(const MotionView& motion, std::span<Vec3> f_W_N) const {
    static_cast<void>(motion), static_cast<void>(f_W_N);
  }
  // Stage pose: the true tip position of a measured one.
  [[nodiscard]] virtual Vec3 true_position(const Vec3& measured_W_m) const { return measured_W_m; }
  // Stage geometry: what to run inside the contact.
  [[nodiscard]] virtual std::unique_ptr<Effect> contact_effect() const { return nullptr; }
  // How far in time apply() looks to either side of a sample.
  [[nodiscard]] virtual double halo_s() const { return 0.0; }
};

}  // namespace touchstone::rendering
