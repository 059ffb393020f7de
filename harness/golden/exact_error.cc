#include "harness/golden/exact_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/golden/judges.h"
#include "harness/recording/recording_file.h"

namespace touchstone::golden {

std::optional<ExactError> exact_error(const Catalogues& catalogues, const surface::Surface& analytic, double scale,
                                      const rendering::Model& model, const recording::RenderedTrajectory& run) {
  const rendering::RendererEntry& entry = catalogues.renderers.find(model);
  if (!entry.has_exact_answer || !model.effects.empty() || run.size() == 0) return std::nullopt;
  const rendering::Parameters values(entry.parameters, model.parameters, "renderer " + model.renderer, model.source,
                                     "");
  const double stiffness = values.at("stiffness_N_per_m");
  const auto radius = values.values().find("tip_radius_m");
  const double radius_m = radius == values.values().end() ? 0.0 : radius->second;
  ExactError error;
  double force = 0.0;
  double contact = 0.0;
  std::size_t touching = 0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    const auto exact =
        catalogues.generators.exact_response(analytic, run.tip_W_m[i] / scale, stiffness, radius_m / scale);
    const double off_N = (run.f_W_N[i] - scale * exact.f_W_N).norm();
    force += off_N * off_N;
    error.force_max_N = std::max(error.force_max_N, off_N);
    if (exact.contact && run.contact[i] != 0) {
      contact += (run.contact_W_m[i] - scale * exact.contact_W_m).squaredNorm();
      ++touching;
    }
  }
  error.force_rms_N = std::sqrt(force / static_cast<double>(run.size()));
  error.contact_rms_m = touching == 0 ? 0.0 : std::sqrt(contact / static_cast<double>(touching));
  return error;
}

std::string exact_comparison(const std::optional<ExactError>& golden, const std::optional<ExactError>& obtained) {
  if (!golden || !obtained) return "";
  return fmt::format(
      "from the exact answer: force rms {:.4g} N (golden {:.4g}), max {:.4g} N ({:.4g}), surface contact point rms "
      "{:.4g} m ({:.4g})",
      obtained->force_rms_N, golden->force_rms_N, obtained->force_max_N, golden->force_max_N, obtained->contact_rms_m,
      golden->contact_rms_m);
}

// Nearer to the exact answer by more than the tolerance, over the run and at its worst.
void judge_by_exact_answer(const JudgedRun& judged, CheckResult& result) {
  const GoldenCase& golden = judged.golden;
  if (golden.surface.generator.empty() || golden.loop) return;
  if (!judged.options.ctest && result.comparison.verdict != Verdict::worse) return;
  const auto analytic = judged.catalogues.generators.surface(golden.surface.generator, golden.surface.parameters);
  const auto error_of = [&](const recording::RenderedTrajectory& run) {
    return exact_error(judged.catalogues, *analytic, golden.scale, judged.model.runs, run);
  };
  const auto obtained = error_of(judged.run.rendered);
  if (!obtained) return;
  result.figures.emplace_back("exact_force_rms_N", obtained->force_rms_N);
  result.figures.emplace_back("exact_force_max_N", obtained->force_max_N);
  result.figures.emplace_back("exact_contact_rms_m", obtained->contact_rms_m);
  if (result.comparison.verdict != Verdict::worse) return;
  const auto before = error_of(recording::load_rendered(golden.expected(judged.model.name)));
  if (!before) return;
  result.comparison.problems.push_back(exact_comparison(before, obtained));
  const double band_N = golden.tolerance.of("force").atol;
  if (before->force_rms_N - obtained->force_rms_N > band_N && before->force_max_N - obtained->force_max_N > -band_N)
    result.comparison.verdict = Verdict::better;
}

}  // namespace touchstone::golden
