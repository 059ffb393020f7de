#include "harness/rendering/measured_renderer.h"

#include <algorithm>

namespace touchstone::rendering {

MeasuredRenderer::MeasuredRenderer(std::unique_ptr<Renderer> renderer, std::vector<StagedInstrument> instrument)
    : renderer_(std::move(renderer)), instrument_(std::move(instrument)) {
  std::ranges::stable_sort(instrument_, {}, [](const auto& one) { return one.first; });
}

Vec3 MeasuredRenderer::true_position(const Vec3& measured_W_m) const {
  Vec3 p = measured_W_m;
  for (const auto& [stage, effect] : instrument_) p = effect->true_position(p);
  return p;
}

void MeasuredRenderer::apply(const MotionView& motion, std::span<Vec3> f_W_N) const {
  for (const auto& [stage, effect] : instrument_) effect->apply(motion, f_W_N);
}

double MeasuredRenderer::halo_s() const {
  double sum = 0.0;
  for (const auto& [stage, effect] : instrument_) sum += effect->halo_s();
  return sum;
}

}  // namespace touchstone::rendering
