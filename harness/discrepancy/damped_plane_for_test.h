// For tests of the search: a plane with a damper along it that the model lacks, or has not got.
#pragma once

#include <vector>

#include "harness/discrepancy/catalogue_for_test.h"
#include "harness/discrepancy/two_recordings_for_test.h"

namespace touchstone::discrepancy {

struct DampedPlane {
  explicit DampedPlane(double damper_N_s_per_m) {
    start.renderer = "plane";
    start.parameters["stiffness_N_per_m"] = 900.0;
    truth = start;
    if (damper_N_s_per_m > 0.0) {
      truth.effects.push_back({"viscous-friction", {{"coefficient_N_s_per_m", damper_N_s_per_m}}, ""});
    }
  }

  std::vector<rendering::Candidate> library{{"viscous-friction",
                                             rendering::Side::contact,
                                             {{"coefficient_N_s_per_m", "N s/m", 0.0, 1e4, 0.0, ""}},
                                             traits_of("viscous-friction")}};
  rendering::Model start;
  rendering::Model truth;
  InstrumentDescription instrument = small_noise(1.0);
};

}  // namespace touchstone::discrepancy
