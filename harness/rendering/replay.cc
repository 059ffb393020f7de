#include "harness/rendering/replay.h"

#include <fmt/format.h>

#include <limits>
#include <vector>

#include "harness/base/error.h"
#include "harness/base/progress.h"
#include "harness/rendering/cost_histogram.h"
#include "harness/rendering/renderer_failed.h"
#include "harness/rendering/step_clock.h"

namespace touchstone::rendering {
namespace {

// Enough steps that two clock readings weigh nothing, few enough that reading ahead stays in the cache.
constexpr std::size_t block = 1024;

void check(const Renderer& renderer, const TipState& tip, const StepResult& result, std::uint64_t sample) {
  if (result.status == StepStatus::failed) {
    throw RendererFailed(fmt::format("sample {} (t = {} s): {}", sample, tip.t_s, renderer.failure()));
  }
  if (result.status == StepStatus::refused) {
    throw BadData(fmt::format(
        "sample {} (t = {} s): the renderer refused it: the position is not finite or time does not advance", sample,
        tip.t_s));
  }
  if (!result.f_W_N.allFinite() || !result.contact_W_m.allFinite()) {
    throw BadData(
        fmt::format("sample {} (t = {} s, tip {} {} {} m): the renderer answered with a number that is not finite",
                    sample, tip.t_s, tip.p_W_m.x(), tip.p_W_m.y(), tip.p_W_m.z()));
  }
}

// Replays block by block; returns the ticks spent in steps when whole blocks are timed.
template <class Step, class After>
std::uint64_t in_blocks(const Renderer& renderer, const TipSource& source, const Step& step, const After& after) {
  std::vector<TipState> tips(block);
  std::vector<StepResult> results(block);
  std::uint64_t done = 0;
  std::size_t filled = block;
  while (filled == block) {
    stop_if_asked();
    filled = 0;
    while (filled < block && source(tips[filled])) ++filled;
    step(std::span<const TipState>(tips.data(), filled), std::span<StepResult>(results.data(), filled));
    for (std::size_t i = 0; i < filled; ++i) {
      check(renderer, tips[i], results[i], done + i);
      after(tips[i], results[i], i);
    }
    done += filled;
  }
  return done;
}

}  // namespace

std::uint64_t replay(Renderer& renderer, const TipSource& source, const StepSink& sink, bool time_steps) {
  renderer.reset();
  if (!time_steps) {
    return in_blocks(
        renderer, source,
        [&](auto tips, auto results) {
          for (std::size_t i = 0; i < tips.size(); ++i) results[i] = renderer.step(tips[i]);
        },
        [&](const TipState& tip, const StepResult& result, std::size_t) {
          sink(tip, result, std::numeric_limits<double>::quiet_NaN());
        });
  }
  const StepClock clock;
  std::vector<double> cost_us(block);
  return in_blocks(
      renderer, source,
      [&](auto tips, auto results) {
        for (std::size_t i = 0; i < tips.size(); ++i) {
          const auto begin = StepClock::ticks();
          results[i] = renderer.step(tips[i]);
          cost_us[i] = clock.elapsed_ns(begin, StepClock::ticks()) * 1e-3;
        }
      },
      [&](const TipState& tip, const StepResult& result, std::size_t i) { sink(tip, result, cost_us[i]); });
}

recording::RenderedTrajectory replay(Renderer& renderer, const recording::InTrajectory& trajectory, bool time_steps) {
  recording::RenderedTrajectory rendered;
  const std::size_t size = trajectory.size();
  rendered.t_s.reserve(size);
  rendered.tip_W_m.reserve(size);
  rendered.contact_W_m.reserve(size);
  rendered.f_W_N.reserve(size);
  rendered.contact.reserve(size);
  if (time_steps) rendered.cost_us.reserve(size);
  replay(
      renderer, tip_source(trajectory.motion),
      [&](const TipState& tip, const StepResult& result, double cost_us) {
        rendered.t_s.push_back(tip.t_s);
        rendered.tip_W_m.push_back(tip.p_W_m);
        rendered.contact_W_m.push_back(result.contact_W_m);
        rendered.f_W_N.push_back(result.f_W_N);
        rendered.contact.push_back(result.contact ? 1 : 0);
        if (time_steps) rendered.cost_us.push_back(cost_us);
      },
      time_steps);
  return rendered;
}

ReplayTiming measure_steps(Renderer& renderer, const std::function<TipSource()>& open) {
  ReplayTiming timing;
  const StepClock clock;
  double blocks_ns = 0.0;
  renderer.reset();
  timing.steps = in_blocks(
      renderer, open(),
      [&](auto tips, auto results) {
        const auto begin = StepClock::ticks();
        for (std::size_t i = 0; i < tips.size(); ++i) results[i] = renderer.step(tips[i]);
        blocks_ns += clock.elapsed_ns(begin, StepClock::ticks());
      },
      [](const TipState&, const StepResult&, std::size_t) {});
  CostHistogram histogram;
  replay(
      renderer, open(), [&](const TipState&, const StepResult&, double cost_us) { histogram.add(cost_us * 1e3); },
      true);
  timing.mean_us = blocks_ns * 1e-3 / static_cast<double>(timing.steps);
  timing.median_us = histogram.quantile_ns(0.5) * 1e-3;
  timing.p99_us = histogram.quantile_ns(0.99) * 1e-3;
  timing.p999_us = histogram.quantile_ns(0.999) * 1e-3;
  timing.max_us = histogram.max_ns() * 1e-3;
  timing.memory_bytes = renderer.memory_bytes();
  return timing;
}

TipSource tip_source(const MotionColumns& motion) {
  return [&motion, next = std::size_t{0}](TipState& tip) mutable {
    if (next == motion.size()) return false;
    tip.t_s = motion.t_s[next];
    tip.p_W_m = motion.p_W_m[next];
    tip.q_WS = motion.q_WS.empty() ? Quat::Identity() : motion.q_WS[next];
    ++next;
    return true;
  };
}

std::string timing_to_json(const ReplayTiming& timing, const std::string& operations) {
  return fmt::format(
      "{{\"steps\": {}, \"mean_us\": {}, \"median_us\": {}, \"p99_us\": {}, \"p999_us\": {}, \"max_us\": {}, "
      "\"build_ms\": {}, "
      "\"memory_bytes\": {}, \"operations\": {}}}\n",
      timing.steps, timing.mean_us, timing.median_us, timing.p99_us, timing.p999_us, timing.max_us, timing.build_ms,
      timing.memory_bytes ? fmt::format("{}", *timing.memory_bytes) : "null", operations);
}

}  // namespace touchstone::rendering
