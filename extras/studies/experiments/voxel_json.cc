#include <nlohmann/json.hpp>

#include "experiments/operations_json.h"
#include "experiments/voxel_experiment.h"
#include "harness/base/error.h"

namespace touchstone::experiments {
namespace {

using Json = nlohmann::ordered_json;

Json series_to_json(const std::vector<Vec3>& values) {
  Json all = Json::array();
  for (const Vec3& value : values) {
    for (int axis = 0; axis < 3; ++axis) all.push_back(value[axis]);
  }
  return all;
}

std::vector<Vec3> series_from_json(const Json& all) {
  std::vector<Vec3> values(all.size() / 3);
  for (std::size_t i = 0; i < 3 * values.size(); ++i) values[i / 3][static_cast<int>(i % 3)] = all.at(i).get<double>();
  return values;
}

// The rows whose forces the report draws.
bool drawn(const VoxelRow& row) {
  return row.renderer == "god-object" || (row.renderer == "voxel" && (row.resolution == 32 || row.resolution == 64));
}

}  // namespace

std::string voxel_experiment_to_json(const VoxelExperiment& e) {
  nlohmann::ordered_json root{{"schema", "touchstone-experiment-voxel/1"},
                              {"seed", e.options.seed},
                              {"triangles", e.options.triangles},
                              {"samples", e.samples},
                              {"in_contact", e.in_contact},
                              {"deepest_m", e.deepest_m},
                              {"surface_build_ms", e.surface_build_ms},
                              {"rms_measured_N", e.rms_measured_N}};
  for (const VoxelRow& row : e.rows) {
    root["rows"].push_back(
        {{"renderer", row.renderer},
         {"resolution", row.resolution},
         {"rms_force_error_N", row.rms_N},
         {"mean_force_error_N", row.mean_N},
         {"own_rms_N", row.own_rms_N},
         {"operations", row.operations ? nlohmann::json::parse(operations_to_json(*row.operations)) : nlohmann::json()},
         {"mean_us", row.timing.mean_us},
         {"median_us", row.timing.median_us},
         {"max_us", row.timing.max_us},
         {"build_ms", row.timing.build_ms},
         {"memory_bytes", row.timing.memory_bytes ? nlohmann::json(*row.timing.memory_bytes) : nlohmann::json()}});
  }
  for (const PublishedVoxelRow& row : published_voxel_table()) {
    root["published"].push_back({{"algorithm", row.algorithm},
                                 {"resolution", row.resolution},
                                 {"rms_force_error_N", row.rms_N},
                                 {"operations", row.operations},
                                 {"init_s", row.init_s},
                                 {"memory_MB", row.memory_MB}});
  }
  for (const VoxelFinding& finding : e.findings)
    root["findings"].push_back({{"statement", finding.statement}, {"holds", finding.holds}, {"here", finding.here}});
  return root.dump(2) + "\n";
}

std::string voxel_document(const VoxelExperiment& e, bool series) {
  Json root{{"seed", e.options.seed},
            {"triangles", e.options.triangles},
            {"resolutions", e.options.resolutions},
            {"reach_m", e.options.reach_m},
            {"samples", e.samples},
            {"in_contact", e.in_contact},
            {"deepest_m", e.deepest_m},
            {"rms_measured_N", e.rms_measured_N}};
  if (series) {
    root["t_s"] = e.t_s;
    root["measured_W_N"] = series_to_json(e.measured_W_N);
  }
  for (const VoxelRow& row : e.rows) {
    Json own{{"renderer", row.renderer},
             {"resolution", row.resolution},
             {"rms_N", row.rms_N},
             {"mean_N", row.mean_N},
             {"own_rms_N", row.own_rms_N},
             {"memory_bytes", row.timing.memory_bytes ? Json(*row.timing.memory_bytes) : Json()},
             {"operations", row.operations ? operations_document(*row.operations) : Json()}};
    if (series && drawn(row)) own["f_W_N"] = series_to_json(row.f_W_N);
    root["rows"].push_back(std::move(own));
  }
  return root.dump();
}

std::string voxel_times(const VoxelExperiment& e) {
  Json root{{"surface_build_ms", e.surface_build_ms}};
  for (const VoxelRow& row : e.rows) {
    root["rows"].push_back({{"steps", row.timing.steps},
                            {"mean_us", row.timing.mean_us},
                            {"median_us", row.timing.median_us},
                            {"p99_us", row.timing.p99_us},
                            {"max_us", row.timing.max_us},
                            {"build_ms", row.timing.build_ms}});
  }
  return root.dump();
}

VoxelExperiment voxel_from(const std::string& document, const std::string& times) {
  try {
    const Json root = Json::parse(document);
    const Json timed = Json::parse(times);
    VoxelExperiment e;
    root.at("seed").get_to(e.options.seed);
    root.at("triangles").get_to(e.options.triangles);
    root.at("resolutions").get_to(e.options.resolutions);
    root.at("reach_m").get_to(e.options.reach_m);
    root.at("samples").get_to(e.samples);
    root.at("in_contact").get_to(e.in_contact);
    root.at("deepest_m").get_to(e.deepest_m);
    root.at("rms_measured_N").get_to(e.rms_measured_N);
    timed.at("surface_build_ms").get_to(e.surface_build_ms);
    if (root.contains("t_s")) {
      root.at("t_s").get_to(e.t_s);
      e.measured_W_N = series_from_json(root.at("measured_W_N"));
    }
    for (std::size_t i = 0; i < root.at("rows").size(); ++i) {
      const Json& own = root.at("rows").at(i);
      const Json& own_times = timed.at("rows").at(i);
      VoxelRow row;
      own.at("renderer").get_to(row.renderer);
      own.at("resolution").get_to(row.resolution);
      own.at("rms_N").get_to(row.rms_N);
      own.at("mean_N").get_to(row.mean_N);
      own.at("own_rms_N").get_to(row.own_rms_N);
      row.timing.memory_bytes = own.at("memory_bytes").get<std::size_t>();
      if (!own.at("operations").is_null()) row.operations = operations_from(own.at("operations"));
      if (own.contains("f_W_N")) row.f_W_N = series_from_json(own.at("f_W_N"));
      own_times.at("steps").get_to(row.timing.steps);
      own_times.at("mean_us").get_to(row.timing.mean_us);
      own_times.at("median_us").get_to(row.timing.median_us);
      own_times.at("p99_us").get_to(row.timing.p99_us);
      own_times.at("max_us").get_to(row.timing.max_us);
      own_times.at("build_ms").get_to(row.timing.build_ms);
      e.rows.push_back(std::move(row));
    }
    e.findings = voxel_findings(e);
    return e;
  } catch (const Json::exception& error) {
    throw BadData(std::string("the stored voxel experiment cannot be read: ") + error.what());
  }
}

}  // namespace touchstone::experiments
