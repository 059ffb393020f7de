#include "apps/file_formats.h"

#include <algorithm>
#include <array>

#include "harness/acquisition/file_formats.h"
#include "harness/axis/file_formats.h"
#include "harness/baseline/file_formats.h"
#include "harness/bisection/file_formats.h"
#include "harness/diagnosis/file_formats.h"
#include "harness/discrepancy/file_formats.h"
#include "harness/importing/file_formats.h"
#include "harness/perception/file_formats.h"
#include "harness/pipeline/evaluation/file_formats.h"
#include "harness/pipeline/file_formats.h"
#include "harness/pipeline/fitting/file_formats.h"
#include "harness/pipeline/golden/file_formats.h"
#include "harness/pipeline/leaderboard/file_formats.h"
#include "harness/pipeline/sweep/file_formats.h"
#include "harness/pipeline/tool_fitting/file_formats.h"
#include "harness/pipeline/tool_reports/file_formats.h"
#include "harness/recording/file_formats.h"
#include "harness/rendering/file_formats.h"
#include "harness/report/file_formats.h"
#include "harness/report/history_formats.h"
#include "harness/runs/file_formats.h"
#include "harness/surface/file_formats.h"
#include "harness/tool/file_formats.h"
#include "hil/file_formats.h"
#include "synthetic/file_formats.h"

namespace touchstone::apps {
namespace {

// Of the closed loop, an extra: its readers and writers stand in extras/loop.
constexpr auto sheet_fields = std::to_array<FormatField>({
    {"name", "text", "", "of the device or the grip"},
    {"figures", "object", "", "what is known"},
    {"figures.*", "object", "", "one figure, its name with its unit; `touchstone loop --help` lists them"},
    {"figures.*.value", "number", "", "in the unit of the name"},
    {"figures.*.source", "text", "", "who published or measured it"},
    {"figures.*.read_in?", "text", "", "the text in which it was read; absent: cited from memory"},
    {"not_published?", "object", "", "what is not"},
    {"not_published.*", "text", "", "why there is no figure of that name"},
});
constexpr auto vibration_fields = std::to_array<FormatField>({
    {"frequency_Hz", "number", "Hz", "of the largest peak"},
    {"amplitude_N", "number", "N", "of a sine there, on the hand"},
    {"jnd", "number", "", "just noticeable differences of the whole band"},
    {"at_s", "number", "s", "the middle of the window"},
});
constexpr FormatPart vibration_part{vibration_fields};
constexpr auto used_sheet_fields = std::to_array<FormatField>({
    {"name", "text", "", "of the sheet"},
    {"figures", "object", "", "what is known"},
    {"figures.*", "object", "", "one figure"},
    {"figures.*.value", "number", "", "in the unit of the name"},
    {"figures.*.source", "text", "", "who published or measured it"},
    {"figures.*.read_in", "text", "", "the text in which it was read, or empty"},
});
constexpr FormatPart used_sheet_part{used_sheet_fields};
constexpr auto loop_fields = std::to_array<FormatField>({
    {"verdict", "text", "", "`stable`, `buzzes`, `unstable` or `cannot tell`"},
    {"sentence", "text", "", "the verdict for people"},
    {"stable_margin", "number", "", "the force may be this many times as large and the loop stays or becomes stable"},
    {"real_time_factor", "number", "", "simulated over elapsed time, on one core"},
    {"runs", "list of objects", "", "one for each mass of the device that was tried"},
    {"runs[].device_mass_kg", "number", "kg", "that mass"},
    {"runs[].verdict", "text", "", "with it"},
    {"runs[].buzz", "object", "", "the loop's vibration that does not die away", &vibration_part},
    {"runs[].ringing", "object", "", "the loop's largest vibration", &vibration_part},
    {"runs[].ideal_servo", "object", "", "what an ideal servo shakes, too", &vibration_part},
    {"runs[].encoder", "object", "", "what the encoder's steps add to that", &vibration_part},
    {"runs[].kick_N", "number", "N", "largest force on the hand after contact, beyond the ideal servo's"},
    {"runs[].kick_at_s", "number", "s", "when"},
    {"runs[].energy_J", "number", "J", "the most that the motors had given more than taken"},
    {"runs[].judged_s", "number", "s", "time of contact that was judged"},
    {"runs[].thrown_out", "whole number", "", "times that contact was lost and should not have been"},
    {"runs[].limited_share", "number", "", "share of that time at the force limit"},
    {"runs[].device_felt_N", "number", "N", "root mean square on the hand in free air"},
    {"runs[].stable_margin", "number", "", "as above, with this mass"},
    {"device", "object", "", "its sheet", &used_sheet_part},
    {"grip", "object", "", "its sheet", &used_sheet_part},
    {"assumed", "list of texts", "", "what neither the sheet nor --set gives"},
});
constexpr auto loop_width_fields = std::to_array<FormatField>({
    {"device", "text", "", "its name"},
    {"over", "text", "", "`damping`, `latency` or `period`"},
    {"grips", "list of objects", "", "one for each hand"},
    {"grips[].grip", "text", "", "its name"},
    {"grips[].assumed", "list of texts", "", "what neither the sheet nor --set gives"},
    {"grips[].points", "list of objects", "", "along the picture"},
    {"grips[].points[].at", "number", "", "N s/m or s"},
    {"grips[].points[].unfelt_N_per_m", "number", "N/m", "stiffest wall of which nothing is felt"},
    {"grips[].points[].held_N_per_m", "number", "N/m", "stiffest wall that does not throw the hand off"},
    {"grips[].points[].linear_N_per_m", "number or null", "N/m", "by the eigenvalues of the sampled loop"},
    {"grips[].points[].passive_N_per_m", "number", "N/m", "passive with every hand"},
});

// Of the studies, the blind test and the program's own tools: their readers stand beside their writers.
constexpr auto internal_formats = std::to_array<FileFormat>({
    {"touchstone-atlas/1", "atlas.json", "the atlas of force shading", "`atlas`", "", {}, true},
    {"touchstone-atlas-grid/1", "atlas.sqlite", "which cases of the atlas are stored", "`atlas`", "`atlas`", {}, true},
    {"touchstone-bench-compare/1", "FILE of compare_runs", "two runs of a benchmark", "`ci/bench`", "", {}, true},
    {"touchstone-bisection/1", "measured.jsonl", "what a bisection has measured", "`bisect`", "`bisect`", {}, true},
    {"touchstone-blind-answers/1",
     "answers.json",
     "what each blind case hides",
     "`blind make`",
     "`blind score`",
     {},
     true},
    {"touchstone-blind-cases/1", "cases.sqlite", "which blind cases are stored", "`blind`", "`blind`", {}, true},
    {"touchstone-blind-score/1",
     "FILE of `blind score --json`",
     "what was named rightly",
     "`blind score`",
     "",
     {},
     true},
    {"touchstone-density-experiment/1",
     "density.json",
     "meshes of many densities",
     "`experiment density`",
     "",
     {},
     true},
    {"touchstone-experiment-voxel/1", "voxel.json", "grids of many resolutions", "`experiment voxel`", "", {}, true},
    {"touchstone-friction-experiment/1",
     "friction.json",
     "friction fitted to a scan",
     "`experiment friction`",
     "",
     {},
     true},
    {"touchstone-indentation/1", "indentation.json", "a real indentation", "`experiment indentation`", "", {}, true},
    {"touchstone-loop-atlas/1", "result.json", "which renderer is stable where", "`loop atlas`", "", {}, true},
    {"touchstone-loop-tune/1", "FILE of `loop tune --json`", "the stiffest walls", "`loop tune`", "", {}, true},
    {"touchstone-palpation/1", "palpation.json", "real palpations", "`experiment palpation`", "", {}, true},
    {"touchstone-paper/1",
     "FILE of `experiment paper --json`",
     "the published evaluation",
     "`experiment paper`",
     "",
     {},
     true},
    {"touchstone-perception-bench/2",
     "perception-bench.json",
     "methods against published answers",
     "`experiment perception`",
     "",
     {},
     true},
    {"touchstone-renderer-cost/1", "cost.json", "operations of every renderer", "`experiment cost`", "", {}, true},
    {"touchstone-seeds/1",
     "seeds.sqlite",
     "which seeds of an experiment are stored",
     "`experiment`",
     "`experiment`",
     {},
     true},
    {"touchstone-springs/1", "springs.json", "springs judged by observers", "`experiment springs`", "", {}, true},
    {"touchstone-tool-atlas/1", "atlas.json", "the atlas of tools with a shape", "`tool atlas`", "", {}, true},
    {"touchstone-tool-atlas-grid/1",
     "atlas.sqlite",
     "which cases of that atlas are stored",
     "`tool atlas`",
     "`tool atlas`",
     {},
     true},
});

constexpr auto loop_formats = std::to_array<FileFormat>({
    {"touchstone-device/1", "NAME.json", "published figures of a haptic device", "", "`loop`", sheet_fields},
    {"touchstone-grip/1", "NAME.json", "published figures of a hand", "", "`loop`", sheet_fields},
    {"touchstone-loop/1", "result.json", "whether a closed loop is stable", "`loop`", "", loop_fields},
    {"touchstone-loop-width/1", "result.json", "the stiffest walls of a device", "`loop width`", "", loop_width_fields},
});

}  // namespace

std::vector<const FileFormat*> file_formats() {
  std::vector<const FileFormat*> all;
  for (const std::span<const FileFormat> of_room : {recording::file_formats(),
                                                    rendering::file_formats(),
                                                    report::file_formats(),
                                                    pipeline::evaluation_file_formats(),
                                                    discrepancy::file_formats(),
                                                    perception::file_formats(),
                                                    pipeline::leaderboard_file_formats(),
                                                    pipeline::submission_file_formats(),
                                                    diagnosis::file_formats(),
                                                    baseline::file_formats(),
                                                    pipeline::golden_floor_file_formats(),
                                                    pipeline::fitting_file_formats(),
                                                    importing::file_formats(),
                                                    acquisition::file_formats(),
                                                    axis::file_formats(),
                                                    pipeline::sweep_file_formats(),
                                                    runs::file_formats(),
                                                    bisection::file_formats(),
                                                    report::history_file_formats(),
                                                    surface::file_formats(),
                                                    hil::file_formats(),
                                                    tool::file_formats(),
                                                    pipeline::tool_fitting_file_formats(),
                                                    pipeline::tool_report_file_formats(),
                                                    synthetic::file_formats(),
                                                    std::span<const FileFormat>(loop_formats),
                                                    std::span<const FileFormat>(internal_formats)}) {
    for (const FileFormat& format : of_room) all.push_back(&format);
  }
  std::ranges::stable_sort(all, std::ranges::less{}, &FileFormat::internal);
  return all;
}

}  // namespace touchstone::apps
