#include "apps/acquisition_run.h"

#include <fmt/format.h>

#include <memory>

#include "harness/base/atomic_file.h"
#include "harness/base/units.h"
#include "harness/recording/recording_file.h"
#include "harness/sanity/sanity.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_file.h"

namespace touchstone::apps {
namespace {

// The gate of every command, on what was made: its findings become notes. True if one of them is a fault.
bool check_acquired(const AcquisitionDescription& description, Acquired& acquired) {
  std::shared_ptr<const Surface> surface;
  if (description.mesh_file) {
    surface = make_embree_surface(load_mesh(*description.mesh_file, length_unit_factor(description.mesh_unit)));
  }
  sanity::SanityContext context;
  context.surface = surface.get();
  context.mesh_unit = description.mesh_unit;
  context.tip_radius_m = description.tip_radius_m;
  context.contact_force_N = description.contact_force_N;
  bool fault = false;
  for (const sanity::SanityFinding& finding : sanity::check_sanity(acquired.recording, context)) {
    acquired.report.notes.push_back(fmt::format("{}: {}", to_string(finding.fault), sanity::sanity_line(finding)));
    fault |= finding.weight == sanity::SanityWeight::fault;
  }
  return fault;
}

}  // namespace

ExitStatus run_acquisition(const AcquisitionDescription& description, const std::string& out, const std::string& json) {
  Acquired result = acquire(description);
  const bool fault = check_acquired(description, result);
  save_recording(out, result.recording);
  if (!json.empty()) write_file(json, report_json(result.report));
  fmt::print("{}recording    {} samples -> {}\n", report_text(result.report), result.recording.size(), out);
  return fault || result.report.contact_in_free_air ? ExitStatus::failed : ExitStatus::passed;
}

}  // namespace touchstone::apps
