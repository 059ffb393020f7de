#include "record/stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "harness/base/error.h"

namespace touchstone::hil {
namespace {

class WrenchStream final : public Stream {
 public:
  WrenchStream(std::unique_ptr<WrenchSource> source, double assumed_rate_Hz)
      : source_(std::move(source)), assumed_rate_Hz_(assumed_rate_Hz), samples_(1024) {}

  [[nodiscard]] StreamKind kind() const override { return StreamKind::force; }
  [[nodiscard]] RawHeader header() const override { return header_of(*source_, assumed_rate_Hz_); }
  void start() override { source_->start(); }
  void stop() noexcept override { source_->stop(); }
  std::size_t read(std::span<RawSample> out, double deadline_s) override {
    const std::size_t n = source_->read(std::span(samples_).first(std::min(out.size(), samples_.size())), deadline_s);
    for (std::size_t i = 0; i < n; ++i) out[i] = {samples_[i]};
    return n;
  }
  [[nodiscard]] StreamCounters counters() const override { return source_->counters(); }

 private:
  std::unique_ptr<WrenchSource> source_;
  double assumed_rate_Hz_;
  std::vector<WrenchSample> samples_;
};

class PoseStream final : public Stream {
 public:
  explicit PoseStream(std::unique_ptr<PoseSource> source) : source_(std::move(source)), samples_(256) {}

  [[nodiscard]] StreamKind kind() const override { return StreamKind::motion; }
  [[nodiscard]] RawHeader header() const override {
    RawHeader header;
    header.device = source_->identity();
    header.nominal_rate_Hz = source_->nominal_rate_Hz();
    header.pose = true;
    header.ticks_per_s = source_->ticks_per_s();
    header.clock = header.ticks_per_s > 0.0    ? StreamClock::ticks
                   : source_->numbers_frames() ? StreamClock::sequence
                                               : StreamClock::host;
    return header;
  }
  void start() override { source_->start(); }
  void stop() noexcept override { source_->stop(); }
  std::size_t read(std::span<RawSample> out, double deadline_s) override {
    const std::size_t n = source_->read(std::span(samples_).first(std::min(out.size(), samples_.size())), deadline_s);
    for (std::size_t i = 0; i < n; ++i) {
      const PoseSample& from = samples_[i];
      RawSample& to = out[i];
      to = {};
      to.wrench.t_s = from.t_s;
      to.wrench.sequence = from.sequence;
      to.wrench.flags = from.flags;
      to.wrench.device_status = from.device_status;
      to.p_W_m = from.p_W_m;
      to.q_WB = from.q_WB;
      to.ticks = from.ticks;
    }
    return n;
  }
  [[nodiscard]] StreamCounters counters() const override { return source_->counters(); }

 private:
  std::unique_ptr<PoseSource> source_;
  std::vector<PoseSample> samples_;
};

class HapticStream final : public Stream {
 public:
  HapticStream(std::unique_ptr<HapticDevice> device, double rate_Hz) : device_(std::move(device)), rate_Hz_(rate_Hz) {
    if (!(rate_Hz > 0.0))
      throw UsageError(fmt::format("{}: a rate of {} Hz; it must be above 0", device_->identity().id, rate_Hz));
  }

  [[nodiscard]] StreamKind kind() const override { return StreamKind::motion; }
  [[nodiscard]] RawHeader header() const override {
    RawHeader header;
    header.device = device_->identity();
    header.nominal_rate_Hz = rate_Hz_;
    header.pose = true;
    header.clock = StreamClock::host;  // this machine asks: the time of the answer is known, and it is not even
    return header;
  }
  void start() override { next_s_ = clock_.now_s(); }
  void stop() noexcept override { device_->zero_force(); }
  std::size_t read(std::span<RawSample> out, double deadline_s) override {
    if (out.empty() || next_s_ > deadline_s) {
      clock_.sleep_until(deadline_s);
      return 0;
    }
    clock_.sleep_until(next_s_);
    const double now = clock_.now_s();
    const DeviceState state = device_->exchange(Vec3::Zero(), now + patience_s);
    // Ticks that were missed are not made up for: they count as lost.
    const auto steps = static_cast<std::uint64_t>(std::max(1.0, (clock_.now_s() - next_s_) * rate_Hz_ + 1.0));
    next_s_ += static_cast<double>(steps) / rate_Hz_;
    RawSample& sample = out.front();
    sample = {};
    sample.wrench.t_s = state.t_s;
    sample.wrench.sequence = sequence_;
    sample.wrench.device_status = state.buttons;
    sample.wrench.flags = after_gap_ ? recording::sample_after_gap : recording::sample_ok;
    // Before, positions are arbitrary.
    if (!device_->calibrated()) sample.wrench.flags |= recording::sample_not_tracked;
    sample.p_W_m = state.p_W_m;
    sequence_ += steps;
    after_gap_ = steps > 1;
    ++counters_.received;
    counters_.lost += steps - 1;
    return 1;
  }
  [[nodiscard]] StreamCounters counters() const override { return counters_; }

 private:
  static constexpr double patience_s = 0.1;
  std::unique_ptr<HapticDevice> device_;
  double rate_Hz_, next_s_ = 0.0;
  std::uint64_t sequence_ = 0;
  bool after_gap_ = false;
  StreamCounters counters_;
  MonotonicClock clock_;
};

}  // namespace

RawHeader header_of(const WrenchSource& source, double assumed_rate_Hz) {
  RawHeader header;
  header.device = source.identity();
  header.nominal_rate_Hz = source.nominal_rate_Hz() > 0.0 ? source.nominal_rate_Hz() : assumed_rate_Hz;
  header.clock = source.numbers_records() ? StreamClock::sequence : StreamClock::host;
  return header;
}

std::unique_ptr<Stream> stream_of(std::unique_ptr<WrenchSource> source, double assumed_rate_Hz) {
  return std::make_unique<WrenchStream>(std::move(source), assumed_rate_Hz);
}

std::unique_ptr<Stream> stream_of(std::unique_ptr<PoseSource> source) {
  return std::make_unique<PoseStream>(std::move(source));
}

std::unique_ptr<Stream> stream_of(std::unique_ptr<HapticDevice> device, double rate_Hz) {
  return std::make_unique<HapticStream>(std::move(device), rate_Hz);
}

}  // namespace touchstone::hil
