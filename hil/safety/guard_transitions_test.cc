// A model of program, guard, driver, rescuer and device, checked exhaustively: every interleaving of their steps, with
// every combination of faults that the budget allows. The model says what each process does as guardian.h describes it;
// it knows nothing of time, so "in the end" stands for the bounds that guard_fault_table_test.cc measures.
#include "hil/safety/guard_transitions.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <compare>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace touchstone::hil {
namespace {

enum class Life : std::uint8_t { well, blocked, dead };

struct World {
  GuardPhase phase = GuardPhase::at_zero;
  Life program = Life::well, guard = Life::well, driver = Life::well, rescuer = Life::well;
  bool force_on = false;      // the device pushes
  bool flag = false;          // the guard's note that it let a force pass
  bool rescue_asked = false;  // by the guard
  bool device_obeys = true;   // a zero, from any process
  std::uint8_t faults_left = 0;
  auto operator<=>(const World&) const = default;
};

std::string say(const World& w) {
  constexpr const char* lives[] = {"well", "blocked", "dead"};
  const auto life = [&](Life l) { return lives[static_cast<std::size_t>(l)]; };
  return fmt::format("{}: program {}, guard {}, driver {}, rescuer {}, force {}, device {}", to_string(w.phase),
                     life(w.program), life(w.guard), life(w.driver), life(w.rescuer), w.force_on ? "on" : "zero",
                     w.device_obeys ? "obeys" : "does not obey");
}

struct Step {
  World to;
  bool fault = false;
};

bool tripped(const World& w) { return w.phase != GuardPhase::at_zero && w.phase != GuardPhase::pushing; }

void zero_by_any(World& w) {
  if (w.device_obeys) w.force_on = false;
}

// What the guard does in letting go.
World let_go(World w) {
  w.phase = GuardPhase::letting_go;
  return w;
}

void guard_steps(const World& w, std::vector<Step>& steps) {
  if (w.guard != Life::well) return;
  const auto add = [&](World to) { steps.push_back({to}); };
  if (!tripped(w)) {
    if (w.program == Life::well && w.rescuer != Life::dead) {
      if (w.driver == Life::well) {
        // The note comes before the command, as a process of its own could die in between.
        World noted = w;
        noted.flag = true, noted.phase = GuardPhase::pushing;
        add(noted);
        if (w.flag && may_push(w.phase)) {
          World pushed = w;
          pushed.force_on = true;
          add(pushed);
          World rested = w;
          zero_by_any(rested);
          if (!rested.force_on) {
            rested.flag = false, rested.phase = GuardPhase::at_zero;
            add(rested);
          }
        }
        add(let_go(w));  // a limit does not hold
      } else {
        add(let_go(w));  // the driver does not answer
      }
    } else if (w.flag || w.rescuer == Life::dead) {
      add(let_go(w));  // no command came in time, or the rescuer is gone
    }
    return;
  }
  if (w.phase == GuardPhase::letting_go) {
    World to = w;
    if (w.driver == Life::well && w.device_obeys) {
      to.force_on = false, to.flag = false, to.phase = GuardPhase::off;
    } else {
      to.phase = GuardPhase::rescue;
    }
    add(to);
  }
}

void driver_steps(const World& w, std::vector<Step>& steps) {
  // Silence of the guard, or its end: the driver brings the device to zero by itself.
  if (w.driver == Life::well && w.guard != Life::well && w.force_on && w.device_obeys) {
    World to = w;
    to.force_on = false;
    steps.push_back({to});
  }
}

void rescuer_steps(const World& w, std::vector<Step>& steps) {
  if (w.rescuer != Life::well || w.phase == GuardPhase::off || w.phase == GuardPhase::unconfirmed) return;
  if (w.phase == GuardPhase::rescue) {
    // It ended the driver, and opens the device in a fresh process.
    World to = w;
    to.driver = Life::dead;
    zero_by_any(to);
    to.phase = to.force_on ? GuardPhase::unconfirmed : GuardPhase::off;
    if (!to.force_on) to.flag = false;
    steps.push_back({to});
    return;
  }
  if (w.guard == Life::well || !w.flag) return;
  World to = w;
  if (w.guard == Life::dead && w.driver == Life::well && !w.force_on) {
    to.flag = false, to.phase = GuardPhase::off;  // the driver let go by itself
    steps.push_back({to});
  }
  to = w;
  to.guard = to.driver = Life::dead;
  to.phase = GuardPhase::rescue;
  steps.push_back({to});
}

void faults(const World& w, std::vector<Step>& steps) {
  if (w.faults_left == 0) return;
  World base = w;
  --base.faults_left;
  for (Life World::*who : {&World::program, &World::guard, &World::driver, &World::rescuer}) {
    for (const Life how : {Life::blocked, Life::dead}) {
      if (w.*who >= how) continue;
      World to = base;
      to.*who = how;
      steps.push_back({to, true});
    }
  }
  if (w.device_obeys) {
    World to = base;
    to.device_obeys = false;
    steps.push_back({to, true});
  }
}

std::vector<Step> steps_from(const World& w) {
  std::vector<Step> steps;
  guard_steps(w, steps);
  driver_steps(w, steps);
  rescuer_steps(w, steps);
  std::erase_if(steps, [&](const Step& s) { return s.to == w; });
  faults(w, steps);
  return steps;
}

std::set<World> reachable(std::uint8_t faults_left) {
  World first;
  first.faults_left = faults_left;
  std::set<World> seen{first};
  std::vector<World> open{first};
  while (!open.empty()) {
    const World w = open.back();
    open.pop_back();
    for (const Step& step : steps_from(w)) {
      if (seen.insert(step.to).second) open.push_back(step.to);
    }
  }
  return seen;
}

constexpr std::uint8_t most_faults = 5;  // each of the four processes and the device

TEST(GuardModel, TakesOnlyAllowedStepsAndNeverPushesAgain) {
  const auto worlds = reachable(most_faults);
  EXPECT_GT(worlds.size(), 500U) << "the model hardly moves";
  std::set<GuardPhase> phases;
  for (const World& w : worlds) {
    phases.insert(w.phase);
    for (const Step& step : steps_from(w)) {
      EXPECT_TRUE(may_follow(w.phase, step.to.phase)) << say(w) << " -> " << say(step.to);
      if (!w.force_on && step.to.force_on) {
        EXPECT_TRUE(may_push(w.phase)) << say(w);
        EXPECT_NE(w.rescuer, Life::dead) << "nothing is pushed without the rescuer: " << say(w);
      }
      if (tripped(w)) {
        EXPECT_TRUE(tripped(step.to)) << say(w) << " -> " << say(step.to);
      }
      // The rescuer acts by the note: a force without it would be nobody's.
      if (step.to.force_on && step.to.guard == Life::well) {
        EXPECT_TRUE(step.to.flag || tripped(step.to)) << say(step.to);
      }
    }
    if (w.phase == GuardPhase::off) {
      EXPECT_FALSE(w.force_on) << say(w);
    }
  }
  for (const GuardPhase phase : {GuardPhase::at_zero, GuardPhase::pushing, GuardPhase::letting_go, GuardPhase::rescue,
                                 GuardPhase::off, GuardPhase::unconfirmed}) {
    EXPECT_TRUE(phases.contains(phase)) << to_string(phase);
  }
}

// Whether some run without further faults keeps the force on for ever: it comes to rest, or goes in a circle, with it.
bool may_stay_on(const World& w, std::map<World, int>& known) {
  if (!w.force_on) return false;
  const auto [at, is_new] = known.insert({w, 2});  // 2: on the path, 0 and 1: known
  if (!is_new) return at->second != 0;
  bool stays = false, ends_here = true;
  for (const Step& step : steps_from(w)) {
    if (step.fault) continue;
    ends_here = false;
    stays = stays || may_stay_on(step.to, known);
  }
  stays = stays || ends_here;
  known[w] = stays ? 1 : 0;
  return stays;
}

// Where something is wrong (a process is not well, or the guard let go), the force stays on only if the device does not
// obey, or if nobody is left who could act. Both are for the device's own watchdog and the physical switch.
TEST(GuardModel, EveryForceIsTakenBackWhileAnybodyIsLeft) {
  std::map<World, int> known;
  int on = 0, left_on = 0;
  for (const World& w : reachable(most_faults)) {
    const bool wrong = tripped(w) || w.program != Life::well || w.guard != Life::well || w.driver != Life::well ||
                       w.rescuer == Life::dead;
    if (!w.force_on || !wrong) continue;
    ++on;
    const bool nobody =
        w.rescuer != Life::well &&
        (w.driver != Life::well || (w.guard == Life::well && tripped(w) && w.phase != GuardPhase::letting_go));
    const bool stays = may_stay_on(w, known);
    left_on += stays;
    if (stays) {
      EXPECT_TRUE(!w.device_obeys || nobody) << say(w);
    }
  }
  EXPECT_GT(on, 100);
  EXPECT_GT(left_on, 0) << "with everybody dead the force must stay, or this model shows nothing";
}

// Any single fault of a process leaves nobody with a force.
TEST(GuardModel, NoSingleFaultLeavesAForce) {
  std::map<World, int> known;
  for (const World& w : reachable(1)) {
    if (w.faults_left > 0 || !w.device_obeys) continue;
    const bool wrong = tripped(w) || w.program != Life::well || w.guard != Life::well || w.driver != Life::well ||
                       w.rescuer == Life::dead;
    if (w.force_on && wrong) {
      EXPECT_FALSE(may_stay_on(w, known)) << say(w);
    }
  }
}

}  // namespace
}  // namespace touchstone::hil
