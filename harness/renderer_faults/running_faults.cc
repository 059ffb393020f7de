// Faults of running for long and beside others: memory, state, cost.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <limits>
#include <optional>
#include <thread>
#include <vector>

#include "harness/base/random.h"
#include "harness/renderer_faults/detectors.h"
#include "harness/renderer_faults/probe.h"
#include "harness/rendering/renderer_failed.h"
#include "harness/stats/quantile.h"
#include "harness/surface/sphere_mesh.h"

namespace touchstone::renderer_faults {
using rendering::Renderer;
using rendering::StepResult;

namespace {

constexpr double tick_s = 1e-3;

surface::TriangleMesh round_body() { return surface::sphere_mesh(half_side_m, 3); }

// Taps and strokes about a ball, from outside and back; the next seed goes elsewhere.
std::vector<Vec3> strokes_about(double radius_m, std::uint64_t seed, int contacts) {
  Random random(seed);
  std::vector<Vec3> tips;
  for (int contact = 0; contact < contacts; ++contact) {
    const Vec3 n = random.direction();
    const Vec3 along = n.cross(random.direction()).normalized();
    tips.push_back(2.0 * half_side_m * n);
    for (int i = 0; i <= 60; ++i) {
      const double press = std::min({i, 20, 60 - i}) / 20.0;
      const Vec3 out = (n + 2e-3 * i * along).normalized();
      tips.push_back((half_side_m + radius_m + 5e-4 - 1e-3 * press) * out);
    }
    tips.push_back(3.0 * half_side_m * n);
  }
  return tips;
}

StepResult step_to(Renderer& renderer, std::size_t tick, const Vec3& tip) {
  StepResult result = renderer.step({tick_s * static_cast<double>(tick + 1), tip, Quat::Identity()});
  if (result.status == rendering::StepStatus::failed) throw rendering::RendererFailed(renderer.failure());
  return result;
}

std::vector<Vec3> forces(Renderer& renderer, const std::vector<Vec3>& tips) {
  renderer.reset();
  std::vector<Vec3> f;
  f.reserve(tips.size());
  for (std::size_t i = 0; i < tips.size(); ++i) f.push_back(step_to(renderer, i, tips[i]).f_W_N);
  return f;
}

// The first step at which they differ in any bit that counts; NaN differs from everything.
std::optional<std::size_t> first_difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!(a[i] == b[i])) return i;
  }
  return std::nullopt;
}

// Of this thread alone: what other programs do on the processor is not in it.
double processor_time_s() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// A loop over a level block whose every round is the same: any difference in cost between rounds is the renderer's.
class Rounds {
 public:
  static constexpr std::size_t length = 200;
  explicit Rounds(const Engine& engine) : probe_(engine, level_block()) {
    for (std::size_t i = 0; i < length; ++i) {
      const double phase = 2.0 * M_PI * static_cast<double>(i) / static_cast<double>(length);
      tips_[i] = {4e-3 * std::cos(phase), 3e-3 * std::sin(phase),
                  engine.tip_radius_m + 2e-4 - 5e-4 * (1.0 - std::cos(phase)) * 0.5};
    }
    probe_.to({tips_[0].x(), tips_[0].y(), tips_[0].z() + 2e-3});
  }
  void step(std::size_t i) { probe_.to(tips_[i % length]); }
  double round_s() {
    const double before = processor_time_s();
    for (std::size_t i = 0; i < length; ++i) step(i);
    return processor_time_s() - before;
  }

 private:
  Probe probe_;
  std::array<Vec3, length> tips_;
};

// A million steps are asked of renderers that make them in this time.
constexpr double longest_s = 8.0;

// Rounds that a run of `steps` would take, fewer where that takes longer than longest_s.
std::size_t affordable_rounds(const Engine& engine, std::size_t steps) {
  Rounds rounds(engine);
  double fastest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 5; ++i) fastest = std::min(fastest, rounds.round_s());
  const double affordable = longest_s / std::max(fastest, 1e-9);
  return std::min(steps / Rounds::length, static_cast<std::size_t>(std::max(affordable, 1.0)));
}

struct Costs {
  double early_s = 0.0;
  double late_s = 0.0;
};

// The fastest round of the first and of the last tenth: whatever disturbs a measurement makes it longer.
Costs fastest_rounds(const Engine& engine, std::size_t count) {
  Rounds rounds(engine);
  rounds.round_s();
  Costs costs{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < count; ++i) {
    const double now_s = rounds.round_s();
    if (i < count / 10) costs.early_s = std::min(costs.early_s, now_s);
    if (i >= count - count / 10) costs.late_s = std::min(costs.late_s, now_s);
  }
  return costs;
}

double slow_from_s(double usual_s) { return std::max(20.0 * usual_s, 2e-5); }

// Steps that cost many times the usual one, of a run of so many. Each step is timed by the clock on the wall, which is
// read without a call of the system. The thread's own, which takes longer to read than most steps take, is read once in
// a round: what the round cost beyond its other steps must be at least half of what makes a step slow, else
// other programs had the processor meanwhile.
std::vector<std::size_t> slow_steps(const Engine& engine, std::size_t count, double& usual_s) {
  using Clock = std::chrono::steady_clock;
  Rounds rounds(engine);
  std::vector<float> cost_s(count);
  std::vector<double> round_s;
  for (std::size_t begin = 0; begin < count; begin += Rounds::length) {
    const double round_began_s = processor_time_s();
    Clock::time_point before = Clock::now();
    for (std::size_t i = begin; i < std::min(count, begin + Rounds::length); ++i) {
      rounds.step(i);
      const Clock::time_point after = Clock::now();
      cost_s[i] = std::chrono::duration<float>(after - before).count();
      before = after;
    }
    round_s.push_back(processor_time_s() - round_began_s);
  }
  usual_s = stats::upper_median({cost_s.begin(), cost_s.end()});
  const double least_s = slow_from_s(usual_s);
  std::vector<std::size_t> slow;
  // The first round meets everything for the first time: memory, caches, branches.
  for (std::size_t round = 1; round < round_s.size(); ++round) {
    const std::size_t begin = round * Rounds::length;
    const std::size_t end = std::min(count, begin + Rounds::length);
    double slow_s = 0.0;
    double others_s = 0.0;
    for (std::size_t i = begin; i < end; ++i) (cost_s[i] > least_s ? slow_s : others_s) += cost_s[i];
    if (slow_s == 0.0 || round_s[round] - others_s < 0.5 * least_s) continue;
    for (std::size_t i = begin; i < end; ++i) {
      if (cost_s[i] > least_s) slow.push_back(i);
    }
  }
  return slow;
}

// What these steps cost of the thread's own time, each asked for before and after it, in a run up to the last of them.
std::vector<double> own_cost_s(const Engine& engine, const std::vector<std::size_t>& steps) {
  Rounds rounds(engine);
  std::vector<double> cost_s;
  for (std::size_t i = 0; cost_s.size() < steps.size(); ++i) {
    if (i != steps[cost_s.size()]) {
      rounds.step(i);
      continue;
    }
    const double before_s = processor_time_s();
    rounds.step(i);
    cost_s.push_back(processor_time_s() - before_s);
  }
  return cost_s;
}

}  // namespace

std::optional<Finding> find_allocation(const Engine& engine) {
  if (!engine.allocations) return std::nullopt;
  const auto renderer = engine.make(make_embree_surface(round_body()), 1.0);
  const auto tips = strokes_about(engine.tip_radius_m, 203, 6);
  renderer->reset();
  for (std::size_t i = 0; i < tips.size(); ++i) {
    const std::uint64_t before = engine.allocations();
    const StepResult now = step_to(*renderer, i, tips[i]);
    const std::uint64_t count = engine.allocations() - before;
    if (count == 0) continue;
    return Finding{"allocation",
                   fmt::format("step {} allocates memory {} time{}, {}", i, count, count == 1 ? "" : "s",
                               now.contact ? "in contact" : "in free space"),
                   "strokes over a ball 20 mm in radius", static_cast<double>(count), "allocations"};
  }
  return std::nullopt;
}

std::optional<Finding> find_state_after_reset(const Engine& engine) {
  const auto surface = make_embree_surface(round_body());
  const auto used = engine.make(surface, 1.0);
  const auto fresh = engine.make(surface, 1.0);
  // Left in the middle of a stroke, in contact.
  auto interrupted = strokes_about(engine.tip_radius_m, 204, 1);
  interrupted.resize(interrupted.size() / 2);
  const auto tips = strokes_about(engine.tip_radius_m, 205, 4);
  forces(*used, interrupted);
  const auto after = forces(*used, tips);
  const auto expected = forces(*fresh, tips);
  const auto differs = first_difference(after, expected);
  if (!differs) return std::nullopt;
  return Finding{"state-after-reset",
                 fmt::format("after reset() step {} gives ({:.4g}, {:.4g}, {:.4g}) N, a new renderer gives ({:.4g}, "
                             "{:.4g}, {:.4g}) N",
                             *differs, after[*differs].x(), after[*differs].y(), after[*differs].z(),
                             expected[*differs].x(), expected[*differs].y(), expected[*differs].z()),
                 "a stroke over a ball 20 mm in radius broken off in contact, then reset() and other strokes",
                 (after[*differs] - expected[*differs]).norm(), "N"};
}

std::optional<Finding> find_shared_state(const Engine& engine) {
  constexpr std::size_t count = 2;
  const auto surface = make_embree_surface(round_body());
  std::array<std::unique_ptr<Renderer>, count> renderers;
  std::array<std::vector<Vec3>, count> tips;
  std::array<std::vector<Vec3>, count> expected;
  for (std::size_t k = 0; k < count; ++k) {
    renderers[k] = engine.make(surface, 1.0);
    tips[k] = strokes_about(engine.tip_radius_m, 206 + k, 40);
    expected[k] = forces(*renderers[k], tips[k]);
  }
  const auto report = [&](std::size_t k, std::size_t step, const char* how) {
    return Finding{"shared-state",
                   fmt::format("two renderers on one surface disturb one another: {}, step {} of number {} gives "
                               "another force than alone",
                               how, step, k + 1),
                   "two renderers on one ball 20 mm in radius, each with strokes of its own", 0.0, "N"};
  };
  // Step by step in turn: what is shared between steps shows every time.
  for (const auto& renderer : renderers) renderer->reset();
  for (std::size_t i = 0; i < tips[0].size(); ++i) {
    for (std::size_t k = 0; k < count; ++k) {
      if (!(step_to(*renderers[k], i, tips[k][i]).f_W_N == expected[k][i])) return report(k, i, "in turn");
    }
  }
  // At the same time: what is shared within a step shows sooner or later. Neither ends while the other has rounds to
  // go: on one processor each may have run alone until then.
  std::array<std::optional<std::size_t>, count> differs;
  std::atomic<int> going = count;
  std::array<std::exception_ptr, count> broke_down;  // no exception leaves a thread
  const auto run = [&](std::size_t k) {
    try {
      for (int round = 1; going > 0 && !differs[k]; ++round) {
        differs[k] = first_difference(forces(*renderers[k], tips[k]), expected[k]);
        if (round == 40) --going;
      }
    } catch (...) {
      broke_down[k] = std::current_exception();
    }
    going = 0;
  };
  {
    std::jthread other([&] { run(1); });
    run(0);
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (broke_down[k]) std::rethrow_exception(broke_down[k]);
    if (differs[k]) return report(k, *differs[k], "in two threads");
  }
  return std::nullopt;
}

std::optional<Finding> find_growing_cost(const Engine& engine) {
  const std::size_t count = std::max<std::size_t>(affordable_rounds(engine, 200'000), 20);
  Costs costs;
  // A measurement may be disturbed for as long as it takes; growth is there again.
  for (int attempt = 0; attempt < 3; ++attempt) {
    costs = fastest_rounds(engine, count);
    if (costs.late_s <= 2.0 * costs.early_s) return std::nullopt;
  }
  return Finding{
      "growing-cost",
      fmt::format("a step costs {:.3g} us at the beginning of a run and {:.3g} us after {} steps",
                  1e6 * costs.early_s / Rounds::length, 1e6 * costs.late_s / Rounds::length, count * Rounds::length),
      "the same round over a block 40 mm wide, again and again", costs.late_s / costs.early_s, "1"};
}

std::optional<Finding> find_late_spike(const Engine& engine) {
  const std::size_t count = affordable_rounds(engine, 1'200'000) * Rounds::length;
  double usual_s = 0.0;
  // An interrupt hits any step; the renderer's own spike hits the same one in every run, and takes the thread's own
  // time there. On a busy machine some steps are hit again, the first of a round most of all.
  constexpr int runs = 3;
  std::vector<std::size_t> slow = slow_steps(engine, count, usual_s);
  for (int run = 1; run < runs && !slow.empty(); ++run) {
    const auto other = slow_steps(engine, count, usual_s);
    std::erase_if(slow, [&](std::size_t step) { return !std::ranges::binary_search(other, step); });
  }
  double least_s = 0.0;
  for (int run = 0; run < runs && !slow.empty(); ++run) {
    const auto cost_s = own_cost_s(engine, slow);
    std::vector<std::size_t> again;
    for (std::size_t i = 0; i < slow.size(); ++i) {
      if (!(cost_s[i] > 0.5 * slow_from_s(usual_s))) continue;
      if (again.empty()) least_s = run == 0 ? cost_s[i] : std::min(least_s, cost_s[i]);
      again.push_back(slow[i]);
    }
    slow = std::move(again);
  }
  if (slow.empty()) return std::nullopt;
  return Finding{"late-spike",
                 fmt::format("step {} costs {:.3g} us where others cost {:.3g} us, in every run", slow.front(),
                             1e6 * least_s, 1e6 * usual_s),
                 fmt::format("the same round over a block 40 mm wide, {} steps", count), 1e6 * least_s, "us"};
}

}  // namespace touchstone::renderer_faults
