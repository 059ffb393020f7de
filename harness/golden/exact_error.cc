#include "harness/golden/exact_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

}  // namespace touchstone::golden
