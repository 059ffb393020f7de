// Report and data of the bench of perception.
#pragma once

#include <string>

#include "apps/studies/experiments/perception_bench.h"
#include "harness/base/rooms.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"

namespace touchstone::experiments {

std::string perception_bench_to_json(const PerceptionBench& bench);
std::string perception_bench_table(const PerceptionBench& bench);
Page perception_bench_page(const PerceptionBench& bench, const Provenance& provenance);

}  // namespace touchstone::experiments
