// Report page and JSON of the bench that holds the judge of perception against published experiments.
#pragma once

#include <string>

#include "experiments/perception_bench.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"

namespace touchstone::experiments {

// `bench` by the thresholds, `published` by published experiments.
std::string perception_bench_to_json(const PerceptionBench& bench, const PerceptionBench& published);
std::string perception_bench_table(const PerceptionBench& bench);
report::Page perception_bench_page(const PerceptionBench& bench, const PerceptionBench& published,
                                   const report::Provenance& provenance);

}  // namespace touchstone::experiments
