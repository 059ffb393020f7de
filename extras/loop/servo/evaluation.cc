#include "servo/evaluation.h"

#include <fmt/format.h>

#include <algorithm>

namespace touchstone::servo {
namespace {

constexpr double largest_margin = 1024.0;

double margin_of(rendering::Renderer& renderer, const MotionColumns& path, LoopParameters own, Verdict verdict,
                 const perception::Thresholds& thresholds) {
  if (verdict == Verdict::cannot_tell) return 0.0;
  const auto stable = [&](double gain) {
    own.force_gain = gain;
    return judge_loop(renderer, path, own, thresholds).verdict == Verdict::stable;
  };
  // From 1 in factors of 2 to where it changes, so that long paths are run a few times only.
  double edge = 1.0;
  if (verdict == Verdict::stable) {
    while (edge < largest_margin && stable(2.0 * edge)) edge *= 2.0;
    return edge >= largest_margin ? edge : largest_stable(edge, 2.0 * edge, stable);
  }
  while (edge > 1.0 / largest_margin) {
    edge *= 0.5;
    if (stable(edge)) return largest_stable(edge, 2.0 * edge, stable);
  }
  return 0.0;
}

// The larger, the worse.
double badness(const MassRun& run) {
  constexpr double unstable_ratio = 1e6;
  return run.judgement.buzz.jnd + (run.judgement.verdict == Verdict::unstable ? unstable_ratio : 0.0);
}

std::string sentence_of(const LoopEvaluation& evaluation) {
  if (evaluation.runs.size() == 1) return sentence(evaluation.runs.front().judgement);
  std::string each;
  for (const MassRun& run : evaluation.runs)
    each += fmt::format("{}{:g} kg: {}", each.empty() ? "" : ", ", run.device_mass_kg, name_of(run.judgement.verdict));
  const bool none_can = std::ranges::all_of(
      evaluation.runs, [](const MassRun& run) { return run.judgement.verdict == Verdict::cannot_tell; });
  if (none_can) return sentence(evaluation.worst().judgement);
  if (evaluation.verdict == Verdict::cannot_tell)
    return fmt::format("Cannot tell: the device's mass is not published, and it matters ({}).", each);
  return fmt::format("{} Of masses from {:g} to {:g} kg, since the device's is not published, this is the worst.",
                     sentence(evaluation.worst().judgement), evaluation.runs.front().device_mass_kg,
                     evaluation.runs.back().device_mass_kg);
}

}  // namespace

const MassRun& LoopEvaluation::worst() const { return *std::ranges::max_element(runs, {}, badness); }

Judgement judge_loop(rendering::Renderer& renderer, const MotionColumns& path, const LoopParameters& parameters,
                     const perception::Thresholds& thresholds) {
  LoopRuns runs = run_for_judgement(renderer, path, parameters);
  const Judgement out = judge(runs, thresholds);
  if (out.verdict != Verdict::buzzes) return out;
  run_encoder(runs, renderer, path, parameters);
  return judge(runs, thresholds);
}

LoopEvaluation evaluate_loop(rendering::Renderer& renderer, const MotionColumns& path, const LoopSetup& setup,
                             const perception::Thresholds& thresholds) {
  LoopEvaluation out;
  double simulated_s = 0.0, elapsed_s = 0.0;
  std::vector<Verdict> verdicts;
  for (const double mass_kg : setup.device_masses_kg) {
    const LoopParameters own = setup.with_mass(mass_kg);
    MassRun run;
    run.device_mass_kg = mass_kg;
    LoopRuns runs = run_for_judgement(renderer, path, own);
    run_encoder(runs, renderer, path, own);
    const double of_run_s = static_cast<double>(runs.run.size()) * own.period_s;
    simulated_s += of_run_s;
    elapsed_s += of_run_s / runs.real_time_factor;
    run.judgement = judge(runs, thresholds);
    run.run = std::move(runs.run);
    run.ideal = std::move(runs.ideal);
    run.open = std::move(runs.open);
    run.stable_margin = margin_of(renderer, path, own, run.judgement.verdict, thresholds);
    verdicts.push_back(run.judgement.verdict);
    out.runs.push_back(std::move(run));
  }
  out.real_time_factor = elapsed_s > 0.0 ? simulated_s / elapsed_s : 0.0;
  out.verdict = agreed(verdicts);
  out.stable_margin = std::ranges::min(out.runs, {}, &MassRun::stable_margin).stable_margin;
  out.sentence = sentence_of(out);
  return out;
}

}  // namespace touchstone::servo
