#include "harness/baseline/file_formats.h"

#include <array>

namespace touchstone::baseline {
namespace {

constexpr auto position_limits_fields = std::to_array<FormatField>({
    {"beyond?", "whole number", "", "samples that may exceed the limit of a sample"},
    {"atol_m?", "number", "m", "limit of a sample: atol + rtol abs(golden) + rpeak peak"},
    {"rtol?", "number", "1", "see atol"},
    {"rpeak?", "number", "1", "see atol; the peak is the golden's largest magnitude"},
    {"rms_m?", "number", "m", "limit of the RMS error"},
    {"p99_m?", "number", "m", "limit of the error's 99th percentile"},
    {"max_m?", "number", "m", "limit of the largest error"},
    {"direction_rad?", "number", "rad", "largest angle to the golden's vector"},
    {"direction_floor_m?", "number", "m", "magnitude above which the angle is judged"},
});
constexpr FormatPart position_limits{position_limits_fields};

constexpr auto force_limits_fields = std::to_array<FormatField>({
    {"beyond?", "whole number", "", "samples that may exceed the limit of a sample"},
    {"atol_N?", "number", "N", "limit of a sample: atol + rtol abs(golden) + rpeak peak"},
    {"rtol?", "number", "1", "see atol"},
    {"rpeak?", "number", "1", "see atol; the peak is the golden's largest magnitude"},
    {"rms_N?", "number", "N", "limit of the RMS error"},
    {"p99_N?", "number", "N", "limit of the error's 99th percentile"},
    {"max_N?", "number", "N", "limit of the largest error"},
    {"direction_rad?", "number", "rad", "largest angle to the golden's vector"},
    {"direction_floor_N?", "number", "N", "magnitude above which the angle is judged"},
});
constexpr FormatPart force_limits{force_limits_fields};

constexpr auto torque_limits_fields = std::to_array<FormatField>({
    {"beyond?", "whole number", "", "samples that may exceed the limit of a sample"},
    {"atol_Nm?", "number", "Nm", "limit of a sample: atol + rtol abs(golden) + rpeak peak"},
    {"rtol?", "number", "1", "see atol"},
    {"rpeak?", "number", "1", "see atol; the peak is the golden's largest magnitude"},
    {"rms_Nm?", "number", "Nm", "limit of the RMS error"},
    {"p99_Nm?", "number", "Nm", "limit of the error's 99th percentile"},
    {"max_Nm?", "number", "Nm", "limit of the largest error"},
    {"direction_rad?", "number", "rad", "largest angle to the golden's vector"},
    {"direction_floor_Nm?", "number", "Nm", "magnitude above which the angle is judged"},
});
constexpr FormatPart torque_limits{torque_limits_fields};

constexpr auto orientation_limits_fields = std::to_array<FormatField>({
    {"beyond?", "whole number", "", "samples that may exceed the limit of a sample"},
    {"atol_rad?", "number", "rad", "limit of a sample"},
    {"rtol?", "number", "1", "not used for angles"},
    {"rpeak?", "number", "1", "not used for angles"},
    {"rms_rad?", "number", "rad", "limit of the RMS error"},
    {"p99_rad?", "number", "rad", "limit of the error's 99th percentile"},
    {"max_rad?", "number", "rad", "limit of the largest error"},
});
constexpr FormatPart orientation_limits{orientation_limits_fields};

constexpr auto time_limits_fields = std::to_array<FormatField>({
    {"beyond?", "whole number", "", "samples that may exceed the limit of a sample"},
    {"atol_s?", "number", "s", "limit of a sample: atol + rtol abs(golden) + rpeak peak"},
    {"rtol?", "number", "1", "see atol"},
    {"rpeak?", "number", "1", "see atol; the peak is the golden's largest value"},
    {"rms_s?", "number", "s", "limit of the RMS error"},
    {"p99_s?", "number", "s", "limit of the error's 99th percentile"},
    {"max_s?", "number", "s", "limit of the largest error"},
});
constexpr FormatPart time_limits{time_limits_fields};

constexpr auto contact_limits_fields = std::to_array<FormatField>({
    {"beyond?", "whole number", "", "samples whose contact state may differ"},
    {"tube_s?", "number", "s", "a contact may begin or end this much earlier or later"},
});
constexpr FormatPart contact_limits{contact_limits_fields};

constexpr auto tolerance_fields = std::to_array<FormatField>({
    {"reason?", "text", "", "why these limits; a golden case must say it"},
    {"time?", "object", "", "limits of the times", &time_limits},
    {"position?", "object", "", "limits of the tip's position", &position_limits},
    {"contact_position?", "object", "", "limits of the surface contact point", &position_limits},
    {"force?", "object", "", "limits of the force", &force_limits},
    {"torque?", "object", "", "limits of the torque", &torque_limits},
    {"orientation?", "object", "", "limits of the orientation", &orientation_limits},
    {"contact?", "object", "", "limits of the contact state", &contact_limits},
});
constexpr FormatPart tolerance_part{tolerance_fields};

constexpr auto golden_case_fields = std::to_array<FormatField>({
    {"name", "text", "", "that of its folder: small letters, digits and -"},
    {"summary", "text", "", "a line"},
    {"surface?", "object", "", "the one body; a case has this or \"scene\""},
    {"surface.name?", "text", "", "synthetic surface (`touchstone list surfaces`)"},
    {"surface.parameters?", "object", "", "of the synthetic surface"},
    {"surface.parameters.*", "number", "as its name says", "value"},
    {"surface.triangles?", "whole number", "", "of its mesh"},
    {"surface.mesh?", "text", "", "or a mesh, a file of the folder"},
    {"surface.unit?", "text", "", "of that mesh"},
    {"scene?", "touchstone-scene/1", "", "several bodies; their files lie in the folder"},
    {"trajectory", "object", "", "the path of the tip"},
    {"trajectory.name?", "text", "", "synthetic trajectory (`touchstone list trajectories`)"},
    {"trajectory.parameters?", "object", "", "of the synthetic trajectory"},
    {"trajectory.parameters.*", "number", "as its name says", "value"},
    {"trajectory.seed?", "whole number", "", "of its random numbers; 1 by default"},
    {"trajectory.rate_Hz?", "number", "Hz", "samples per second; 1000 by default"},
    {"trajectory.offset_m?", "list of numbers", "m", "added to its positions"},
    {"trajectory.file?", "text", "", "or a recorded path, a file of the folder"},
    {"scale?", "number", "1", "multiplies every length; 1 by default"},
    {"speed?", "number", "1", "runs the path that many times as fast; 1 by default"},
    {"models", "object", "", "at least one"},
    {"models.*", "touchstone-model/1", "", "a model, by the name of its golden"},
    {"tolerance", "object", "", "how far a result may be from its golden", &tolerance_part},
    {"jnd_share?", "number", "1", "the tolerance is at most this share of what a person could feel; 0.05 by default"},
});

constexpr auto golden_summary_fields = std::to_array<FormatField>({
    {"case", "text", "", "name of the case"},
    {"models", "object", "", "one entry for each model"},
    {"models.*", "object", "", "a model, by its name in the case"},
    {"models.*.samples", "whole number", "", "of the run"},
    {"models.*.contact_samples", "whole number", "", "samples in contact"},
    {"models.*.contact_events", "whole number", "", "beginnings and ends of contact"},
    {"models.*.peak_force_N", "number", "N", "largest magnitude"},
    {"models.*.rms_force_N", "number", "N", "root mean square of the magnitude"},
    {"models.*.mean_fx_N", "number", "N", "mean force along the object's x"},
    {"models.*.mean_fy_N", "number", "N", "along y"},
    {"models.*.mean_fz_N", "number", "N", "along z"},
    {"models.*.contact_path_m", "number", "m", "way of the surface contact point"},
    {"models.*.sha256", "text", "", "of the golden's values"},
    {"models.*.operations?", "whole number", "", "operations of the whole run, of a renderer that can be counted"},
    {"models.*.operations_max_step?", "whole number", "", "operations of the most expensive step"},
});

constexpr auto comparison_fields = std::to_array<FormatField>({
    {"verdict", "text", "", "equal, better, worse, missing or invalid"},
    {"drift", "flag", "", "whether any bit differs"},
    {"drift_rows", "whole number", "", "rows in which a bit differs"},
    {"rows", "object", "", "how long the two are"},
    {"rows.expected", "whole number", "", "rows of the first"},
    {"rows.obtained", "whole number", "", "rows of the second"},
    {"problems", "list of texts", "", "why they cannot be compared, or not wholly"},
    {"quantities", "list of objects", "", "one for each quantity that both have"},
    {"quantities[].name", "text", "", "time, position, force, torque, orientation, contact_position or contact"},
    {"quantities[].unit", "text", "", "of its errors"},
    {"quantities[].verdict", "text", "", "of this quantity"},
    {"quantities[].rms", "number or null", "its \"unit\"", "RMS error"},
    {"quantities[].p99", "number or null", "its \"unit\"", "99th percentile of the error"},
    {"quantities[].max", "number or null", "its \"unit\"", "largest error"},
    {"quantities[].peak", "number or null", "its \"unit\"", "largest magnitude of the expected values"},
    {"quantities[].beyond", "whole number", "", "samples that exceed the limit of a sample"},
    {"quantities[].drift_rows", "whole number", "", "rows in which a bit differs"},
    {"quantities[].tolerance_used", "number or null", "1", "largest share of its limit; above 1 is beyond tolerance"},
    {"quantities[].gates", "list of objects", "", "limits of the whole run"},
    {"quantities[].gates[].name", "text", "", "rms, p99 or max"},
    {"quantities[].gates[].value", "number or null", "its \"unit\"", "reached"},
    {"quantities[].gates[].limit", "number", "its \"unit\"", "allowed"},
    {"quantities[].gates[].passed", "flag", "", "whether it holds"},
    {"quantities[].worst", "object", "", "the row with the largest share of its limit"},
    {"quantities[].worst.row", "whole number", "", "from 1"},
    {"quantities[].worst.expected", "list of numbers", "its \"unit\"", "there"},
    {"quantities[].worst.obtained", "list of numbers", "its \"unit\"", "there"},
    {"contact_events", "object", "", "beginnings and ends of contact"},
    {"contact_events.expected", "whole number", "", "of the first"},
    {"contact_events.obtained", "whole number", "", "of the second"},
    {"contact_events.max_shift_s", "number or null", "s", "largest difference in time of a pair"},
    {"contact_events.mean_shift_s", "number or null", "s", "mean of them"},
    {"metrics", "object", "", "the same as figures, by name and unit"},
    {"metrics.*", "number", "as its name says", "value"},
});

}  // namespace

std::span<const FileFormat> file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-tolerance/1", "tolerance.json",
       "how far two recordings may differ; what is not given keeps its default, and no quantity can be left out", "",
       "`compare --tolerance`", tolerance_fields},
      {"touchstone-golden-case/1", "case.json",
       "a golden case: what runs, and how far its result may be from the golden (docs/how-to/golden.md)",
       "`discrepancy` (offer)", "`check`, `golden`, `scorecard`", golden_case_fields},
      {"touchstone-golden-summary/1", "expected.summary.json",
       "the goldens of a case in a few numbers that read well in a diff", "`golden accept`", "`check`",
       golden_summary_fields},
      {"touchstone-comparison/1", "comparison.json", "how two recordings differ, quantity by quantity",
       "`compare --json`, `check` (for a case that fails)", "", comparison_fields},
  });
  return formats;
}

}  // namespace touchstone::baseline
