#include "apps/felt_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "harness/base/error.h"
#include "harness/perception/filters/weber_law.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/model.h"
#include "renderers/catalogue.h"
#include "synthetic/surface_catalogue.h"
#include "synthetic/surfaces/exact_contact.h"

namespace touchstone::apps {
namespace {

// The model's parameter with its default filled in; nothing where the renderer is not of the catalogue or has none.
std::optional<double> parameter_of(const Model& model, const std::string& name) {
  for (const RendererEntry& entry : renderer_catalogue()) {
    if (entry.name != model.renderer) continue;
    const Parameters values(entry.parameters, model.parameters, "renderer " + model.renderer, model.source, "");
    const auto found = values.values().find(name);
    if (found != values.values().end()) return found->second;
  }
  return std::nullopt;
}

// Forces of the smooth body at the run's tips; empty where no exact answer is known.
std::vector<Vec3> exact_forces(const GoldenCase& golden, const Model& model, const RenderedTrajectory& run) {
  const bool frictionless = model.renderer == "god-object" || model.renderer == "spring-linear";
  if (golden.surface.generator.empty() || !frictionless || !model.effects.empty()) return {};
  const auto analytic = synthetic::make_surface(golden.surface.generator, golden.surface.parameters);
  const double stiffness = parameter_of(model, "stiffness_N_per_m").value_or(0.0);
  const double radius_m = parameter_of(model, "tip_radius_m").value_or(0.0);
  std::vector<Vec3> forces;
  forces.reserve(run.size());
  for (const Vec3& tip : run.tip_W_m) {
    forces.push_back(golden.scale *
                     synthetic::exact_contact(*analytic, tip / golden.scale, stiffness, radius_m / golden.scale).f_W_N);
  }
  return forces;
}

}  // namespace

FeltError felt_error(const GoldenCase& golden, const std::string& model, const RenderedTrajectory& run,
                     const FeltTolerance& tolerance) {
  const Model own = parse_model(golden.models.at(model), golden.name);
  FeltError error;
  // Both are right: the smooth body's answer, and the mesh's, whose facets are not the engine's fault.
  std::vector<std::vector<Vec3>> right;
  if (auto exact = exact_forces(golden, own, run); !exact.empty()) right.push_back(std::move(exact));
  error.reference = right.empty() ? "golden" : "exact";
  if (std::filesystem::exists(golden.expected(model))) {
    auto forces = load_rendered(golden.expected(model)).f_W_N;
    if (forces.size() == run.size()) right.push_back(std::move(forces));
  }
  if (right.empty() || run.size() == 0) {
    throw BadData(fmt::format("{}: neither an exact answer nor a golden of {} samples is known to judge {} by",
                              golden.name, run.size(), model));
  }
  // An epsilon is a length: as force it is that times the steepest rise, which a case's model states.
  const double allowed_N = tolerance.epsilon_m * parameter_of(own, "stiffness_N_per_m").value_or(0.0);
  double square = 0.0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    double off_N = std::numeric_limits<double>::infinity();
    double jnd = off_N;
    for (const auto& forces : right) {
      const double here_N = (run.f_W_N[i] - forces[i]).norm();
      const double here_jnd =
          std::max(0.0, here_N - allowed_N) / perception::kFingertipForce.just_noticeable_difference(forces[i].norm());
      // Without NaN, which is nearer to nothing: what is left infinite fails.
      if (here_N < off_N) off_N = here_N;
      if (here_N - here_N == 0.0 && here_jnd < jnd) jnd = here_jnd;
    }
    square += off_N * off_N;
    error.max_N = std::max(error.max_N, off_N);
    if (jnd > error.max_jnd) {
      error.max_jnd = jnd;
      error.worst_t_s = run.t_s[i];
    }
  }
  error.rms_N = std::sqrt(square / static_cast<double>(run.size()));
  error.passed = error.max_jnd <= tolerance.jnd && std::isfinite(error.rms_N);
  return error;
}

std::string to_sentence(const FeltError& error, const FeltTolerance& tolerance) {
  return fmt::format(
      "felt: {} from the {} answer: {:.3g} N rms, {:.3g} N and {:.3g} JND at most, at {:.4g} s (within {:g} "
      "JND{})",
      error.passed ? "passes" : "fails", error.reference, error.rms_N, error.max_N, error.max_jnd, error.worst_t_s,
      tolerance.jnd, tolerance.epsilon_m > 0.0 ? fmt::format(" and {:g} m", tolerance.epsilon_m) : "");
}

}  // namespace touchstone::apps
