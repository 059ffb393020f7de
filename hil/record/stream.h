// What the recorder of many devices reads: a force sensor, a tracker or a haptic device.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "devices/interfaces.h"
#include "record/raw_recording.h"

namespace touchstone::hil {

enum class StreamKind : std::uint8_t { force, motion };

class Stream {
 public:
  virtual ~Stream() = default;
  [[nodiscard]] virtual StreamKind kind() const = 0;
  // What the file's header says of the device and its clock; scheduling and start are the recorder's.
  [[nodiscard]] virtual RawHeader header() const = 0;
  virtual void start() = 0;
  virtual void stop() noexcept = 0;
  // As WrenchSource::read().
  virtual std::size_t read(std::span<RawSample> out, double deadline_s) = 0;
  [[nodiscard]] virtual StreamCounters counters() const = 0;
};

// What a force sensor's file says of it; as Stream::header(). `assumed_rate_Hz` is for sensors that do not state
// theirs; 0: unknown.
RawHeader header_of(const WrenchSource& source, double assumed_rate_Hz = 0.0);
std::unique_ptr<Stream> stream_of(std::unique_ptr<WrenchSource> source, double assumed_rate_Hz = 0.0);
std::unique_ptr<Stream> stream_of(std::unique_ptr<PoseSource> source);
// The handle of a haptic device: zero force is commanded at that rate, and its position and buttons (device status) are
// recorded. Throws UsageError where the rate is not above 0.
std::unique_ptr<Stream> stream_of(std::unique_ptr<HapticDevice> device, double rate_Hz);

}  // namespace touchstone::hil
