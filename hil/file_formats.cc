#include "hil/file_formats.h"

#include <array>

namespace touchstone::hil {
namespace {

constexpr auto picture_part_fields = std::to_array<FormatField>({
    {"title", "text", "", "heading"},
    {"x_label", "text", "", "of the axis"},
    {"y_label", "text", "", "of the axis"},
    {"curves?", "list of objects", "", "lines or points"},
    {"curves[].name", "text", "", "legend"},
    {"curves[].points", "flag", "", "points, not a line"},
    {"curves[].x", "list of numbers", "", "along x_label"},
    {"curves[].y", "list of numbers", "", "along y_label"},
});
constexpr FormatPart picture_part{picture_part_fields};

constexpr auto hardware_fields = std::to_array<FormatField>({
    {"devices", "list of objects", "", "one for each"},
    {"devices[].id", "text", "", "`touchstone hil probe` lists them"},
    {"devices[].serial?", "text", "", "of the device; any if it is not said"},
    {"devices[].connected?", "flag", "", "its absence is a failure"},
    {"devices[].fixture?", "text", "", "what it is mounted on"},
    {"devices[].force_limit_N?", "number", "N", "largest force that may be commanded; 0 (default): none"},
    {"devices[].address?", "text", "", "host, or device file"},
    {"devices[].http_port?", "whole number", "", "of a network sensor"},
    {"devices[].udp_port?", "whole number", "", "of a network sensor"},
    {"devices[].port?", "whole number", "", "of a tracker's or a service's server"},
    {"devices[].baud?", "whole number", "1/s", "of a serial line"},
    {"devices[].rate_Hz?", "number", "Hz", "of a device that does not state its own"},
    {"devices[].body?", "text", "", "tracker: rigid body"},
    {"devices[].tool_file?", "text", "", "NDI: definition of the passive tool"},
    {"devices[].newtons_per_unit?", "number", "N", "load cell: of what its firmware prints"},
    {"devices[].value?", "whole number", "", "load cell: which number of a line, from 1"},
    {"devices[].axis?", "text", "", "load cell: x, y or z"},
    {"devices[].library?", "text", "", "vendor's library"},
    {"devices[].firmware?", "text", "", "vendor's firmware file"},
    {"devices[].dead_man?", "text", "", "what must be held while a test commands forces"},
    {"devices[].limits?", "object", "", "limits of the lab's tests for this device"},
    {"devices[].limits.*", "number", "as its name says", "limit"},
    {"devices[].calibration?", "object", "", "of the device"},
    {"devices[].calibration.file", "text", "", "relative to this file"},
    {"devices[].calibration.sha256?", "text", "", "hash of its contents"},
    {"devices[].calibration.expires?", "text", "", "day, ISO 8601"},
});

constexpr auto session_fields = std::to_array<FormatField>({
    {"streams", "list of objects", "", "one for each device"},
    {"streams[].name", "text", "", "of the stream"},
    {"streams[].kind", "text", "", "force or motion"},
    {"streams[].table", "text", "", "CSV beside this file"},
    {"streams[].device", "text", "", "id"},
    {"streams[].serial", "text", "", "of the device"},
    {"streams[].firmware", "text", "", "of the device"},
    {"streams[].calibration", "text", "", "of the device"},
    {"streams[].emulated", "flag", "", "no device"},
    {"streams[].started", "text", "", "time, UTC"},
    {"streams[].scheduling", "text", "", "of the recording thread"},
    {"streams[].clock", "text", "", "sequence, ticks or host: what the times are from"},
    {"streams[].samples", "whole number", "", "in the table"},
    {"streams[].missing_samples", "whole number", "", "that the device sent and did not arrive"},
    {"streams[].left_out_samples", "whole number", "", "without a valid value"},
    {"streams[].damaged_bytes", "whole number", "byte", "of the raw file that could not be read"},
    {"streams[].rate_Hz", "number or null", "Hz", "samples per second"},
    {"streams[].clock_ppm", "number or null", "1e-6", "device's clock against the host's"},
    {"streams[].rate_change_ppm", "number or null", "1e-6", "over the run"},
    {"streams[].mean_delay_s", "number or null", "s", "of arrival against the fitted clock"},
    {"streams[].worst_delay_s", "number or null", "s", "largest"},
    {"streams[].axis_uncertainty_s", "number or null", "s", "of the time axis"},
});

constexpr auto raw_fields = std::to_array<FormatField>({
    {"device", "text", "", "id"},
    {"serial", "text", "", "of the device"},
    {"firmware", "text", "", "of the device"},
    {"calibration", "text", "", "of the device"},
    {"emulated?", "flag", "", "no device; true if it is not said"},
    {"scheduling", "text", "", "of the recording thread"},
    {"started", "text", "", "time, UTC"},
    {"nominal_rate_Hz", "number", "Hz", "samples per second"},
    {"position?", "flag", "", "samples have a position"},
    {"pose?", "flag", "", "samples have a pose"},
    {"clock?", "text", "", "sequence, ticks or host"},
    {"ticks_per_s?", "number", "1/s", "of the device's clock"},
});

constexpr auto live_fields = std::to_array<FormatField>({
    {"device", "text", "", "id"},
    {"serial", "text", "", "of the device"},
    {"firmware", "text", "", "of the device"},
    {"emulated", "flag", "", "no device"},
    {"model_sha256", "text", "", "of the model file"},
    {"mesh_sha256", "text", "", "of the mesh"},
    {"ticks", "whole number", "", "of the loop"},
    {"wanted_rate_Hz", "number", "Hz", "that was asked for"},
    {"rate_Hz", "number or null", "Hz", "reached"},
    {"missed_deadlines", "whole number", "", "ticks that came too late"},
    {"ticks_without_new_state", "whole number", "", "the device had nothing new"},
    {"late_median_ms", "number or null", "ms", "median delay of a tick"},
    {"late_p99_ms", "number or null", "ms", "99th percentile"},
    {"late_max_ms", "number or null", "ms", "largest"},
    {"step_median_us", "number or null", "us", "median of the renderer's step"},
    {"step_p99_us", "number or null", "us", "99th percentile"},
    {"largest_force_N", "number or null", "N", "commanded"},
    {"cut_by_guard", "whole number", "", "ticks whose force the guard reduced"},
    {"difference_from_replay_N", "number or null", "N", "largest difference from a replay of the same path"},
    {"trip", "text", "", "why the guard ended the run"},
    {"zero_confirmed", "flag", "", "the device was at zero force at the end; false: a force may have stayed on"},
    {"device_open_s", "number", "s", "that the device needed to open: how much later zero comes if its driver dies"},
    {"ended", "text", "", "why the run ended"},
    {"whole", "flag", "", "every tick was recorded"},
    {"guard", "list of objects", "", "what the guard did"},
    {"guard[].t_s", "number", "s", "since the start"},
    {"guard[].state", "text", "", "that it changed to"},
    {"guard[].reason", "text", "", "in a word"},
    {"guard[].what", "text", "", "in a sentence"},
    {"guard[].times", "whole number", "", "that it happened in a row"},
    {"not_finite", "list of texts", "", "figures above that were no finite number"},
});

constexpr auto hil_evidence_fields = std::to_array<FormatField>({
    {"test", "text", "", "name"},
    {"emulated", "flag", "", "no device"},
    {"device", "text", "", "id"},
    {"serial", "text", "", "of the device"},
    {"firmware", "text", "", "of the device"},
    {"calibration", "text", "", "of the device"},
    {"fixture", "text", "", "what it is mounted on"},
    {"scheduling", "text", "", "of the recording thread"},
    {"clock", "text", "", "of the host"},
    {"commit", "text", "", "of Touchstone"},
    {"dirty", "flag", "", "built from a changed checkout"},
    {"when", "text", "", "time, UTC"},
    {"counters", "object", "", "samples of the sensor"},
    {"counters.received", "whole number", "", "arrived"},
    {"counters.lost", "whole number", "", "missing in the sequence"},
    {"counters.repeated", "whole number", "", "twice"},
    {"counters.reordered", "whole number", "", "late"},
    {"counters.malformed", "whole number", "", "not understood"},
    {"counters.strangers", "whole number", "", "from another sender"},
    {"counters.device_errors", "whole number", "", "flagged by the device"},
    {"measurements?", "object", "", "figures of the test"},
    {"measurements.*", "number or null", "as its name says", "value"},
    {"limits?", "object", "", "what the figures are held against"},
    {"limits.*", "object", "", "of the figure of that name"},
    {"limits.*.least?", "number", "figure's unit", "least value allowed"},
    {"limits.*.most?", "number", "figure's unit", "largest value allowed"},
    {"failures?", "list of texts", "", "limits that do not hold"},
    {"sensor?", "text", "", "that measured"},
    {"dead_man?", "text", "", "what was held"},
    {"pictures", "list of objects", "", "what the page draws", &picture_part},
    {"samples?", "text", "", "CSV beside this file"},
    {"runs?", "list of objects", "", "runs of the device"},
    {"runs[].start_s", "number", "s", "begin"},
    {"runs[].trip", "text", "", "why the guard ended it"},
    {"runs[].saturated_ticks", "whole number", "", "ticks at the force limit"},
    {"runs[].ticks", "whole number", "", "of the loop"},
});

constexpr auto probe_fields = std::to_array<FormatField>({
    {"devices?", "list of objects", "", "one for each that was asked"},
    {"devices[].id", "text", "", "as the hardware map spells it"},
    {"devices[].name", "text", "", "in words"},
    {"devices[].status", "text", "", "present, or why not, in a word"},
    {"devices[].serial", "text", "", "of the device"},
    {"devices[].reason", "text", "", "why it cannot be used"},
    {"devices[].required", "flag", "", "the map calls it connected"},
});

}  // namespace

std::span<const FileFormat> file_formats() {
  static const auto formats = std::to_array<FileFormat>({
      {"touchstone-hardware/1", "hardware.json",
       "devices that a laboratory has, with calibration, fixture and limits (docs/how-to/lab.md)", "",
       "`hil`, the tests of the lab (TOUCHSTONE_HARDWARE_MAP)", hardware_fields},
      {"touchstone-session/1", "session.json", "the streams of one run of `hil record`, each with its table",
       "`hil record`, `hil recover`", "`acquire`", session_fields},
      {"touchstone-raw/1", "head of NAME.tsraw",
       "first line of a raw stream; binary samples follow. `hil recover` turns it into tables", "`hil record`",
       "`hil recover`", raw_fields, true},
      {"touchstone-live/1", "result.json",
       "a renderer on a device: rates, delays, forces, and the difference from a replay", "`hil render`", "",
       live_fields},
      {"touchstone-hil-evidence/1", "TEST.json", "what one test of the lab measured (docs/how-to/lab.md)",
       "tests of the lab (TOUCHSTONE_HIL_EVIDENCE)", "`hil report`", hil_evidence_fields},
      {"touchstone-probe/1", "FILE of `hil probe --json`", "which devices are here", "`hil probe`", "", probe_fields},
  });
  return formats;
}

}  // namespace touchstone::hil
