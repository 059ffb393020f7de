// A raw recording that survives a crash: an append-only file of blocks, each with its own checksum. What was written
// stays readable whatever happens to the program, the disk or the last block.
//   file:   "TSRAW1\n", header length u32, header JSON, xxh64 of both
//   block:  magic u32, samples u32, first sample's number u64, xxh64 u64 over the fields before and the samples
//   sample: t_s, device sequence u64, force 3, torque 3, flags u32, device status u32; where the header says
//           "position": true, the tip's position 3; where it says "pose": true, position 3, orientation w x y z, and
//           the device's own clock u64. Doubles and integers in the machine's little-endian order.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "devices/interfaces.h"

namespace touchstone::hil {

struct RawSample {
  WrenchSample wrench;
  Vec3 p_W_m = Vec3::Zero();
  Quat q_WB = Quat::Identity();
  std::uint64_t ticks = 0;  // of the device's own clock, RawHeader::ticks_per_s
};

// How the samples of a file got their time.
enum class StreamClock : std::uint8_t {
  sequence,  // the device numbers its samples, which it takes at a constant rate
  ticks,     // the device stamps each sample by a clock of its own
  host,      // by their arrival alone: nothing else is known
};
std::string_view to_string(StreamClock clock);

struct RawHeader {
  DeviceIdentity device;
  std::string scheduling;  // "SCHED_FIFO 80" or "SCHED_OTHER"
  std::string started;     // UTC
  double nominal_rate_Hz = 0.0;
  bool position = false;
  bool pose = false;
  StreamClock clock = StreamClock::sequence;
  double ticks_per_s = 0.0;

  [[nodiscard]] std::size_t sample_bytes() const { return pose ? 136 : position ? 96 : 72; }
};
std::string header_json(const RawHeader& header);
RawHeader parse_header(const std::string& text, const std::string& source);

struct RecoveryReport {
  RawHeader header;
  std::uint64_t samples = 0;  // in sound blocks
  std::uint64_t blocks = 0;
  std::uint64_t damaged_bytes = 0;    // skipped: torn last block or a bad sector
  std::uint64_t missing_samples = 0;  // by the numbers of the blocks around damage
};

// The header alone; throws as read_raw().
RawHeader read_raw_header(const std::filesystem::path& path);

// Reads every sound block in order; damaged ones are skipped up to the next sound one and counted. Throws BadData when
// the file is not a raw recording or its header is damaged.
RecoveryReport read_raw(const std::filesystem::path& path, const std::function<void(const RawSample&)>& visit);

namespace raw_format {
inline constexpr char file_magic[8] = {'T', 'S', 'R', 'A', 'W', '1', '\n', '\0'};
inline constexpr std::uint32_t block_magic = 0x4b425354;  // "TSBK"
inline constexpr std::size_t file_magic_bytes = 7, block_header_bytes = 24;
inline constexpr std::uint32_t most_samples = 1U << 20U;
inline constexpr std::size_t largest_sample_bytes = 136;
void encode(const RawSample& sample, const RawHeader& header, std::string& to);
// Header and samples as one block.
std::string block(const std::string& samples, std::uint32_t count, std::uint64_t first);
std::string file_start(const RawHeader& header);
}  // namespace raw_format

}  // namespace touchstone::hil
