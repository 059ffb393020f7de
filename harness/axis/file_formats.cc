#include "harness/axis/file_formats.h"

#include <array>

namespace touchstone::axis {
namespace {

constexpr auto axis_fields = std::to_array<FormatField>({
    {"place", "object", "", "what is moved along"},
    {"place.name", "text", "", "angle or position"},
    {"place.unit", "text", "", "rad or m"},
    {"load", "object", "", "what is measured"},
    {"load.name", "text", "", "torque or force"},
    {"load.unit", "text", "", "Nm or N"},
    {"terms", "list of objects", "", "terms that the data need"},
    {"terms[].name", "text", "", "of the term"},
    {"terms[].value", "number or null", "its \"unit\"", "fitted value"},
    {"terms[].unit", "text", "", "its unit"},
    {"terms[].standard_error?", "number or null", "its \"unit\"", "of the value"},
    {"over_place", "object", "", "load that depends on the place"},
    {"over_place.place", "list of numbers", "place's unit", "knots"},
    {"over_place.load", "list of numbers", "load's unit", "at each knot"},
    {"over_place.range", "number or null", "load's unit", "largest minus least"},
    {"over_place.friction?", "list of numbers", "load's unit", "dry friction at each knot"},
    {"held_out_rms", "object", "", "error on data that the fit did not see"},
    {"held_out_rms.before", "number or null", "load's unit", "about the mean"},
    {"held_out_rms.after", "number or null", "load's unit", "after the fit"},
    {"steps", "list of objects", "", "course of the fit"},
    {"steps[].added", "text", "", "term"},
    {"steps[].held_out_rms", "number or null", "load's unit", "with it"},
    {"reversal", "text", "", "how friction reverses"},
    {"loss_per_cycle", "number or null", "load's unit times place's", "work lost"},
    {"reversals", "whole number", "", "of the motion"},
    {"speed", "object", "", "of the motion"},
    {"speed.percentile10", "number or null", "place's unit per s", "slow"},
    {"speed.percentile90", "number or null", "place's unit per s", "fast"},
    {"friction_undecided", "flag", "", "dry and viscous friction cannot be told apart"},
    {"alone", "object", "", "each kind of friction alone"},
    {"alone.dry", "number or null", "load's unit", "its size"},
    {"alone.dry_left", "number or null", "load's unit", "held-out error with it"},
    {"alone.viscous", "number or null", "load's unit per speed", "its coefficient"},
    {"alone.viscous_left", "number or null", "load's unit", "held-out error with it"},
    {"repeat_floor?", "number or null", "load's unit", "RMS difference of a repeated recording over the root of 2"},
    {"remarks", "list of texts", "", "what the reader must know"},
});

}  // namespace

std::span<const FileFormat> file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-axis/1", "axis.json", "friction, elasticity and inertia of one axis (docs/how-to/import-axis.md)",
       "`axis`", "", axis_fields},
  });
  return formats;
}

}  // namespace touchstone::axis
