// A model of program, guard, driver, rescuer and device, checked exhaustively: every interleaving of their steps, with
// every combination of faults that the budget allows. The model says what each process does as guardian.h describes it;
// it knows nothing of time, so "in the end" stands for the bounds that guard_fault_table_test.cc measures.
#include "safety/guard_transitions.h"

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
  bool zombie = false;       // the driver is dead and the kernel has not forgotten it: a locked device does not open
  bool opening = false;      // a slow device is being opened anew; another attempt may begin meanwhile
  bool force_on = false;     // the device pushes
  bool flag = false;         // the guard's note that it let a force pass
  bool device_obeys = true;  // a zero, from any process
  std::uint8_t faults_left = 0;
  bool faults_in_rescue = true;  // they strike while the force is being taken back, too
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

void kill_driver(World& w) {
  if (w.driver != Life::dead) w.zombie = true;
  w.driver = Life::dead;
}

// What guard and rescuer do in a rescue: open the device anew, slow as it may be, and bring it to zero; a device that
// is locked by a zombie's number refuses, and is tried again.
void attempts(const World& w, std::vector<Step>& steps) {
  if (w.phase != GuardPhase::rescue && w.phase != GuardPhase::unconfirmed) return;
  World to = w;
  if (w.zombie) {
    to.phase = GuardPhase::unconfirmed;
  } else if (!w.opening) {
    to.opening = true;
    to.phase = GuardPhase::unconfirmed;  // it takes so long that the program is told
  } else {
    zero_by_any(to);
    to.opening = false;
    if (!to.force_on) to.flag = false, to.phase = GuardPhase::off;
  }
  steps.push_back({to});
}

void guard_steps(const World& w, std::vector<Step>& steps) {
  if (w.guard != Life::well) return;
  const auto add = [&](World to) { steps.push_back({to}); };
  if (!tripped(w)) {
    if (w.program == Life::well && w.rescuer == Life::well) {
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
      add(let_go(w));  // no command came in time, or the rescuer is gone or shows no sign of life
    }
    return;
  }
  if (w.phase == GuardPhase::letting_go) {
    World to = w;
    if (w.driver == Life::well && w.device_obeys) {
      to.force_on = false, to.flag = false, to.phase = GuardPhase::off;
    } else {
      to.phase = GuardPhase::rescue;
      kill_driver(to);
    }
    add(to);
  }
  attempts(w, steps);
}

void kernel_steps(const World& w, std::vector<Step>& steps) {
  // The driver's parent, the guard, ignores SIGCHLD: the kernel forgets the driver whether the guard runs or not. If
  // the guard is dead, the system's first process reaps.
  if (!w.zombie) return;
  World to = w;
  to.zombie = false;
  steps.push_back({to});
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
  if (w.rescuer != Life::well || w.phase == GuardPhase::off) return;
  attempts(w, steps);
  if (w.phase == GuardPhase::rescue || w.phase == GuardPhase::unconfirmed || w.guard == Life::well || !w.flag) return;
  World to = w;
  if (w.guard == Life::dead && w.driver == Life::well && !w.force_on) {
    to.flag = false, to.phase = GuardPhase::off;  // the driver let go by itself
    steps.push_back({to});
  }
  to = w;
  kill_driver(to);
  to.guard = Life::dead;
  to.phase = GuardPhase::rescue;
  steps.push_back({to});
}

void faults(const World& w, std::vector<Step>& steps) {
  if (w.faults_left == 0 || (tripped(w) && !w.faults_in_rescue)) return;
  World base = w;
  --base.faults_left;
  for (Life World::*who : {&World::program, &World::guard, &World::driver, &World::rescuer}) {
    for (const Life how : {Life::blocked, Life::dead}) {
      if (w.*who >= how) continue;
      World to = base;
      to.*who = how;
      if (who == &World::driver && how == Life::dead) to.zombie = true;
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
  kernel_steps(w, steps);
  std::erase_if(steps, [&](const Step& s) { return s.to == w; });
  faults(w, steps);
  return steps;
}

std::set<World> reachable(std::uint8_t faults_left, bool in_rescue = true) {
  World first;
  first.faults_left = faults_left;
  first.faults_in_rescue = in_rescue;
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
        EXPECT_EQ(w.rescuer, Life::well) << "nothing is pushed without the rescuer: " << say(w);
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
                       w.rescuer != Life::well;
    if (!w.force_on || !wrong) continue;
    ++on;
    const bool nobody = w.guard != Life::well && w.rescuer != Life::well && w.driver != Life::well;
    const bool stays = may_stay_on(w, known);
    left_on += stays;
    if (stays) {
      EXPECT_TRUE(!w.device_obeys || nobody) << say(w);
    }
  }
  EXPECT_GT(on, 100);
  EXPECT_GT(left_on, 0) << "with everybody dead the force must stay, or this model shows nothing";
}

// Any two faults of processes leave nobody with a force: one of guard, rescuer and driver is left. A fault of the last
// one while it takes the force back is not among them: the others were ended by then, so that they cannot push again.
TEST(GuardModel, NoTwoFaultsLeaveAForce) {
  std::map<World, int> known;
  for (const World& w : reachable(2, false)) {
    if (!w.device_obeys) continue;
    const bool wrong = tripped(w) || w.program != Life::well || w.guard != Life::well || w.driver != Life::well ||
                       w.rescuer != Life::well;
    if (w.force_on && wrong) {
      EXPECT_FALSE(may_stay_on(w, known)) << say(w);
    }
  }
}

}  // namespace
}  // namespace touchstone::hil
