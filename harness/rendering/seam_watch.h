// Notes where a tip that was held falls through the seam of an open mesh: two sheets that meet with a step or a gap are
// not one surface, and a point that slides below the edge of the higher one is behind it from then on.
//
// A tip is lost if its contact ends within two of its steps of an open edge, while it is deeper than two steps, and it
// is behind a face within the next 20 samples without having touched again. Off the outer rim of a sheet it is behind
// none. All of it in the surface's frame and unit.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "harness/base/rooms.h"
#include "harness/rendering/renderer.h"
#include "harness/surface/surface.h"

namespace touchstone::rendering {

// Shared with whoever asks after the run.
struct SeamLosses {
  std::size_t count = 0;
  double first_t_s = 0.0;
  Vec3 first_at_W_m = Vec3::Zero();  // the surface contact point before the first
  double first_depth_m = 0.0;
};

class SeamWatch final : public Renderer {
 public:
  // The inner renderer as it is where the surface has no open edge.
  SeamWatch(std::unique_ptr<Renderer> inner, std::shared_ptr<const Surface> surface,
            std::shared_ptr<SeamLosses> losses);

  [[nodiscard]] std::size_t memory_bytes() const noexcept override { return inner_->memory_bytes(); }

 private:
  void do_reset() override;
  StepResult do_step(const TipState& tip) noexcept override;
  [[nodiscard]] std::string do_failure() const override { return inner_->failure(); }
  void look(const TipState& tip, const StepResult& now) noexcept;
  [[nodiscard]] bool near_open_edge(const Vec3& p_W_m, double within_m) const noexcept;

  std::unique_ptr<Renderer> inner_;
  std::shared_ptr<const Surface> surface_;
  std::shared_ptr<SeamLosses> losses_;
  std::vector<std::pair<Vec3, Vec3>> open_edges_;  // from corner to corner
  StepResult last_;
  Vec3 last_tip_ = Vec3::Zero();
  int pending_ = 0;  // samples in which a loss may still be confirmed
  SeamLosses candidate_;
};

// One line for people; empty where nothing was lost.
std::string seam_warning(const SeamLosses& losses);

}  // namespace touchstone::rendering
