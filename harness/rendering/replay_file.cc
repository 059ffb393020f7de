#include "harness/rendering/replay_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "harness/base/progress.h"
#include "harness/recording/recording_writer.h"

namespace touchstone::rendering {
using recording::RecordingStream;

TipSource tip_source(RecordingStream& stream) {
  return [&stream, block = recording::SampleBlock(), next = std::size_t{0}](TipState& tip) mutable {
    if (next == block.size()) {
      next = 0;
      if (!stream.next(block)) return false;
    }
    tip.t_s = block.motion.t_s[next];
    tip.p_W_m = block.motion.p_W_m[next];
    tip.q_WS = block.motion.q_WS.empty() ? Quat::Identity() : block.motion.q_WS[next];
    ++next;
    return true;
  };
}

ReplaySummary replay_file(Renderer& renderer, const std::filesystem::path& in, const std::filesystem::path& out) {
  auto stream = RecordingStream::open(in);
  recording::RenderedWriter writer(out, false);
  Progress progress("replay " + in.filename().string(), 0);
  ReplaySummary summary;
  replay(renderer, tip_source(stream), [&](const TipState& tip, const StepResult& result, double) {
    writer.append(tip.t_s, tip.p_W_m, result.contact_W_m, result.f_W_N, result.contact);
    ++summary.samples;
    if (result.contact) ++summary.in_contact;
    summary.largest_force_N = std::max(summary.largest_force_N, result.f_W_N.norm());
    summary.deepest_m = std::max(summary.deepest_m, result.depth_m);
    if (summary.samples % 65536 == 0) progress.update(summary.samples);
  });
  writer.commit();
  return summary;
}

ReplayTiming measure_steps(Renderer& renderer, const std::filesystem::path& in) {
  std::unique_ptr<RecordingStream> stream;
  return measure_steps(renderer, [&] {
    stream = std::make_unique<RecordingStream>(RecordingStream::open(in));
    return tip_source(*stream);
  });
}

OperationReport count_operations(Renderer& counted, const std::filesystem::path& in) {
  auto stream = RecordingStream::open(in);
  return count_operations(counted, tip_source(stream));
}

std::string summary_to_json(const ReplaySummary& summary) {
  return fmt::format("{{\"samples\": {}, \"in_contact\": {}, \"largest_force_N\": {}, \"deepest_m\": {}}}\n",
                     summary.samples, summary.in_contact, summary.largest_force_N, summary.deepest_m);
}

std::string summary_text(const ReplaySummary& summary, const std::filesystem::path& out) {
  return fmt::format("{}: {} samples, {} in contact, largest force {:.6g} N, deepest {:.6g} mm\n", out.string(),
                     summary.samples, summary.in_contact, summary.largest_force_N, summary.deepest_m * 1e3);
}

std::string timing_text(const ReplayTiming& timing) {
  return fmt::format(
      "step: mean {:.3f} us, median {:.3f} us, p99 {:.3f} us, p99.9 {:.3f} us, max {:.3f} us; build {:.1f} ms, {}\n",
      timing.mean_us, timing.median_us, timing.p99_us, timing.p999_us, timing.max_us, timing.build_ms,
      timing.memory_bytes ? fmt::format("{} bytes", *timing.memory_bytes) : "memory unknown");
}

std::string operations_text(const OperationReport& report) {
  return fmt::format("operations of a step: mean {:.1f}, median {:g}, max {}; all {}{} ({})\n", report.mean,
                     report.median, report.max, report.total(),
                     report.not_counted.empty() ? "" : "; not counted: " + report.not_counted,
                     how_searches_are_counted);
}

}  // namespace touchstone::rendering
