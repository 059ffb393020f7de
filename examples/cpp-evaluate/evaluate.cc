// Evaluates a data set from C++, without the program `touchstone`: how near do two renderers come to the measured
// force, one without friction and one with it?
//   evaluate DATASET OUT
// Prints the RMS force error of each renderer on the data set's first recording, and writes its report to
// OUT/<renderer>/report.html.
#include <cstdio>
#include <exception>
#include <filesystem>

#include "harness/metrics/catalogue.h"
#include "harness/pipeline/evaluation/run.h"
#include "harness/recording/dataset.h"
#include "renderers/catalogue.h"

using namespace touchstone;

namespace {

// What to evaluate. Everything is SI; forces are those ON the probe, in the object's frame.
pipeline::EvaluationRequest request_for(const recording::Dataset& dataset, const char* renderer) {
  pipeline::EvaluationRequest request;
  request.recording = dataset.path_of(dataset.recordings.front().file);
  request.mesh = dataset.path_of(dataset.mesh_file);
  request.mesh_unit = dataset.mesh_unit;
  request.tip_radius_m = dataset.tip_radius_m;
  request.in_trajectory = dataset.in_trajectory;
  request.model.source = "evaluate.cc";  // named in messages
  request.model.renderer = renderer;
  request.model.parameters["stiffness_N_per_m"] = dataset.stiffness_N_per_m;
  return request;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: evaluate DATASET OUT\n");
    return 2;
  }
  // The renderers that models may name. A program with renderers of its own gives a rendering::Catalogue of its own.
  const rendering::Catalogue& catalogue = renderers::built_in_catalogue();
  try {
    const recording::Dataset dataset = recording::load_dataset(argv[1]);
    for (const char* const renderer : {"god-object", "friction-cone"}) {
      pipeline::EvaluationRequest request = request_for(dataset, renderer);
      if (dataset.friction_coefficient && request.model.renderer == "friction-cone") {
        request.model.parameters["mu_static"] = request.model.parameters["mu_dynamic"] = *dataset.friction_coefficient;
      }
      const std::filesystem::path folder = std::filesystem::path(argv[2]) / renderer;
      const report::EvaluationResult result = pipeline::evaluate_into(catalogue, request, folder);
      const metrics::MetricResult& error = metrics::find_result(result.metrics, "rms_force_error");
      std::printf("%-14s %s %.4f %s\n", renderer, error.name.c_str(), error.value, error.unit.c_str());
    }
  } catch (const std::exception& error) {  // names the file, the place, the value and what was expected
    std::fprintf(stderr, "evaluate: %s\n", error.what());
    return 3;
  }
  return 0;
}
