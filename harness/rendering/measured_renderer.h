// What a comparison with a recording runs: the model's renderer with its effects, and its instrument entries, which say
// how the measurement was made. A renderer alone (Catalogue::make) never sees the latter.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "harness/rendering/instrument_effect.h"
#include "harness/rendering/renderer.h"

namespace touchstone::rendering {

// An instrument entry and when it acts.
using StagedInstrument = std::pair<InstrumentStage, std::unique_ptr<InstrumentEffect>>;

class MeasuredRenderer {
 public:
  // Runs the entries by stage; those of one stage in the order given. What Catalogue::make_measured() returns.
  MeasuredRenderer(std::unique_ptr<Renderer> renderer, std::vector<StagedInstrument> instrument);

  [[nodiscard]] Renderer& renderer() const { return *renderer_; }
  [[nodiscard]] bool has_instrument() const { return !instrument_.empty(); }
  // Where the tip truly was, given where it was measured.
  [[nodiscard]] Vec3 true_position(const Vec3& measured_W_m) const;
  // Turns the renderer's forces into what the sensor would have said. To be right at a sample it needs the samples
  // within halo_s() on either side.
  void apply(const MotionView& motion, std::span<Vec3> f_W_N) const;
  [[nodiscard]] double halo_s() const;

 private:
  std::unique_ptr<Renderer> renderer_;
  std::vector<StagedInstrument> instrument_;  // in the order of stages
};

}  // namespace touchstone::rendering
