#include "apps/axis_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "harness/acquisition/raw_table.h"
#include "harness/axis/axis_report.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/recording/recording_file.h"
#include "harness/recording/table_source.h"
#include "harness/report/evaluation_page.h"
#include "harness/report/page_html.h"
#include "harness/sanity/repeat_floor.h"
#include "harness/sanity/sanity.h"

namespace touchstone::apps {
namespace {

struct AxisColumns {
  const char* place;
  const char* rate;
  const char* load;
  axis::AxisWords words;
};

const std::array<AxisColumns, 2>& axis_columns() {
  static const std::array<AxisColumns, 2> known{
      AxisColumns{"q_rad", "qd_rad_per_s", "torque_Nm", {"angle", "rad", "torque", "N m"}},
      AxisColumns{"q_m", "qd_m_per_s", "force_N", {"place", "m", "force", "N"}}};
  return known;
}

struct AxisInput {
  axis::AxisRun run;
  axis::AxisWords words;
};

const axis::AxisWords indentation{"indentation", "m", "force", "N"};

// A recording that presses along z: indentation grows downwards, the force pushes up.
AxisInput pressed_along_z(const std::string& path) {
  const Recording recording = load_recording(path);
  AxisInput input{{recording.motion.t_s, {}, {}, {}, path, true}, indentation};
  for (std::size_t i = 0; i < recording.size(); ++i) {
    input.run.place.push_back(-recording.motion.p_W_m[i].z());
    input.run.load.push_back(recording.f_W_N[i].z());
  }
  return input;
}

// By the columns that the file has.
AxisInput load_axis(const AxisRequest& request, const std::string& path) {
  const RawTable table(path);
  std::optional<AxisInput> input;
  for (const AxisColumns& columns : axis_columns()) {
    if (!table.has(columns.place) || !table.has(columns.load)) continue;
    input =
        AxisInput{{table.times_s(), table.column(columns.place), {}, table.column(columns.load), path}, columns.words};
    if (table.has(columns.rate)) input->run.rate = table.column(columns.rate);
  }
  if (!input && (table.has("fz_N") || table.has("fz_mN"))) input = pressed_along_z(path);
  if (!input) {
    throw BadData(
        fmt::format("{}: the columns of an axis were expected: t_s with q_rad and torque_Nm (and "
                    "qd_rad_per_s), with q_m and force_N, or a recording that presses along z (x, y, z, fx, fy, "
                    "fz); `touchstone import` makes them",
                    path));
  }
  if (request.flip_force) {
    for (double& load : input->run.load) load = -load;
  }
  return *std::move(input);
}

// Place and load along one axis of a recording, for what looks at recordings.
Recording as_recording(const axis::AxisRun& run) {
  Recording recording;
  recording.source = run.source;
  recording.motion.t_s = run.t_s;
  for (std::size_t i = 0; i < run.t_s.size(); ++i) {
    recording.motion.p_W_m.emplace_back(run.place[i], 0.0, 0.0);
    recording.f_W_N.emplace_back(run.load[i], 0.0, 0.0);
  }
  return recording;
}

// Measured there and back, and fitted, over the place and over time.
Section plots(const AxisInput& input, const axis::AxisFit& fit) {
  constexpr std::size_t most_plotted = 6000;
  const axis::AxisRun& run = input.run;
  const axis::AxisWords& words = input.words;
  const std::vector<double> fitted = axis::fitted_load(fit, run);
  const std::string load_label = fmt::format("{} [{}]", words.load, words.load_unit);
  LinePlot over_place, over_time;
  over_place.title = fmt::format("{} over {}", words.load, words.place);
  over_place.x_label = fmt::format("{} [{}]", words.place, words.place_unit);
  over_place.height_px = 380;
  over_time.title = fmt::format("{} over time", words.load);
  over_time.x_label = "time [s]";
  over_place.y_label = over_time.y_label = load_label;
  Line there{"measured, there", {}, {}, Tone::measured, false, false},
      back{"measured, back", {}, {}, Tone::reference, false, false};
  Line model{"fitted", {}, {}, Tone::rendered, true, false};
  Line measured{"measured", {}, {}, Tone::measured, false, false},
      in_time{"fitted", {}, {}, Tone::rendered, true, false}, residual{"residual", {}, {}, Tone::error, false, false};
  const double gap = std::numeric_limits<double>::quiet_NaN();
  const std::size_t stride = run.t_s.size() / most_plotted + 1;
  for (std::size_t i = stride; i < run.t_s.size(); i += stride) {
    const bool forth = run.place[i] >= run.place[i - stride];
    for (Line* const line : {&there, &back, &model}) line->x.push_back(run.place[i]);
    there.y.push_back(forth ? run.load[i] : gap);
    back.y.push_back(forth ? gap : run.load[i]);
    model.y.push_back(fitted[i]);
    for (Line* const line : {&measured, &in_time, &residual}) line->x.push_back(run.t_s[i]);
    measured.y.push_back(run.load[i]);
    in_time.y.push_back(fitted[i]);
    residual.y.push_back(run.load[i] - fitted[i]);
  }
  over_place.lines = {std::move(there), std::move(back), std::move(model)};
  over_time.lines = {std::move(measured), std::move(in_time), std::move(residual)};
  Section section{"Measured and fitted", "", {}, false};
  section.blocks.emplace_back(std::move(over_place));
  section.blocks.emplace_back(std::move(over_time));
  return section;
}

Page axis_page(const AxisInput& input, const axis::AxisFit& fit, std::optional<double> floor,
               const Provenance& provenance) {
  const axis::AxisWords& words = input.words;
  Page page;
  page.title = fmt::format("{} over {} of {}", words.load, words.place,
                           std::filesystem::path(input.run.source).filename().string());
  page.subtitle = "One axis: what the place makes, and what the motion adds.";
  for (const axis::AxisTerm& term : fit.terms) {
    page.headlines.push_back({term.name, fmt::format("{:.4g}", term.value), axis::unit_of_term(term.name, words),
                              term.standard_error ? fmt::format("+- {:.2g}", *term.standard_error) : "",
                              Tone::rendered});
  }
  page.headlines.push_back({"held-out residual", fmt::format("{:.4g}", fit.after), words.load_unit,
                            fmt::format("RMS; {:.4g} about its mean", fit.before), Tone::error});
  if (floor) {
    page.headlines.push_back({"floor of a repeat", fmt::format("{:.4g}", *floor), words.load_unit,
                              "RMS of what the repeat differs by", Tone::reference});
  }
  Section found{"What was found", "", {}, false};
  for (const std::string& remark : axis::axis_remarks(fit, words, floor)) {
    found.blocks.emplace_back(TextBlock{remark, Tone::warning});
  }
  found.blocks.emplace_back(Code{"", axis::axis_values(fit, words)});
  page.sections.push_back(std::move(found));
  page.sections.push_back(plots(input, fit));
  page.sections.push_back(provenance_section(provenance));
  return page;
}

}  // namespace

bool is_axis_recording(const std::string& path) {
  try {
    const std::vector<std::string> names = open_table(path)->names();
    return std::ranges::any_of(axis_columns(), [&](const AxisColumns& columns) {
      return std::ranges::count(names, columns.place) > 0 && std::ranges::count(names, columns.load) > 0;
    });
  } catch (const BadData&) {
    return false;  // what is wrong with it, the command that reads it says better
  }
}

ExitStatus run_axis(const AxisRequest& request) {
  const AxisInput input = load_axis(request, request.recording);
  for (const std::string& remark : sanity::refuse_insane(as_recording(input.run), {})) {
    fmt::print(stderr, "warning: {}\n", remark);
  }
  const axis::AxisFit fit = axis::fit_axis(input.run);
  std::optional<double> floor;
  if (!request.repeat.empty()) {
    floor = sanity::repeat_floor(as_recording(input.run), as_recording(load_axis(request, request.repeat).run)).force_N;
  }
  if (fit.reversed) {
    throw BadData(fmt::format("{}: reversed {}: {}", request.recording, input.words.load,
                              axis::axis_remarks(fit, input.words, floor).front()));
  }
  fmt::print("{}", axis::axis_text(fit, input.words, floor));
  const std::string json = axis::axis_json(fit, input.words, floor);
  if (!request.json.empty()) write_file(request.json, json);
  if (request.out.empty()) return ExitStatus::passed;
  ensure_writable_folder(request.out);
  Provenance provenance = make_provenance(command_line());
  provenance.inputs = {describe_input("recording", request.recording)};
  if (!request.repeat.empty()) provenance.inputs.push_back(describe_input("repeat", request.repeat));
  const std::filesystem::path out = request.out;
  write_file(out / "axis.json", json);
  write_html(out / "report.html", axis_page(input, fit, floor, provenance));
  fmt::print("report: {}\n", (out / "report.html").string());
  return ExitStatus::passed;
}

}  // namespace touchstone::apps
