#include "harness/discrepancy/model_edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "harness/base/error.h"

namespace touchstone::discrepancy {
using rendering::Model;
using rendering::NamedParameters;

namespace {

constexpr const char* path_name = "presliding_m";
constexpr const char* window_name = "window_s";

}  // namespace

FreeParameter base_stiffness(const Model& start) {
  const auto given = start.parameters.find("stiffness_N_per_m");
  if (given == start.parameters.end()) {
    throw BadData(fmt::format("{}: /parameters: stiffness_N_per_m is needed: it is fitted together with every effect",
                              start.source));
  }
  return log_base_parameter("stiffness_N_per_m", 0.1 * given->second, 10.0 * given->second);
}

Model with_entry(const Model& model, rendering::Side side, const NamedParameters& entry) {
  Model extended = model;
  (side == rendering::Side::contact ? extended.effects : extended.instrument).push_back(entry);
  return extended;
}

Model without_entry(const Model& model, const std::string& name) {
  Model reduced = model;
  for (auto* entries : {&reduced.effects, &reduced.instrument}) {
    std::erase_if(*entries, [&](const NamedParameters& entry) { return entry.name == name; });
  }
  return reduced;
}

std::vector<FreeParameter> without_owner(const std::vector<FreeParameter>& parameters, const std::string& name) {
  std::vector<FreeParameter> kept = parameters;
  std::erase_if(kept, [&](const FreeParameter& parameter) { return parameter.owner == name; });
  return kept;
}

bool has_path(const NamedParameters& entry) { return entry.parameters.contains(path_name); }

bool has_path(const Model& model) {
  return std::any_of(model.effects.begin(), model.effects.end(),
                     [](const NamedParameters& entry) { return has_path(entry); });
}

std::vector<Model> with_shorter_paths(const Model& model) {
  struct Shares {
    double path;
    double window;
  };
  std::vector<Model> shorter;
  const auto shorten = [](std::vector<NamedParameters>& entries, const char* name, double share) {
    bool any = false;
    for (NamedParameters& entry : entries) {
      const auto length = entry.parameters.find(name);
      if (length == entry.parameters.end()) continue;
      length->second *= share;
      any = true;
    }
    return any;
  };
  // The noise of an acceleration grows with the window's power of -2.5, that of a force beyond a path is bounded.
  for (const Shares& shares : {Shares{0.3, 0.6}, Shares{0.1, 0.4}}) {
    Model one = model;
    const bool path = shorten(one.effects, path_name, shares.path);
    const bool window = shorten(one.instrument, window_name, shares.window);
    if (path || window) shorter.push_back(std::move(one));
  }
  return shorter;
}

void settle_waves(Model& model, const EffectLibrary& library) {
  constexpr double pi = std::numbers::pi;
  for (auto* const entries : {&model.effects, &model.instrument}) {
    for (NamedParameters& wave : *entries) {
      if (!library.traits(wave.name).is_wave) continue;
      double& direction = wave.parameters.at("direction_rad");
      double& phase = wave.parameters.at("phase_rad");
      direction -= 2.0 * pi * std::floor(direction / (2.0 * pi));
      if (direction >= pi) {
        direction -= pi;
        phase = pi - phase;
      }
      phase -= 2.0 * pi * std::floor(phase / (2.0 * pi));
    }
  }
}

JointFit best_fit(const FitData& data, const Model& current, const CandidateFit& candidate,
                  std::vector<FreeParameter> parameters, const FitEffort& effort) {
  std::vector<FreeParameter> quick = parameters;
  std::erase_if(quick, [](const FreeParameter& p) { return p.moves_contact; });
  for (auto* list : {&quick, &parameters}) {
    list->insert(list->end(), candidate.parameters.begin(), candidate.parameters.end());
  }
  if (candidate.starts.size() == 1) {
    return fit_jointly_below(effort.abandon_above, data, with_entry(current, candidate.side, candidate.starts.front()),
                             parameters, effort.iterations);
  }
  JointFit best;
  for (const NamedParameters& entry : candidate.starts) {
    JointFit fit = fit_jointly(data, with_entry(current, candidate.side, entry), quick, effort.each_start, false);
    if (fit.ok && (!best.ok || fit.chi_squared < best.chi_squared)) best = std::move(fit);
  }
  if (!best.ok) return best;
  JointFit finished = fit_jointly_below(effort.abandon_above, data, Model(best.model), parameters, effort.iterations);
  // A fit of fewer parameters is none of these, however good.
  return finished.ok || quick.size() < parameters.size() ? finished : best;
}

JointFit best_fit(const FitData& data, const Model& current, const CandidateFit& candidate,
                  std::vector<FreeParameter> parameters, int iterations) {
  return best_fit(data, current, candidate, std::move(parameters), FitEffort{iterations, iterations / 3});
}

}  // namespace touchstone::discrepancy
