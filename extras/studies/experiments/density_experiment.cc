#include "experiments/density_experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/mesh_family.h"
#include "harness/surface/embree_surface.h"
#include "recipe.h"
#include "renderers/catalogue.h"
#include "renderers/mesh_traversal/contact_mesh.h"

namespace touchstone::experiments {

namespace {

std::optional<rendering::OperationReport> operations_of(const BodyScan& scan,
                                                        const std::shared_ptr<const surface::Surface>& surface) {
  const rendering::CountedRenderer counted = renderers::make_counted_renderer(proxy_model(scan, "god-object"), surface);
  if (!counted.renderer) return std::nullopt;
  return count_operations(*counted.renderer, rendering::tip_source(scan.in.motion));
}

}  // namespace

std::vector<std::size_t> density_triangles() {
  std::vector<std::size_t> sizes;
  sizes.reserve(published_density.size());
  for (const auto& published : published_density)
    sizes.push_back(static_cast<std::size_t>(std::lround(1000.0 * published.kilo_triangles)));
  sizes.back() = finest_triangles;
  return sizes;
}

DensityExperiment run_density_experiment(std::uint64_t seed) {
  const BodyScan scan = make_body_scan(seed, datasets::recipe("duck").contact.mu);
  DensityExperiment experiment{seed, {}};
  for (const surface::TriangleMesh& mesh : decimated_family(scan.finest, density_triangles())) {
    const std::shared_ptr<const surface::Surface> surface = make_embree_surface(mesh);
    const auto shared = renderers::contact_mesh(surface);  // kept, so that it is built once
    const auto error = [&](const std::string& renderer, Against against) {
      return force_error(scan, proxy_model(scan, renderer), surface, against, 0, scan.in.size());
    };
    experiment.points.push_back({mesh.triangle_count(), error("god-object", Against::normal_part),
                                 error("force-shading", Against::normal_part), error("god-object", Against::recorded),
                                 error("force-shading", Against::recorded), operations_of(scan, surface)});
  }
  return experiment;
}

std::vector<PaperFinding> density_findings(const DensityExperiment& experiment) {
  const auto& p = experiment.points;
  const auto ratio = [&](std::size_t coarse, std::size_t fine) {
    return p[coarse].plain.mean_N / p[fine].plain.mean_N;
  };
  constexpr auto& theirs = published_density;
  const double their_flat = theirs[2].error_N / theirs[7].error_N;
  const double their_steep = theirs[0].error_N / theirs[2].error_N;
  const double whole_flat = p[2].plain_all.mean_N / p[7].plain_all.mean_N;
  const double whole_steep =
      (p[0].plain_all.mean_N - p[7].plain_all.mean_N) / (p[2].plain_all.mean_N - p[7].plain_all.mean_N);
  return {
      {fmt::format("fairly stable from 1,000 to 140,000 triangles (theirs grows {:.1f} times)", their_flat),
       ratio(2, 7) <= their_flat,
       fmt::format("against the normal part of the force it grows {:.1f} times, in proportion to the triangles' size: "
                   "the finest mesh is the one from which the positions were made, and nothing else is wrong",
                   ratio(2, 7))},
      {"the same against the whole recorded force", whole_flat <= their_flat,
       fmt::format("grows {:.2f} times: friction, which the proxy lacks, is a floor below it", whole_flat)},
      {fmt::format("sharply higher below (theirs {:.1f} times from 1,000 to 200)", their_steep), ratio(0, 2) >= 2.0,
       fmt::format("{:.1f} times from 1,000 to 200; against the whole force what is above the floor grows {:.0f} times",
                   ratio(0, 2), whole_steep)}};
}

std::vector<PaperFinding> shading_findings(const DensityExperiment& experiment) {
  // How much of the error shading takes away, in newtons and as a share.
  const auto gain = [&](std::size_t i) {
    return 1.0 - experiment.points[i].shaded.mean_N / experiment.points[i].plain.mean_N;
  };
  double middle = 1.0;
  double best = 0.0;
  std::size_t best_at = 0;
  for (std::size_t i = 0; i < experiment.points.size(); ++i) {
    if (i >= 2 && i <= 5) middle = std::min(middle, gain(i));
    if (gain(i) > best) {
      best = gain(i);
      best_at = i;
    }
  }
  const double fine = std::max(gain(6), gain(7));
  return {{"significantly lower error between 1,000 and 10,000 triangles", middle >= 0.25,
           fmt::format("at least {:.0f} % of the error is gone there", 100.0 * middle)},
          {"it helps most there", best_at >= 2 && best_at <= 5,
           fmt::format("most at {} triangles: {:.0f} %; at 64,000 and more at most {:.0f} %, at 200 {:.0f} %",
                       experiment.points[best_at].triangles, 100.0 * best, 100.0 * fine, 100.0 * gain(0))}};
}

}  // namespace touchstone::experiments
