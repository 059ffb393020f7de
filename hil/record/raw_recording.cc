#include "record/raw_recording.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>
#include <vector>

#include "harness/base/error.h"
#include "harness/base/input_files.h"
#include "harness/base/json_reader.h"

namespace touchstone::hil {
using raw_format::block_header_bytes;
using raw_format::file_magic_bytes;

static_assert(std::endian::native == std::endian::little, "raw recordings are little-endian");

namespace {

template <class T>
void put(std::string& to, const T& value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof value);
  to.append(bytes, sizeof value);
}

template <class T>
T get(const char*& from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  from += sizeof value;
  return value;
}

RawSample decode(const char* from, const RawHeader& header) {
  RawSample s;
  s.wrench.t_s = get<double>(from);
  s.wrench.sequence = get<std::uint64_t>(from);
  for (int k = 0; k < 3; ++k) s.wrench.wrench.f_N[k] = get<double>(from);
  for (int k = 0; k < 3; ++k) s.wrench.wrench.torque_Nm[k] = get<double>(from);
  s.wrench.flags = get<std::uint32_t>(from);
  s.wrench.device_status = get<std::uint32_t>(from);
  if (header.position || header.pose) {
    for (int k = 0; k < 3; ++k) s.p_W_m[k] = get<double>(from);
  }
  if (header.pose) {
    s.q_WB.w() = get<double>(from);
    for (int k = 0; k < 3; ++k) s.q_WB.vec()[k] = get<double>(from);
    s.ticks = get<std::uint64_t>(from);
  }
  return s;
}

StreamClock clock_of(JsonObject& object, std::string_view key) {
  const auto text = object.optional_text(key).value_or("sequence");
  for (const auto clock : {StreamClock::sequence, StreamClock::ticks, StreamClock::host}) {
    if (text == to_string(clock)) return clock;
  }
  object.fail_at(key, "sequence, ticks or host was expected");
}

}  // namespace

std::string_view to_string(StreamClock clock) {
  constexpr std::array names{"sequence", "ticks", "host"};
  return names[static_cast<std::size_t>(clock)];
}

std::string header_json(const RawHeader& h) {
  return nlohmann::json{{"schema", "touchstone-raw/1"},
                        {"device", h.device.id},
                        {"serial", h.device.serial},
                        {"firmware", h.device.firmware},
                        {"calibration", h.device.calibration},
                        {"emulated", h.device.emulated},
                        {"scheduling", h.scheduling},
                        {"started", h.started},
                        {"nominal_rate_Hz", h.nominal_rate_Hz},
                        {"position", h.position},
                        {"pose", h.pose},
                        {"clock", to_string(h.clock)},
                        {"ticks_per_s", h.ticks_per_s}}
      .dump();
}

RawHeader parse_header(const std::string& text, const std::string& source) {
  const auto json = parse_json(text, source);
  JsonObject object(json, source, "");
  object.schema("touchstone-raw/1");
  RawHeader h;
  h.device = {object.text("device"), object.text("serial"), object.text("firmware"), object.text("calibration"),
              object.optional_flag("emulated").value_or(true)};
  h.scheduling = object.text("scheduling");
  h.started = object.text("started");
  h.nominal_rate_Hz = object.number("nominal_rate_Hz");
  h.position = object.optional_flag("position").value_or(false);
  h.pose = object.optional_flag("pose").value_or(false);
  h.clock = clock_of(object, "clock");
  h.ticks_per_s = object.optional_number("ticks_per_s").value_or(0.0);
  object.finish();
  return h;
}

namespace raw_format {

void encode(const RawSample& s, const RawHeader& header, std::string& to) {
  put(to, s.wrench.t_s);
  put(to, s.wrench.sequence);
  for (int k = 0; k < 3; ++k) put(to, s.wrench.wrench.f_N[k]);
  for (int k = 0; k < 3; ++k) put(to, s.wrench.wrench.torque_Nm[k]);
  put(to, s.wrench.flags);
  put(to, s.wrench.device_status);
  if (header.position || header.pose) {
    for (int k = 0; k < 3; ++k) put(to, s.p_W_m[k]);
  }
  if (header.pose) {
    put(to, s.q_WB.w());
    for (int k = 0; k < 3; ++k) put(to, s.q_WB.vec()[k]);
    put(to, s.ticks);
  }
}

std::string block(const std::string& samples, std::uint32_t count, std::uint64_t first) {
  std::string bytes;
  bytes.reserve(block_header_bytes + samples.size());
  put(bytes, block_magic);
  put(bytes, count);
  put(bytes, first);
  XXH64_state_t* const state = XXH64_createState();
  XXH64_reset(state, 0);
  XXH64_update(state, bytes.data(), bytes.size());
  XXH64_update(state, samples.data(), samples.size());
  const std::uint64_t sum = XXH64_digest(state);
  XXH64_freeState(state);
  put(bytes, sum);
  return bytes + samples;
}

std::string file_start(const RawHeader& header) {
  const auto json = header_json(header);
  std::string bytes(file_magic, file_magic_bytes);
  put(bytes, static_cast<std::uint32_t>(json.size()));
  bytes += json;
  const std::uint64_t sum = XXH64(bytes.data(), bytes.size(), 0);
  put(bytes, sum);
  return bytes;
}

}  // namespace raw_format

namespace {

class RawFile {
 public:
  explicit RawFile(const std::filesystem::path& path) : in_(path, std::ios::binary) {
    if (!in_)
      throw BadData(fmt::format("{}: cannot be opened for reading; is it there, and may you read it?", path.string()));
    note_input_file(path);
    size_ = static_cast<std::uint64_t>(std::filesystem::file_size(path));
  }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  // What there is of so many bytes.
  std::string read_at(std::uint64_t offset, std::uint64_t bytes) {
    std::string data(static_cast<std::size_t>(std::min(bytes, size_ > offset ? size_ - offset : 0)), '\0');
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(offset));
    in_.read(data.data(), static_cast<std::streamsize>(data.size()));
    data.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, in_.gcount())));
    return data;
  }

 private:
  std::ifstream in_;
  std::uint64_t size_ = 0;
};

// The header, and where the blocks begin.
std::pair<RawHeader, std::uint64_t> header_of(RawFile& file, const std::filesystem::path& path) {
  using namespace raw_format;
  auto start = file.read_at(0, file_magic_bytes + 4);
  if (start.size() < file_magic_bytes + 4 ||
      start.compare(0, file_magic_bytes, raw_format::file_magic, file_magic_bytes) != 0) {
    throw BadData(
        fmt::format("{}: is not a raw recording of touchstone hil record; give a .tsraw file, or the folder of a run",
                    path.string()));
  }
  const char* cursor = start.data() + file_magic_bytes;
  const auto length = get<std::uint32_t>(cursor);
  start = file.read_at(0, file_magic_bytes + 4 + std::uint64_t{length} + 8);
  cursor = start.data() + start.size() - 8;
  if (length > 1U << 20U || start.size() != file_magic_bytes + 4 + length + 8 ||
      get<std::uint64_t>(cursor) != XXH64(start.data(), start.size() - 8, 0)) {
    throw BadData(
        fmt::format("{}: the header is damaged or cut short; the device and units of its samples are not known for "
                    "certain; nothing can be recovered from it",
                    path.string()));
  }
  return {parse_header(start.substr(file_magic_bytes + 4, length), path.string()), start.size()};
}

}  // namespace

RawHeader read_raw_header(const std::filesystem::path& path) {
  RawFile file(path);
  return header_of(file, path).first;
}

RecoveryReport read_raw(const std::filesystem::path& path, const std::function<void(const RawSample&)>& visit) {
  using namespace raw_format;
  RawFile file(path);
  const std::uint64_t size = file.size();
  RecoveryReport report;
  std::uint64_t offset = 0, expected = 0;
  std::tie(report.header, offset) = header_of(file, path);
  const std::size_t each = report.header.sample_bytes();

  while (offset < size) {
    const auto head = file.read_at(offset, block_header_bytes);
    bool sound = false;
    if (head.size() == block_header_bytes) {
      const char* at = head.data();
      const auto magic = get<std::uint32_t>(at);
      const auto count = get<std::uint32_t>(at);
      const auto first = get<std::uint64_t>(at);
      const auto sum = get<std::uint64_t>(at);
      if (magic == raw_format::block_magic && count > 0 && count <= raw_format::most_samples) {
        const auto samples = file.read_at(offset + block_header_bytes, std::uint64_t{count} * each);
        const auto again = samples.size() == count * each ? raw_format::block(samples, count, first) : std::string();
        sound = !again.empty() && again.compare(block_header_bytes - 8, 8, head, block_header_bytes - 8, 8) == 0 &&
                sum != 0;
        if (sound) {
          if (first > expected) report.missing_samples += first - expected;
          expected = first + count;
          for (std::uint32_t i = 0; i < count; ++i) visit(decode(samples.data() + i * each, report.header));
          report.samples += count;
          ++report.blocks;
          offset += block_header_bytes + samples.size();
        }
      }
    }
    if (sound) continue;
    // Damage: on to the next place that could begin a block.
    const std::uint64_t from = offset++;
    for (bool found = false; !found && offset < size;) {
      const auto window = file.read_at(offset, 1U << 16U);
      const char magic[4] = {'T', 'S', 'B', 'K'};
      const auto at = std::search(window.begin(), window.end(), magic, magic + 4);
      found = at != window.end();
      offset += found ? static_cast<std::uint64_t>(at - window.begin())
                      : (window.size() > 3 && offset + window.size() < size ? window.size() - 3 : window.size());
    }
    report.damaged_bytes += std::min(offset, size) - from;
  }
  return report;
}

}  // namespace touchstone::hil
