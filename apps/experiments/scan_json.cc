#include <nlohmann/json.hpp>

#include "apps/experiments/scan_pages.h"

namespace touchstone::experiments {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const ForceError& error) {
  return {{"mean_N", error.mean_N}, {"rms_N", error.rms_N}, {"samples", error.samples}};
}

Json to_json(const std::vector<PaperFinding>& findings) {
  Json all = Json::array();
  for (const auto& f : findings) all.push_back({{"statement", f.statement}, {"holds", f.holds}, {"here", f.here}});
  return all;
}

}  // namespace

std::string friction_to_json(const FrictionExperiment& e) {
  Json document{{"schema", "touchstone-friction-experiment/1"}, {"fits", Json::array()}};
  for (const auto& fit : e.fits) {
    Json probes = Json::array();
    for (const FrictionAtStiffness* const own : {&fit.soft, &fit.stiff}) {
      probes.push_back({{"stiffness_N_per_m", own->stiffness_N_per_m},
                        {"fitted_mu", own->fitted_mu},
                        {"without", to_json(own->without)},
                        {"with", to_json(own->with)},
                        {"curve", {{"mu", own->mu}, {"mean_N", own->mean_error_N}}}});
    }
    document["fits"].push_back({{"seed", fit.seed}, {"true_mu", fit.true_mu}, {"probes", probes}});
  }
  document["real"] = Json::array();
  for (const auto& own : e.real) {
    document["real"].push_back({{"extended_m", own.extended_m},
                                {"block_s", own.block_s},
                                {"fitted_mu", own.fitted_mu},
                                {"stiffness_N_per_m", own.stiffness_N_per_m},
                                {"rms_without_N", own.rms_without_N},
                                {"rms_with_N", own.rms_with_N},
                                {"fitted_samples", own.fitted_samples},
                                {"held_out_samples", own.held_out_samples}});
  }
  document["findings"] = to_json(friction_findings(e));
  return document.dump(2) + "\n";
}

std::string density_to_json(const DensityExperiment& e) {
  Json document{{"schema", "touchstone-density-experiment/1"}, {"seed", e.seed}, {"points", Json::array()}};
  for (const auto& p : e.points) {
    document["points"].push_back(
        {{"triangles", p.triangles},
         {"plain", to_json(p.plain)},
         {"shaded", to_json(p.shaded)},
         {"plain_against_whole_force", to_json(p.plain_all)},
         {"shaded_against_whole_force", to_json(p.shaded_all)},
         {"operations", p.operations ? Json::parse(operations_to_json(*p.operations)) : Json()}});
  }
  document["density_findings"] = to_json(density_findings(e));
  document["shading_findings"] = to_json(shading_findings(e));
  return document.dump(2) + "\n";
}

}  // namespace touchstone::experiments
