#include "harness/renderer_faults/diagnosis.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <map>
#include <utility>

#include "harness/base/error.h"
#include "harness/renderer_faults/detectors.h"
#include "harness/renderer_faults/force_law.h"
#include "harness/renderer_faults/other_engines.h"
#include "harness/renderer_faults/timing.h"

namespace touchstone::renderer_faults {

namespace {

constexpr const char* over_one_place = "a block 40 mm wide, the tip over one place jumping between 0.2 and 1 mm deep";

// The finding of an engine's timing, if its name is this.
std::optional<Finding> timing_finding(const Timing& timing, const std::string& name) {
  if (timing.fault() != name) return std::nullopt;
  const bool change = timing.kind == TimingKind::clipped;
  const bool period = timing.kind == TimingKind::held;
  return Finding{name,
                 timing.what,
                 over_one_place,
                 change   ? timing.per_sample_N
                 : period ? timing.period_samples
                          : timing.lag_samples,
                 change ? "N" : "samples",
                 "",
                 timing.considered};
}

Detector timing_detector(const std::string& name, const std::string& summary) {
  return {name,
          summary,
          {},
          [name](const Engine& engine) { return timing_finding(identify_timing(engine), name); },
          DetectorKind::timing};
}

// What a cause does that no map of the force says.
using Consequences = std::map<std::string, std::vector<std::string>>;
const Consequences& consequences() {
  static const Consequences table{
      {"one-bad-face", {"jump-between-triangles", "energy-gained"}},
      {"hysteresis",
       {"energy-gained", "noise", "sticks-at-flat-edges", "sticks-at-joints", "jump-between-triangles",
        "ball-at-edge"}},
      {"place-dependent",
       {"wrong-frame", "sticks-at-flat-edges", "sticks-at-joints", "noise", "energy-gained", "jump-between-triangles",
        "ball-at-edge"}},
      {"falls-through-block", {"pops-through-shell", "ball-at-edge"}},
      {"gap-at-contact", {"energy-gained", "ball-at-edge", "friction-lost"}},
  };
  return table;
}

constexpr std::array of_axes{"mirrored-axis", "exchanged-axes", "lost-axis"};

// What a force does that turns otherwise than the world: after what explains this by itself.
const Consequences& consequences_of_frames() {
  static const Consequences table{
      {"wrong-frame",
       {"sticks-at-joints", "sticks-at-flat-edges", "jump-between-triangles", "energy-gained", "ball-at-edge"}}};
  return table;
}

// Detectors on one engine, and what their findings follow from. The causes are looked for once, when they are asked
// for.
class Judge {
 public:
  explicit Judge(const Engine& engine) : engine_(engine) {}

  void examine(const Detector& detector) {
    for (const rendering::Ability ability : detector.needs) {
      if (const rendering::Limitation* const declared = find_limitation(engine_.cannot, ability)) {
        diagnosis_.declared.emplace_back(detector.name, declared->reason);
        return;
      }
    }
    try {
      auto finding = find(detector);
      if (finding && detector.kind == DetectorKind::said) {
        diagnosis_.said.push_back(std::move(*finding));
      } else if (finding) {
        diagnosis_.findings.push_back(std::move(*finding));
      } else if (detector.name == "delay" && timing().declared) {
        diagnosis_.declared.emplace_back(detector.name, timing().what);
      } else {
        diagnosis_.clean.push_back(detector.name);
      }
    } catch (const std::exception& error) {
      diagnosis_.failed.emplace_back(detector.name, error.what());
    }
  }

  Diagnosis done() {
    std::stable_partition(diagnosis_.findings.begin(), diagnosis_.findings.end(),
                          [](const Finding& one) { return one.follows_from.empty(); });
    return std::move(diagnosis_);
  }

 private:
  const Timing& timing() {
    if (!timing_) timing_ = identify_timing(engine_);
    return *timing_;
  }
  Engine settled() {
    Engine resting = engine_;
    resting.settle_samples = timing().settle_samples;
    return resting;
  }
  const ForceFaults& force_faults() {
    if (!force_faults_) force_faults_ = identify_force_map(settled());
    return *force_faults_;
  }
  // Causes by name, each looked for once. One that the engine declares is none.
  const std::optional<Finding>& cause(const Detector& detector) {
    const auto known = causes_.find(detector.name);
    if (known != causes_.end()) return known->second;
    std::optional<Finding> finding;
    if (detector.kind == DetectorKind::timing) finding = timing_finding(timing(), detector.name);
    if (detector.kind == DetectorKind::events) finding = detector.find(engine_);
    if (detector.kind == DetectorKind::settled || detector.kind == DetectorKind::moving)
      finding = detector.find(settled());
    return causes_[detector.name] = std::move(finding);
  }
  const std::optional<Finding>& found_cause(const std::string& name) {
    static const std::optional<Finding> none;
    const Detector& detector = find_detector(name);
    for (const rendering::Ability ability : detector.needs) {
      if (find_limitation(engine_.cannot, ability) != nullptr) return none;
    }
    return cause(detector);
  }

  std::optional<Finding> find(const Detector& detector) {
    switch (detector.kind) {
      case DetectorKind::running:
      case DetectorKind::said:
        return detector.find(engine_);
      case DetectorKind::timing:
      case DetectorKind::events:
        return cause(detector);
      case DetectorKind::settled: {
        auto finding = cause(detector);
        if (!finding) return finding;
        finding->considered = other_maps(detector.name);
        finding->follows_from = origin(detector, *finding);
        return finding;
      }
      case DetectorKind::moving:
        break;
    }
    auto finding = detector.find(engine_);
    if (!finding) return finding;
    if (timing().settle_samples > 0) {
      auto at_rest = detector.find(settled());
      if (!at_rest) {
        finding->follows_from = timing().fault();
        // A damper's moving force is its own; energy is that of the moving tip.
        if (timing().declared || (finding->follows_from.empty() && detector.name != "energy-gained"))
          return std::nullopt;
        return finding;
      }
      finding = std::move(at_rest);
      if (const std::string fault = timing().fault(); !fault.empty())
        finding->considered.emplace_back(fault, "it is still there once the tip rests");
    }
    finding->follows_from = origin(detector, *finding);
    return finding;
  }

  // Of a fault of the force's map: what a map of another kind leaves.
  std::vector<std::pair<std::string, std::string>> other_maps(const std::string& name) {
    const bool axes = std::ranges::find(of_axes, name) != of_axes.end();
    if (!axes && name != "saturation" && name != "quantised") return {};
    const ForceFaults& faults = force_faults();
    std::vector<std::pair<std::string, std::string>> others;
    const auto add = [&](const char* other, const char* map, double leaves) {
      if (std::isfinite(leaves)) others.emplace_back(other, fmt::format("{} leaves {:.2g} %", map, 100.0 * leaves));
    };
    if (!axes) add("mirrored-axis", "the best order and signs of the axes", faults.axes_leave);
    if (name != "saturation") add("saturation", "the best limit", faults.limits_leave);
    if (name != "quantised") add("quantised", "the best step", faults.steps_leave);
    return others;
  }

  // The cause that shows this fault in a right renderer, too, or must show it; those that do not are noted as
  // considered.
  std::string origin(const Detector& detector, Finding& finding) {
    const auto rejected = [&](const std::string& name, const char* why) { finding.considered.emplace_back(name, why); };
    if (found_cause("dropout")) {
      if (!detector.find(asked_again(settled()))) return "dropout";
      rejected("dropout", "it is still there when lost samples are asked again");
    }
    if (detector.name != "one-bad-face" && found_cause("one-bad-face")) {
      for (const double share : {0.31, 0.5, 0.77}) {
        if (!detector.find(counted_from(settled(), share))) return "one-bad-face";
      }
      rejected("one-bad-face", "it is still there when the triangles are counted from another one");
    }
    if (auto name = listed_cause(detector, consequences()); !name.empty()) return name;
    if (auto name = map_that_shows(detector, finding); !name.empty()) return name;
    return listed_cause(detector, consequences_of_frames());
  }

  // The first cause of the list that is there and must show this fault.
  std::string listed_cause(const Detector& detector, const Consequences& list) {
    for (const auto& [name, follow] : list) {
      if (name != detector.name && std::ranges::find(follow, detector.name) != follow.end() && found_cause(name))
        return name;
    }
    return "";
  }

  // The map that found causes say, by their names.
  std::vector<std::pair<std::string, ForceMap>> found_maps() {
    const ForceFaults& faults = force_faults();
    std::vector<std::pair<std::string, ForceMap>> maps;
    if (faults.axes) {
      for (const char* const name : of_axes) {
        if (found_cause(name)) maps.emplace_back(name, faults.map.axes_alone());
      }
    }
    if (faults.saturated) {
      ForceMap clipped;
      clipped.limited = faults.map.limited;
      clipped.least_N = faults.map.least_N;
      clipped.most_N = faults.map.most_N;
      clipped.limit_N = faults.map.limit_N;
      maps.emplace_back("saturation", clipped);
    }
    if (faults.quantised) {
      ForceMap steps;
      steps.step_N = faults.map.step_N;
      steps.rounding = faults.map.rounding;
      maps.emplace_back("quantised", steps);
    }
    return maps;
  }

  std::string map_that_shows(const Detector& detector, Finding& finding) {
    const auto maps = found_maps();
    // A map is no consequence of itself, nor of another name of the same map.
    if (std::ranges::find(maps, detector.name, &std::pair<std::string, ForceMap>::first) != maps.end()) return "";
    for (const auto& [name, map] : maps) {
      const auto undo = map.inverse();
      if (undo && !detector.find(with_map(settled(), *undo))) return name;
      if (detector.name == "ball-at-edge" && !find_ball_at_edge_under(settled(), map)) return name;
    }
    const auto* const noise = detector.name == "noise" ? nullptr : &found_cause("noise");
    const bool noisy = noise != nullptr && noise->has_value();
    const Engine right = reference_engine(engine_);
    if ((maps.empty() && !noisy) || detector.find(right)) return "";
    for (const auto& [name, map] : maps) {
      if (detector.find(with_map(right, map))) return name;
    }
    if (noisy && detector.find(with_noise(right, (*noise)->value))) return "noise";
    for (const auto& [name, map] : maps)
      finding.considered.emplace_back(name, "a right renderer with it does not show this");
    if (noisy) finding.considered.emplace_back("noise", "a right renderer with such noise does not show this");
    return "";
  }

  Engine engine_;
  Diagnosis diagnosis_;
  std::optional<Timing> timing_;
  std::optional<ForceFaults> force_faults_;
  std::map<std::string, std::optional<Finding>> causes_;
};

}  // namespace

const std::vector<Detector>& detectors() {
  using enum rendering::Ability;
  using enum DetectorKind;
  static const std::vector<Detector> list{
      timing_detector("held-answer", "an answer is given again until the next update"),
      timing_detector("delay", "every answer is that of an earlier tip"),
      timing_detector("alternate-lag", "some samples of a period are late"),
      timing_detector("jitter", "samples are late without a period"),
      timing_detector("filter", "the force is low-pass filtered"),
      timing_detector("clipped-rate", "the force changes by no more than a figure from sample to sample"),
      {"dropout", "single samples without force", {}, find_dropout, events},
      {"mirrored-axis", "the force has the wrong sign along an axis", {}, find_mirrored_axis, settled},
      {"exchanged-axes", "one axis of the force stands in the place of another", {}, find_exchanged_axes, settled},
      {"lost-axis", "the force is 0 along an axis", {}, find_lost_axis, settled},
      {"saturation", "the force exceeds no figure, by axis or by magnitude", {}, find_saturation, settled},
      {"quantised", "the force comes in steps", {}, find_quantised, settled},
      {"place-dependent", "the same depth gives another force elsewhere", {}, find_place_dependent, settled},
      {"rate-dependent", "the force is another one in a loop of another rate", {}, find_rate_dependent, settled},
      {"hysteresis", "the force is another one when released than when pressed", {}, find_hysteresis, settled},
      {"one-bad-face",
       "single faces answer otherwise than their neighbours",
       {surface_contact},
       find_one_bad_face,
       settled},
      {"falls-through-block", "a tip deep in a thick block is lost", {}, find_falls_through_block, settled},
      {"wrong-frame", "the force turns with the tip, or does not turn with the world", {}, find_wrong_frame},
      {"sticks-at-joints",
       "a sideways force where two bodies touch or overlap with flush tops",
       {surface_contact, continuous_force},
       find_sticks_at_joints},
      {"sticks-at-flat-edges",
       "a sideways force where two nearly coplanar faces meet",
       {surface_contact},
       find_sticks_at_flat_edges},
      {"pops-through-shell",
       "a tip pushed slowly through a plate comes out below",
       {thin_shells},
       find_pops_through_shell},
      {"untouchable-triangles",
       "triangles below a size are not felt, at some unit of length",
       {unit_scale},
       find_untouchable_triangles},
      {"jump-between-triangles", "the force jumps from one triangle to its neighbour", {}, find_jump_between_triangles},
      {"ball-at-edge",
       "a ball hangs behind where it slides over a sharp convex edge",
       {surface_contact, ball_tip},
       find_ball_at_edge},
      {"friction-lost",
       "no tangential force, or less than half of what is declared, at some unit of length",
       {},
       find_friction_lost},
      {"energy-gained", "a closed path gives energy to the hand", {passive}, find_energy_gained},
      {"gap-at-contact",
       "contact does not begin at the surface and without a jump",
       {surface_contact},
       find_gap_at_contact},
      {"late-contact",
       "contact begins late by no more than is declared: no fault",
       {surface_contact},
       find_late_contact,
       said},
      {"standoff", "the surface contact point floats above the surface", {surface_contact}, find_standoff},
      {"tie-break",
       "exactly in a wall's plane, or between two, another answer than beside it",
       {},
       find_tie_break,
       settled},
      {"noise", "the force changes while the tip rests, or saws while it slides over a plane", {}, find_noise},
      {"state-after-reset",
       "a run after reset() is not the run of a new renderer",
       {},
       find_state_after_reset,
       running},
      {"shared-state", "two renderers on one surface disturb one another", {}, find_shared_state, running},
      {"allocation", "a step allocates memory", {}, find_allocation, running},
      {"growing-cost", "a step costs more the longer the run", {}, find_growing_cost, running},
      {"late-spike", "a step after many costs a multiple of the others", {}, find_late_spike, running},
  };
  return list;
}

const Detector& find_detector(const std::string& name) {
  std::string known;
  for (const Detector& detector : detectors()) {
    if (detector.name == name) return detector;
    known += ' ' + detector.name;
  }
  throw UsageError("there is no detector '" + name + "'; there are:" + known);
}

Diagnosis diagnose(const Engine& engine) {
  Judge judge(engine);
  for (const Detector& detector : detectors()) judge.examine(detector);
  return judge.done();
}

Diagnosis diagnose(const Engine& engine, const std::vector<std::string>& names) {
  Judge judge(engine);
  for (const std::string& name : names) judge.examine(find_detector(name));
  return judge.done();
}

}  // namespace touchstone::renderer_faults
