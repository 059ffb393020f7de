#include "acquired_file.h"

#include <fmt/format.h>

#include <memory>

#include "harness/base/atomic_file.h"
#include "harness/base/units.h"
#include "harness/recording/recording_file.h"
#include "harness/recording_checks/check_recording.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_file.h"

namespace touchstone::acquisition {

CheckedAcquisition acquire_and_check(const AcquisitionDescription& description) {
  CheckedAcquisition result;
  result.acquired = acquire(description);
  std::shared_ptr<const surface::Surface> surface;
  if (description.mesh_file) {
    surface =
        make_embree_surface(surface::load_mesh(*description.mesh_file, length_unit_factor(description.mesh_unit)));
  }
  recording_checks::RecordingContext context;
  context.surface = surface.get();
  context.mesh_unit = description.mesh_unit;
  context.tip_radius_m = description.tip_radius_m;
  context.contact_force_N = description.contact_force_N;
  for (const recording_checks::RecordingFinding& finding : find_recording_faults(result.acquired.recording, context)) {
    result.acquired.report.notes.push_back(fmt::format("{}: {}", to_string(finding.fault), finding_line(finding)));
    result.faulty |= finding.weight == recording_checks::FaultWeight::fault;
  }
  return result;
}

CheckedAcquisition acquire_into(const AcquisitionDescription& description, const std::filesystem::path& out,
                                const std::filesystem::path& json) {
  CheckedAcquisition result = acquire_and_check(description);
  save_recording(out, result.acquired.recording);
  result.file = out;
  if (!json.empty()) write_file(json, report_json(result.acquired.report));
  return result;
}

std::string CheckedAcquisition::text() const {
  std::string text = report_text(acquired.report);
  if (!file.empty()) text += fmt::format("recording    {} samples -> {}\n", acquired.recording.size(), file.string());
  return text;
}

}  // namespace touchstone::acquisition
