#include "harness/rendering/file_formats.h"

#include <array>

namespace touchstone::rendering {
namespace {

constexpr auto named_entry_fields = std::to_array<FormatField>({
    {"name", "text", "",
     "of the effect: `touchstone list effects`, `touchstone list instrument`, or that of its \"law\""},
    {"parameters?", "object", "", "each parameter that is set; the others have their defaults"},
    {"parameters.*", "number", "as its name says", "value"},
    {"image?", "text", "", "picture of heights, relative to the model file (surface-image)"},
    {"law?", "text or touchstone-effect/1", "",
     "effect that a user declares: its file, relative to this one, or its text"},
});
constexpr FormatPart named_entry{named_entry_fields};

constexpr auto model_fields = std::to_array<FormatField>({
    {"renderer", "text", "", "`touchstone list renderers`, or one of a plug-in"},
    {"parameters?", "object", "", "each parameter that is set; the others have their defaults"},
    {"parameters.*", "number", "as its name says", "value"},
    {"effects?", "list of objects", "", "effects of the contact; the renderer runs them, live too", &named_entry},
    {"instrument?", "list of objects", "", "how the measurement was made; comparisons alone run them", &named_entry},
});

constexpr auto effect_fields = std::to_array<FormatField>({
    {"name", "text", "", "small letters, digits and -"},
    {"summary", "text", "", "what it is, a phrase"},
    {"source", "text", "", "where the law is published, or what it was found in"},
    {"acts_on", "text", "",
     "depth, stiffness, normal-force or friction (effects of the contact), tool or sensor (instrument)"},
    {"empirical?", "flag", "", "true: found in data, valid for motions like those alone"},
    {"contains?", "list of texts", "", "effects of the catalogue that this one is a superset of"},
    {"parameters?", "object", "", "what a fit may change"},
    {"parameters.*.unit", "text", "", "of products and powers of SI units: \"N s/m\""},
    {"parameters.*.minimum", "number", "its unit", "least value that is allowed"},
    {"parameters.*.maximum", "number", "its unit", "largest value that is allowed"},
    {"parameters.*.start", "number or list of numbers", "its unit", "default, and where searches begin"},
    {"parameters.*.meaning?", "text", "", "a phrase"},
    {"parameters.*", "object", "", "one parameter, by its name in the formulas"},
    {"states?", "object", "", "numbers that remember, of effects of the contact"},
    {"states.*", "object", "", "one state, by its name in the formulas"},
    {"states.*.unit", "text", "", "of its value"},
    {"states.*.start?", "number", "its unit", "value at the first sample of every contact; 0 by default"},
    {"states.*.rate", "text", "", "formula of its change per second"},
    {"formula", "object", "", "one formula for each output of `acts_on`"},
    {"formula.*", "text", "", "formula in SI: along_N, x_N, y_N, z_N, normal_N, depth_m or factor"},
});

constexpr auto scene_fields = std::to_array<FormatField>({
    {"bodies", "list of objects", "", "at least one"},
    {"bodies[].name", "text", "", "differs from those of the other bodies"},
    {"bodies[].mesh", "text", "", "file, relative to this one"},
    {"bodies[].unit?", "text", "", "of the mesh: m (default), mm, cm or km"},
    {"bodies[].two_sided?", "flag", "", "a sheet that stops the tip from either side"},
    {"bodies[].pose?", "object", "", "a body at rest; without pose, poses and keyframes its frame is the world's"},
    {"bodies[].pose.p_m?", "list of numbers", "m", "its origin in the world"},
    {"bodies[].pose.q_wxyz?", "list of numbers", "1", "its orientation, a quaternion, w first"},
    {"bodies[].poses?", "text", "", "recorded poses: a trajectory's file with orientations"},
    {"bodies[].keyframes?", "list of objects", "", "poses at times, joined by straight lines and even turns"},
    {"bodies[].keyframes[].t_s", "number", "s", "time"},
    {"bodies[].keyframes[].p_m?", "list of numbers", "m", "origin in the world"},
    {"bodies[].keyframes[].q_wxyz?", "list of numbers", "1", "orientation, w first"},
});

constexpr auto operation_counts_fields = std::to_array<FormatField>({
    {"total", "whole number", "", "of the whole run"},
    {"mean", "number", "", "of a step"},
    {"median", "number", "", "of a step"},
    {"max", "whole number", "", "of the most expensive step"},
    {"add", "whole number", "", "additions and subtractions"},
    {"multiply", "whole number", "", "multiplications"},
    {"divide", "whole number", "", "divisions"},
    {"square_root", "whole number", "", "square roots"},
    {"compare", "whole number", "", "comparisons"},
    {"not_counted", "text", "", "parts of the model without a counting twin"},
    {"searches", "text", "", "how searches in trees are counted"},
});
constexpr FormatPart operation_counts{operation_counts_fields};

constexpr auto replay_timing_fields = std::to_array<FormatField>({
    {"steps", "whole number", "", "steps that were timed"},
    {"mean_us", "number", "us", "mean of a step"},
    {"median_us", "number", "us", "median of a step"},
    {"p99_us", "number", "us", "99th percentile"},
    {"p999_us", "number", "us", "99.9th percentile"},
    {"max_us", "number", "us", "largest"},
    {"build_ms", "number", "ms", "time to build the renderer's structures from the mesh"},
    {"memory_bytes", "whole number or null", "byte", "memory of the renderer; null: not known, as of every plug-in"},
    {"operations", "object or null", "", "operations, of a renderer that can be counted", &operation_counts},
});

constexpr auto replay_summary_fields = std::to_array<FormatField>({
    {"samples", "whole number", "", "samples of the trajectory"},
    {"in_contact", "whole number", "", "samples in contact"},
    {"largest_force_N", "number", "N", "largest magnitude of the force"},
    {"deepest_m", "number", "m", "largest distance between tip and surface contact point"},
});

}  // namespace

std::span<const FileFormat> file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-model/1", "model.json",
       "the renderer with its parameters, the effects of the contact and those of the measurement: what every command "
       "runs",
       "`fit`, `discrepancy`, `blind make`, `golden export`", "every command with `--model`", model_fields},
      {"touchstone-effect/1", "effect.json",
       "an effect that a user declares by formulas (docs/how-to/declare-an-effect.md)", "`discrepancy` (law-N.json)",
       "model files (\"law\"), `discrepancy --effect`", effect_fields},
      {"touchstone-scene/1", "scene.json", "several bodies, and where each is over time (docs/how-to/scenes.md)", "",
       "`replay --scene`, golden cases", scene_fields},
      {"replay-timing", "T.json of `replay --timing`",
       "the cost of the steps alone, without reading and writing; no key \"schema\"", "`replay`", "",
       replay_timing_fields},
      {"replay-summary", "S.json of `replay --json`", "one run in four numbers; no key \"schema\"", "`replay`", "",
       replay_summary_fields},
  });
  return formats;
}

}  // namespace touchstone::rendering
