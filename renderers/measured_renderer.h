// What a comparison with a recording runs: the model's renderer with its effects, and its instrument entries, which say
// how the measurement was made. A renderer alone (make_renderer) never sees the latter.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "harness/base/rooms.h"
#include "harness/rendering/model.h"
#include "harness/rendering/renderer.h"
#include "harness/surface/surface.h"
#include "renderers/instrument/instrument_effect.h"

namespace touchstone::renderers {

class MeasuredRenderer {
 public:
  // Throws BadData as make_renderer() does.
  MeasuredRenderer(const Model& model, const std::shared_ptr<const Surface>& surface);

  [[nodiscard]] Renderer& renderer() const { return *renderer_; }
  [[nodiscard]] bool has_instrument() const { return !instrument_.empty(); }
  // Where the tip truly was, given where it was measured.
  [[nodiscard]] Vec3 true_position(const Vec3& measured_W_m) const;
  // Turns the renderer's forces into what the sensor would have said. To be right at a sample it needs the samples
  // within halo_s() on either side.
  void apply(const MotionView& motion, std::span<Vec3> f_W_N) const;
  [[nodiscard]] double halo_s() const;

 private:
  std::vector<std::pair<InstrumentStage, std::unique_ptr<InstrumentEffect>>> instrument_;  // in the order of stages
  std::unique_ptr<Renderer> renderer_;
};

}  // namespace touchstone::renderers
