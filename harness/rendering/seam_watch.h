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

#include "harness/rendering/renderer.h"
#include "harness/surface/surface.h"

namespace touchstone::rendering {

struct SeamLosses {
  std::size_t count = 0;
  double first_t_s = 0.0;
  Vec3 first_at_W_m = Vec3::Zero();  // the surface contact point before the first
  double first_depth_m = 0.0;
};

// Of a run, sample by sample.
class SeamSearch {
 public:
  explicit SeamSearch(std::shared_ptr<const surface::Surface> surface);

  // Begins another run; the losses stay.
  void restart() noexcept;
  void see(const TipState& tip, const StepResult& now) noexcept;
  [[nodiscard]] const SeamLosses& losses() const noexcept { return losses_; }

 private:
  void look(const TipState& tip, const StepResult& now) noexcept;
  [[nodiscard]] bool near_open_edge(const Vec3& p_W_m, double within_m) const noexcept;

  std::shared_ptr<const surface::Surface> surface_;
  std::vector<std::pair<Vec3, Vec3>> open_edges_;  // from corner to corner
  SeamLosses losses_;
  SeamLosses candidate_;
  StepResult last_;
  Vec3 last_tip_ = Vec3::Zero();
  int pending_ = 0;  // samples in which a loss may still be confirmed
};

// The inner renderer, watched.
class SeamWatch final : public Renderer {
 public:
  SeamWatch(std::unique_ptr<Renderer> inner, std::shared_ptr<SeamSearch> search)
      : inner_(std::move(inner)), search_(std::move(search)) {}

  [[nodiscard]] std::optional<std::size_t> memory_bytes() const noexcept override { return inner_->memory_bytes(); }

 private:
  void do_reset() override {
    inner_->reset();
    search_->restart();
  }
  StepResult do_step(const TipState& tip) noexcept override {
    StepResult now = inner_->step(tip);
    search_->see(tip, now);
    return now;
  }
  [[nodiscard]] std::string do_failure() const override { return inner_->failure(); }

  std::unique_ptr<Renderer> inner_;
  std::shared_ptr<SeamSearch> search_;
};

// One line for people; empty where nothing was lost.
std::string seam_warning(const SeamLosses& losses);

}  // namespace touchstone::rendering
