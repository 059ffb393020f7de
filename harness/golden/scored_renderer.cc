#include "harness/golden/scored_renderer.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/base/error.h"
#include "harness/base/hash.h"
#include "harness/golden/case_runner.h"

namespace touchstone::golden {
using rendering::RendererEntry;

namespace {

// The renderer in the place of the case's own, with the case's stiffness and tip and the parameters that were given.
ChangeModel in_place(const std::shared_ptr<const RendererEntry>& entry, const ScoreRequest& request) {
  return [entry, given = request.facts.parameters](rendering::Model& model) {
    model.renderer = entry->name;
    model.provided = entry;
    std::erase_if(model.parameters, [&](const auto& parameter) {
      return std::ranges::find(entry->parameters, parameter.first, &rendering::ParameterDeclaration::name) ==
             entry->parameters.end();
    });
    for (const auto& [name, value] : given) {
      if (name != "stiffness_N_per_m") model.parameters.emplace(name, value);
    }
  };
}

// What the table of shapes has a row for.
std::string shape_of(const GoldenCase& golden) {
  if (!golden.scene.empty()) return "scene";
  if (!golden.surface.generator.empty()) return golden.surface.generator;
  const std::string file = golden.surface.mesh.filename().string();
  return file.substr(0, file.find('.'));
}

}  // namespace

renderer_faults::CaseScore score_case(const Catalogues& catalogues, const std::shared_ptr<const RendererEntry>& entry,
                                      const ScoreRequest& request, const GoldenCase& golden) {
  renderer_faults::CaseScore score;
  score.name = golden.name;
  score.shape = shape_of(golden);
  try {
    const CheckResult checked = check_case(catalogues, golden, request.model,
                                           {request.out / "cases", false, in_place(entry, request), request.felt});
    score.problem = checked.skipped;
    score.skipped = !score.problem.empty();
    if (score.skipped) return score;
    if (!checked.felt) {
      score.problem = checked.comparison.problems.empty() ? "it did not run" : checked.comparison.problems.front();
      return score;
    }
    score.reference = checked.felt->reference;
    score.samples = checked.felt->by_exact + checked.felt->by_golden;
    score.mean_N = checked.felt->mean_N;
    score.jump_N = checked.felt->jump_N;
    score.right_N = checked.felt->right_N;
    score.rms_N = checked.felt->rms_N;
    score.max_N = checked.felt->max_N;
    score.max_jnd = checked.felt->max_jnd;
    score.felt = checked.felt->passed;
    score.exact = passes(checked.comparison.verdict);
  } catch (const Error& error) {
    score.problem = error.what();
  }
  return score;
}

std::vector<std::shared_ptr<const RendererEntry>> entries_to_score(std::span<const RendererEntry> own,
                                                                   const plugin::Plugins& plugins,
                                                                   const std::vector<std::string>& names) {
  std::vector<std::shared_ptr<const RendererEntry>> all = plugins.entries();
  if (names.empty()) {
    if (all.empty()) throw UsageError("give --plugin libmine.so, or --renderer with a renderer's name");
    return all;
  }
  for (const RendererEntry& entry : own) all.push_back(std::make_shared<const RendererEntry>(entry));
  std::vector<std::shared_ptr<const RendererEntry>> chosen;
  for (const std::string& name : names) {
    const auto found = std::ranges::find_if(all, [&](const auto& entry) { return entry->name == name; });
    if (found == all.end()) {
      std::string known;
      for (const auto& entry : all) known += ' ' + entry->name;
      throw UsageError(fmt::format("--renderer {}: there is none of this name; there are:{}", name, known));
    }
    chosen.push_back(*found);
  }
  return chosen;
}

renderer_faults::Scorecard score_renderer(const Catalogues& catalogues,
                                          const std::shared_ptr<const RendererEntry>& entry,
                                          const ScoreRequest& request, const std::vector<GoldenCase>& cases) {
  renderer_faults::Scorecard card;
  card.engine = entry->name;
  card.summary = entry->summary;
  card.source = entry->source;
  if (!entry->library.empty()) {
    card.library = entry->library.filename().string();
    card.library_sha256 = sha256_file(entry->library);
  }
  card.options = request.options;
  card.cases_wanted = request.with_cases;
  card.allowed = request.allowed;
  for (const std::string& name : request.allowed) {
    const bool known = std::ranges::find(cases, name, &GoldenCase::name) != cases.end() ||
                       std::ranges::find(renderer_faults::detectors(), name, &renderer_faults::Detector::name) !=
                           renderer_faults::detectors().end();
    if (!known) throw UsageError("--allow " + name + ": neither a fault that is known nor a golden case");
  }
  const renderer_faults::Engine engine = renderer_faults::engine_of(*entry, request.facts);
  card.epsilon_m = engine.epsilon_m;
  // A plug-in of version 1 says it by a parameter, as it does its epsilon.
  card.world_unit_m = entry->world_unit_m;
  if (const auto unit = std::ranges::find(entry->parameters, "world_unit_m", &rendering::ParameterDeclaration::name);
      unit != entry->parameters.end()) {
    const auto given = request.facts.parameters.find("world_unit_m");
    card.world_unit_m = given == request.facts.parameters.end() ? unit->initial : given->second;
  }
  card.diagnosis = renderer_faults::diagnose(engine);
  constexpr int levels = 5;  // 8192 triangles
  if (request.cost) card.cost = renderer_faults::measure_cost(engine, levels);
  ScoreRequest with_epsilon = request;
  with_epsilon.felt.epsilon_m = engine.epsilon_m;
  for (const GoldenCase& golden : cases) {
    if (golden.models.contains(request.model) && !golden.loop)
      card.cases.push_back(score_case(catalogues, entry, with_epsilon, golden));
  }
  return card;
}

}  // namespace touchstone::golden
