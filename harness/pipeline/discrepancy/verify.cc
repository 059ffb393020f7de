#include "harness/pipeline/discrepancy/verify.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "harness/base/error.h"
#include "harness/base/other_program.h"
#include "harness/rendering/predictor.h"

namespace touchstone::pipeline {

double rms_of_files_N(const rendering::Catalogue& catalogue, const DiscrepancyFiles& files,
                      const std::function<void(const std::string&)>& report) {
  const DiscrepancyInputs inputs = load_inputs(catalogue, files);
  if (report) {
    for (const std::string& remark : inputs.remarks) report(remark);
  }
  const recording::Recording& measured = inputs.train;
  const rendering::Prediction prediction =
      catalogue.make_predictor(inputs.surface, measured.motion)->predict(inputs.model);
  double sum = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i) sum += (measured.f_W_N[i] - prediction.f_W_N[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(measured.size()));
}

std::optional<double> rms_in_fresh_process_N(const DiscrepancyFiles& files) {
  std::vector<std::string> words{files.program.string(),
                                 "discrepancy",
                                 "--verify",
                                 "--model=" + files.model.string(),
                                 "--recording=" + files.recording.string(),
                                 "--mesh-unit=" + files.mesh_unit};
  if (!files.mesh.empty()) words.push_back("--mesh=" + files.mesh.string());
  if (files.repair) words.emplace_back("--repair");
  if (files.flip_force) words.emplace_back("--flip-force");
  // What is wrong with mesh and recording was said before the search.
  const std::optional<ProgramEnd> run = run_other({words, Printed::kept, Printed::kept});
  if (!run) return std::nullopt;
  char* end = nullptr;
  const double rms = std::strtod(run->out.c_str(), &end);
  if (run->status != 0 || end == run->out.c_str())
    throw BadData(
        fmt::format("{}: a fresh process could not run the written model:\n{}", files.model.string(), run->err));
  return rms;
}

}  // namespace touchstone::pipeline
