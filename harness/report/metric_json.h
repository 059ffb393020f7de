// The parts that result.json shares with other result files: metrics, series, provenance.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string_view>
#include <vector>

#include "harness/base/json_reader.h"
#include "harness/metrics/metric.h"
#include "harness/report/provenance.h"

namespace touchstone::report {

nlohmann::json series_to_json(const metrics::Series& series);
metrics::Series series_from_json(JsonObject& in);

nlohmann::json metric_to_json(const metrics::MetricResult& metric);
metrics::MetricResult metric_from_json(JsonObject& in);

nlohmann::json provenance_to_json(const Provenance& provenance);
Provenance provenance_from_json(JsonObject in);

// An array of numbers and nulls (NaN).
std::vector<double> nullable_numbers(JsonObject& in, std::string_view key);
// A whole number >= 0.
std::uint64_t count_from_json(JsonObject& in, std::string_view key);

const char* status_name(metrics::MetricStatus status);

}  // namespace touchstone::report
