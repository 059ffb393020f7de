// Counted operations as they are kept with a seed, to be read back whole.
#pragma once

#include <nlohmann/json.hpp>

#include "harness/rendering/operations.h"

namespace touchstone::experiments {

inline nlohmann::ordered_json operations_document(const rendering::OperationReport& report) {
  auto document = nlohmann::ordered_json::parse(operations_to_json(report));
  document["steps"] = report.steps;
  return document;
}

// Throws nlohmann's exceptions.
inline rendering::OperationReport operations_from(const nlohmann::ordered_json& document) {
  rendering::OperationReport report;
  document.at("steps").get_to(report.steps);
  document.at("mean").get_to(report.mean);
  document.at("median").get_to(report.median);
  document.at("max").get_to(report.max);
  document.at("add").get_to(report.counts.add);
  document.at("multiply").get_to(report.counts.multiply);
  document.at("divide").get_to(report.counts.divide);
  document.at("square_root").get_to(report.counts.square_root);
  document.at("compare").get_to(report.counts.compare);
  document.at("not_counted").get_to(report.not_counted);
  return report;
}

}  // namespace touchstone::experiments
