#include "axis_run.h"

#include <fmt/format.h>

#include <utility>

#include "axis_page.h"
#include "axis_report.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/recording_checks/check_recording.h"
#include "harness/recording_checks/repeat_floor.h"
#include "harness/report/page_html.h"

namespace touchstone::axis {

std::string AxisResult::text() const { return axis_text(fit, input.words, floor); }
std::string AxisResult::json() const { return axis_json(fit, input.words, floor); }

std::vector<std::string> check_axis(const AxisInput& input) {
  return recording_checks::refuse_faulty(as_recording(input.run), {});
}

AxisResult run_axis(const AxisRequest& request, AxisInput input) {
  AxisResult result{std::move(input), {}, {}};
  result.fit = fit_axis(result.input.run);
  if (!request.repeat.empty()) {
    const AxisInput repeat = load_axis(request.repeat, request.flip_force);
    const auto repeated = recording_checks::repeat_floor(as_recording(result.input.run), as_recording(repeat.run));
    result.floor = AxisFloor{repeated.force_N, repeated.within_N};
  }
  if (result.fit.reversed) {
    throw BadData(fmt::format("{}: reversed {}: {}", request.recording, result.input.words.load,
                              axis_remarks(result.fit, result.input.words, result.floor).front()));
  }
  return result;
}

std::filesystem::path write_axis(const AxisRequest& request, const AxisResult& result,
                                 const std::vector<std::string>& command_line, const std::filesystem::path& folder) {
  ensure_writable_folder(folder);
  report::Provenance provenance = report::make_provenance(command_line);
  provenance.inputs = {report::describe_input("recording", request.recording)};
  if (!request.repeat.empty()) provenance.inputs.push_back(report::describe_input("repeat", request.repeat));
  write_file(folder / "axis.json", result.json());
  const std::filesystem::path page = folder / "report.html";
  write_html(page, axis_page(result.input, result.fit, result.floor, provenance));
  return page;
}

}  // namespace touchstone::axis
