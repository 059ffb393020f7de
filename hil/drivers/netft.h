// ATI Net F/T: configuration over HTTP (netftapi2.xml), records over UDP (Raw Data Transfer, "RDT").
//   request, 8 bytes big-endian: 0x1234, command u16, sample count u32 (0: until told to stop)
//   record, 36 bytes big-endian: rdt_sequence u32, ft_sequence u32, status u32, Fx Fy Fz Tx Ty Tz int32 counts
// Source: ATI Net F/T manual, sections "RDT protocol" and "netftapi2.xml", and what a Gamma (firmware 2.2.59) answered
// (hil/emulators/netft_answers.h). Counts per force and per torque come from the device: they depend on its
// calibration. They and their units are indispensable; every other element may be missing.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>

#include "devices/interfaces.h"
#include "devices/known_device.h"

namespace touchstone::hil {

struct NetFtAddress {
  std::string host;
  int http_port = 80;
  int udp_port = 49152;
};

struct NetFtConfiguration {
  std::string product;
  std::string serial;  // of the transducer's calibration; empty where the device does not say
  double newtons_per_count = 0.0;
  double newton_metres_per_count = 0.0;
  double rate_Hz = 0.0;  // of the records, where the device says
};

// Parses netftapi2.xml; throws BadData naming the element that is indispensable and missing, or the unknown unit.
NetFtConfiguration parse_netft_configuration(std::string_view xml, const std::string& source);
// Asks the device within the deadline; throws DeviceError(absent | timed_out | failed).
NetFtConfiguration read_netft_configuration(const NetFtAddress& address, double timeout_s);

inline constexpr std::size_t rdt_record_bytes = 36;
inline constexpr std::size_t rdt_request_bytes = 8;
enum class RdtCommand : std::uint16_t {
  stop = 0,
  start_realtime = 2,
  start_buffered = 3,
  start_multi_unit = 4,
  reset_latch = 0x41,
  set_bias = 0x42,
  onrobot_filter = 0x81,  // onrobot.h
  onrobot_period = 0x82
};

struct RdtRecord {
  std::uint32_t rdt_sequence = 0, ft_sequence = 0, status = 0;
  std::array<std::int32_t, 6> counts{};
};
std::array<unsigned char, rdt_request_bytes> encode_request(RdtCommand command, std::uint32_t samples);
RdtRecord decode_record(std::span<const unsigned char, rdt_record_bytes> bytes);
std::array<unsigned char, rdt_record_bytes> encode_record(const RdtRecord& record);

// Status bits that make a sample useless.
inline constexpr std::uint32_t rdt_error_bit = 0x80000000U;

// Sequence numbers across their rollover, and what became of the stream.
class SequenceTracker {
 public:
  enum class Verdict { next, after_gap, repeated, reordered };
  // A jump back of less than 2^16 records is a late or repeated packet; anything else counts forward.
  Verdict accept(std::uint32_t sequence);
  [[nodiscard]] std::uint64_t unwrapped() const noexcept { return last_; }
  [[nodiscard]] const StreamCounters& counters() const noexcept { return counters_; }
  StreamCounters& counters() noexcept { return counters_; }

 private:
  bool started_ = false;
  std::uint64_t last_ = 0;
  std::uint64_t seen_ = 0;  // bit i: record last - i came
  StreamCounters counters_;
};

// Reads the configuration and opens the stream's socket.
std::unique_ptr<WrenchSource> open_netft(const NetFtAddress& address, double timeout_s, bool emulated);

extern const KnownDevice netft_device;

}  // namespace touchstone::hil
