#include "raw_streams.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

#include "harness/base/error.h"
#include "harness/recording/ati_calibration.h"
#include "harness/recording/raw_table.h"
#include "pose_faults.h"

namespace touchstone::acquisition {
using recording::force_units;
using recording::GaugeVoltages;
using recording::RawTable;
using recording::torque_units;

namespace {

GaugeVoltages mean_volts(const RawTable& table, const std::vector<double>& t,
                         const AcquisitionDescription::Interval& interval) {
  GaugeVoltages mean{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (t[i] < interval.from_s || t[i] > interval.to_s) continue;
    ++n;
    for (std::size_t k = 0; k < 6; ++k) mean[k] += table.column(fmt::format("v{}_V", k + 1))[i];
  }
  if (n < fewest_of_bias) {
    throw BadData(fmt::format(
        "{}: the bias interval {} to {} s holds {} samples; it must lie within {:.3f} to {:.3f} s of the force's clock",
        table.source(), interval.from_s, interval.to_s, n, t.front(), t.back()));
  }
  for (double& v : mean) v /= static_cast<double>(n);
  return mean;
}

// What the sensor itself said of its samples, as `touchstone hil record` and `touchstone import` write it.
void count_flags(const std::vector<double>& flags, const std::string& source, AcquisitionReport& report) {
  constexpr double most = std::numeric_limits<std::uint32_t>::max();
  std::size_t faulty = 0;
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (!(flags[i] >= 0.0 && flags[i] <= most && flags[i] == std::floor(flags[i])))
      throw BadData(fmt::format("{}: sample {}: flags {} is not a whole number from 0 on", source, i + 1, flags[i]));
    const auto bits = static_cast<std::uint32_t>(flags[i]);
    report.force_samples.saturated += (bits & recording::sample_saturated) != 0;
    report.force_samples.out_of_range += (bits & recording::sample_out_of_range) != 0;
    faulty += (bits & recording::sample_device_error) != 0;
  }
  if (faulty > 0) {
    report.notes.push_back(
        fmt::format("of {} of {} force samples the sensor reported an error: their forces may mean "
                    "nothing",
                    faulty, flags.size()));
  }
}

// Takes out what the tracker did not measure. Throws for a jump from which the pose does not come back.
void drop_unmeasured(const AcquisitionDescription& d, MotionStream& stream, AcquisitionReport& report) {
  const PoseFaults faults = find_pose_faults(stream.t_s, stream.tip_T_m, stream.q_TS);
  stream.noise_m = faults.noise_m;
  if (!faults.jumped.empty()) {
    throw BadData(fmt::format(
        "{}: at {:.3f} s the pose jumps by {:.3g} mm within one frame, faster than a hand, and does not come back: did "
        "the tracker take other markers for the probe's, or did its body slip? Set tracked to 0 where it is wrong, or "
        "record again",
        d.motion_file.string(), faults.jumped.front().from_s, 1e3 * faults.jumped.front().off_m));
  }
  if (!faults.any()) return;
  const auto say = [&](const std::vector<PoseFaults::Stretch>& all, std::string_view what) {
    if (all.empty()) return;
    const auto worst = std::ranges::max_element(all, {}, &PoseFaults::Stretch::off_m);
    report.notes.push_back(
        fmt::format("{} times the tracker {}, worst from {:.3f} to {:.3f} s by {:.3g} mm: those "
                    "poses count as not tracked",
                    all.size(), what, worst->from_s, worst->to_s, 1e3 * worst->off_m));
  };
  say(faults.held, "repeated its last pose while the probe moved on");
  say(faults.swapped, "jumped there and back faster than a hand");
  MotionStream measured;
  measured.noise_m = stream.noise_m;
  for (std::size_t i = 0; i < stream.t_s.size(); ++i) {
    if (!faults.measured[i]) {
      ++report.samples_without_tracking;
      continue;
    }
    measured.t_s.push_back(stream.t_s[i]);
    measured.tip_T_m.push_back(stream.tip_T_m[i]);
    measured.q_TS.push_back(stream.q_TS[i]);
  }
  stream = std::move(measured);
}

}  // namespace

ForceStream read_force(const AcquisitionDescription& d, AcquisitionReport& report) {
  const RawTable table(d.force_file);
  ForceStream stream;
  stream.t_s = table.times_s();
  report.force_samples.total = table.rows();
  if (table.has("v1_V")) {
    if (!d.calibration_file)
      throw BadData(
          fmt::format("{}: /force/calibration: is needed to turn gauge voltages into forces", d.file.string()));
    const auto calibration = recording::read_ati_calibration(*d.calibration_file, d.serial);
    const GaugeVoltages bias = d.bias ? mean_volts(table, stream.t_s, *d.bias) : GaugeVoltages{};
    for (std::size_t i = 0; i < table.rows(); ++i) {
      GaugeVoltages v{};
      for (std::size_t k = 0; k < 6; ++k) v[k] = table.column(fmt::format("v{}_V", k + 1))[i];
      const auto sample = apply_calibration(calibration, v, bias);
      report.force_samples.saturated += (sample.flags & recording::sample_saturated) != 0;
      report.force_samples.out_of_range += (sample.flags & recording::sample_out_of_range) != 0;
      report.force_samples.not_finite += (sample.flags & recording::sample_not_finite) != 0;
      stream.wrench.push_back(sample.wrench);
    }
  } else {
    const auto f = table.vectors("f", force_units, false), torque = table.vectors("t", torque_units, false);
    for (std::size_t i = 0; i < f.size(); ++i) stream.wrench.push_back({f[i], torque[i]});
    report.force_samples.not_finite =
        static_cast<std::size_t>(std::ranges::count_if(stream.wrench, [](const Wrench& w) { return !w.finite(); }));
    if (table.has("flags")) count_flags(table.column("flags"), table.source(), report);
  }
  if (report.force_samples.not_finite > 0)
    throw BadData(fmt::format("{}: {} of {} samples are not finite; take those lines out, or record again",
                              d.force_file.string(), report.force_samples.not_finite, table.rows()));
  if (report.force_samples.saturated > 0) {
    report.notes.push_back(fmt::format("{} of {} force samples have a saturated gauge: forces there are too small",
                                       report.force_samples.saturated, table.rows()));
  }
  if (report.force_samples.out_of_range > 0) {
    report.notes.push_back(fmt::format("{} of {} force samples lie beyond the sensor's calibrated range",
                                       report.force_samples.out_of_range, table.rows()));
  }
  return stream;
}

MotionStream read_motion(const AcquisitionDescription& d, AcquisitionReport& report) {
  const RawTable table(d.motion_file);
  const auto t = table.times_s();
  const auto p = table.vectors("", length_units, false);
  const auto q = table.rotations();
  MotionStream stream;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (table.has("tracked") && table.column("tracked")[i] == 0.0) {
      ++report.samples_without_tracking;
      continue;
    }
    stream.t_s.push_back(t[i]);
    stream.tip_T_m.push_back(p[i] + q[i] * d.tip_P_m);
    stream.q_TS.push_back((q[i] * d.q_PS).normalized());
  }
  drop_unmeasured(d, stream, report);
  for (std::size_t i = 1; i < stream.t_s.size(); ++i) {
    if (stream.t_s[i] - stream.t_s[i - 1] > d.largest_gap_s) stream.gaps.emplace_back(stream.t_s[i - 1], stream.t_s[i]);
  }
  if (stream.t_s.size() < 2)
    throw BadData(
        fmt::format("{}: the tracker saw the probe in {} of {} samples, and 2 are needed: is the body in the file the "
                    "probe's, and were its markers in view?",
                    d.motion_file.string(), stream.t_s.size(), t.size()));
  if (!stream.gaps.empty() && !d.keep_around_gaps) {
    throw BadData(fmt::format(
        "{}: the tracker lost the probe {} times for longer than {} s, first from {:.3f} to {:.3f} s{}; set "
        "/motion/keep_around_gaps to leave that time out, or record again",
        d.motion_file.string(), stream.gaps.size(), d.largest_gap_s, stream.gaps.front().first,
        stream.gaps.front().second, report.notes.empty() ? "" : fmt::format(" ({})", report.notes.back())));
  }
  if (!stream.gaps.empty())
    report.notes.push_back(fmt::format("{} gaps in the tracking were left out", stream.gaps.size()));
  return stream;
}

}  // namespace touchstone::acquisition
