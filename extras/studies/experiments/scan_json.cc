#include <nlohmann/json.hpp>

#include "experiments/operations_json.h"
#include "experiments/scan_pages.h"
#include "harness/base/error.h"

namespace touchstone::experiments {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const ForceError& error) {
  return {{"mean_N", error.mean_N}, {"rms_N", error.rms_N}, {"samples", error.samples}};
}

ForceError force_error_from(const Json& document) {
  return {document.at("mean_N").get<double>(), document.at("rms_N").get<double>(),
          document.at("samples").get<std::size_t>()};
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
    document["fits"].push_back({{"seed", fit.seed},
                                {"true_mu", fit.true_mu},
                                {"probes", probes},
                                {"estimate",
                                 {{"mu", fit.estimate.mu},
                                  {"standard_error", fit.estimate.standard_error},
                                  {"rigid_mu", fit.estimate.rigid_mu},
                                  {"again_mu", fit.estimate.again_mu},
                                  {"measured_again", fit.estimate.measured}}}});
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
    document["points"].push_back({{"triangles", p.triangles},
                                  {"plain", to_json(p.plain)},
                                  {"shaded", to_json(p.shaded)},
                                  {"plain_against_whole_force", to_json(p.plain_all)},
                                  {"shaded_against_whole_force", to_json(p.shaded_all)},
                                  {"operations", p.operations ? operations_document(*p.operations) : Json()}});
  }
  document["density_findings"] = to_json(density_findings(e));
  document["shading_findings"] = to_json(shading_findings(e));
  return document.dump(2) + "\n";
}

FrictionExperiment friction_from_json(const std::string& text) {
  try {
    const Json document = Json::parse(text);
    FrictionExperiment e;
    for (const Json& one : document.at("fits")) {
      FrictionFit fit;
      one.at("seed").get_to(fit.seed);
      one.at("true_mu").get_to(fit.true_mu);
      std::size_t at = 0;
      for (FrictionAtStiffness* const own : {&fit.soft, &fit.stiff}) {
        const Json& probe = one.at("probes").at(at++);
        probe.at("stiffness_N_per_m").get_to(own->stiffness_N_per_m);
        probe.at("fitted_mu").get_to(own->fitted_mu);
        own->without = force_error_from(probe.at("without"));
        own->with = force_error_from(probe.at("with"));
        probe.at("curve").at("mu").get_to(own->mu);
        probe.at("curve").at("mean_N").get_to(own->mean_error_N);
      }
      const Json& estimate = one.at("estimate");
      estimate.at("mu").get_to(fit.estimate.mu);
      estimate.at("standard_error").get_to(fit.estimate.standard_error);
      estimate.at("rigid_mu").get_to(fit.estimate.rigid_mu);
      estimate.at("again_mu").get_to(fit.estimate.again_mu);
      estimate.at("measured_again").get_to(fit.estimate.measured);
      e.fits.push_back(std::move(fit));
    }
    for (const Json& one : document.at("real")) {
      e.real.push_back({one.at("extended_m").get<double>(), one.at("block_s").get<double>(),
                        one.at("fitted_mu").get<double>(), one.at("stiffness_N_per_m").get<double>(),
                        one.at("rms_without_N").get<double>(), one.at("rms_with_N").get<double>(),
                        one.at("fitted_samples").get<std::size_t>(), one.at("held_out_samples").get<std::size_t>()});
    }
    return e;
  } catch (const Json::exception& error) {
    throw BadData(std::string("the friction experiment cannot be read: ") + error.what());
  }
}

DensityExperiment density_from_json(const std::string& text) {
  try {
    const Json document = Json::parse(text);
    DensityExperiment e{document.at("seed").get<std::uint64_t>(), {}};
    for (const Json& one : document.at("points")) {
      e.points.push_back({one.at("triangles").get<std::size_t>(), force_error_from(one.at("plain")),
                          force_error_from(one.at("shaded")), force_error_from(one.at("plain_against_whole_force")),
                          force_error_from(one.at("shaded_against_whole_force")), std::nullopt});
      if (!one.at("operations").is_null()) e.points.back().operations = operations_from(one.at("operations"));
    }
    return e;
  } catch (const Json::exception& error) {
    throw BadData(std::string("the density experiment cannot be read: ") + error.what());
  }
}

}  // namespace touchstone::experiments
