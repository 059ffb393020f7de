// The report of the spring experiment: which findings hold, how robust they are, why not where they do not, the
// agreement of methods with the published order, and the pictures of one run.
#pragma once

#include "experiments/spring_experiment.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"

namespace touchstone::experiments {

report::Page spring_page(const SpringExperiment& experiment, const report::Provenance& provenance);

}  // namespace touchstone::experiments
