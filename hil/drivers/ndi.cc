#include "drivers/ndi.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "drivers/record_count.h"
#include "drivers/serial_port.h"
#include "drivers/tcp_line.h"
#include "harness/base/atomic_file.h"

namespace touchstone::hil {

namespace ndi {

std::uint16_t crc16(std::string_view text) {
  constexpr std::uint16_t reflected_polynomial = 0xa001;
  std::uint16_t crc = 0;
  for (const char c : text) {
    crc = static_cast<std::uint16_t>(crc ^ static_cast<unsigned char>(c));
    for (int bit = 0; bit < 8; ++bit)
      crc = static_cast<std::uint16_t>((crc & 1U) != 0 ? (crc >> 1U) ^ reflected_polynomial : crc >> 1U);
  }
  return crc;
}

std::string command(const std::string& text) { return fmt::format("{}{:04X}\r", text, crc16(text)); }

std::optional<std::string> checked(std::string_view answer) {
  while (!answer.empty() && answer.back() == '\r') answer.remove_suffix(1);
  if (answer.size() < 4) return std::nullopt;
  const auto text = answer.substr(0, answer.size() - 4);
  if (answer.substr(answer.size() - 4) != fmt::format("{:04X}", crc16(text))) return std::nullopt;
  return std::string(text);
}

namespace {

// Characters of fixed width, never beyond the end.
class Columns {
 public:
  explicit Columns(std::string_view text) : text_(text) {}
  [[nodiscard]] bool good() const noexcept { return good_; }
  [[nodiscard]] bool next_is(std::string_view word) {
    if (text_.substr(0, word.size()) != word) return false;
    text_.remove_prefix(word.size());
    return true;
  }
  std::uint32_t hex(std::size_t width) { return number<std::uint32_t>(width, 16); }
  double decimal(std::size_t width, double unit) {
    // from_chars knows no plus sign.
    if (!text_.empty() && text_.front() == '+') text_.remove_prefix(1), --width;
    return unit * number<int>(width, 10);
  }

 private:
  template <class T>
  T number(std::size_t width, int base) {
    T value = 0;
    const auto field = text_.substr(0, width);
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value, base);
    good_ = good_ && field.size() == width && error == std::errc() && end == field.data() + field.size();
    text_.remove_prefix(field.size());
    return value;
  }
  std::string_view text_;
  bool good_ = true;
};

}  // namespace

std::optional<std::vector<Tool>> parse_tx(std::string_view answer) {
  Columns columns(answer);
  std::vector<Tool> tools;
  const auto count = columns.hex(2);
  for (std::uint32_t i = 0; i < count && columns.good(); ++i) {
    Tool tool;
    tool.handle = static_cast<int>(columns.hex(2));
    if (columns.next_is("UNOCCUPIED")) {
      if (!columns.next_is("\n")) return std::nullopt;
      continue;
    }
    tool.missing = columns.next_is("MISSING") || columns.next_is("DISABLED");
    if (!tool.missing) {
      double q[4];
      for (double& v : q) v = columns.decimal(6, 1e-4);
      tool.q_WB = Quat(q[0], q[1], q[2], q[3]);
      for (int k = 0; k < 3; ++k) tool.p_W_m[k] = columns.decimal(7, 1e-2 * 1e-3);
      columns.decimal(6, 1e-4);  // error of the fit [mm]
    }
    tool.status = columns.hex(8);
    tool.frame = columns.hex(8);
    if (!columns.next_is("\n")) return std::nullopt;
    tools.push_back(tool);
  }
  if (!columns.good()) return std::nullopt;
  return tools;
}

}  // namespace ndi

namespace {

// Bytes to and from the device, by either way.
class Line {
 public:
  virtual ~Line() = default;
  virtual void write(const std::string& bytes) = 0;
  // What has come, or nothing by the deadline.
  virtual std::string read(double deadline_s) = 0;
  [[nodiscard]] virtual bool emulated() const = 0;
};

template <class Port>
std::string text_of(Port& port, double deadline_s) {
  unsigned char bytes[2048];
  double t_s = 0.0;
  const auto n = port.read(bytes, deadline_s, t_s);
  return {reinterpret_cast<const char*>(bytes), n};
}

class SerialLine final : public Line {
 public:
  SerialLine(const std::string& node, int baud) : port_("NDI tracker", node, baud) {}
  void write(const std::string& bytes) override { port_.write(bytes); }
  std::string read(double deadline_s) override { return text_of(port_, deadline_s); }
  [[nodiscard]] bool emulated() const override { return port_.emulated(); }
  void send_break() { port_.send_break(); }

 private:
  SerialPort port_;
};

class NetworkLine final : public Line {
 public:
  NetworkLine(const std::string& place, const std::string& host, int port, double timeout_s)
      : line_(place, host, port, timeout_s) {}
  void write(const std::string& bytes) override { line_.write(bytes); }
  std::string read(double deadline_s) override { return text_of(line_, deadline_s); }
  [[nodiscard]] bool emulated() const override { return line_.emulated(); }

 private:
  TcpLine line_;
};

constexpr std::size_t rom_piece_bytes = 64;
// TX answers some 70 characters for a tool, and a device has less than 256 port handles (two hexadecimal digits).
constexpr std::size_t longest_answer_bytes = 1U << 16U;
constexpr int first_baud = 9600;
constexpr double counted_Hz = 60.0;  // frames that a Polaris counts, whatever rate it tracks at
// For the answer to the first command: a device at another speed says nothing, or garbage.
constexpr double first_answer_s = 0.5;
// As ndicapi gives it for its reset.
constexpr double reset_s = 7.0;
// For the answers while closing.
constexpr double closing_answer_s = 0.5;
// As ndicapi waits for the device to change its speed, or to go on after its greeting.
constexpr double change_over_s = 0.1;

std::string place_of(const NdiOptions& options) { return fmt::format("NDI tracker at {}", options.address); }

class NdiSource final : public PoseSource {
 public:
  explicit NdiSource(const NdiOptions& options)
      : options_(options), place_(place_of(options)), serial_(options.address.rfind('/', 0) == 0) {
    try {
      open();
    } catch (...) {
      leave();
      throw;
    }
  }
  ~NdiSource() override { leave(); }
  NdiSource(const NdiSource&) = delete;
  NdiSource& operator=(const NdiSource&) = delete;

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  [[nodiscard]] double nominal_rate_Hz() const override { return options_.rate_Hz; }
  void start() override {
    counters_ = {};
    count_ = {};
    steps_ = {};
    asked_s_.reset();
    next_s_ = clock_.now_s();
  }
  void stop() noexcept override {}

  // It answers when asked: it is asked twice a frame, and frames that were seen are left out. A question that is not
  // answered by the deadline stays open for the next call.
  std::size_t read(std::span<PoseSample> out, double deadline_s) override {
    while (!out.empty()) {
      if (!asked_s_) {
        if (next_s_ > deadline_s) {
          clock_.sleep_until(deadline_s);
          return 0;
        }
        clock_.sleep_until(next_s_);
        ask_for_frame();
      }
      const auto answer = next_answer(std::min(deadline_s, *asked_s_ + options_.timeout_s));
      if (!answer) {
        if (clock_.now_s() < *asked_s_ + options_.timeout_s) return 0;
        if (came_.empty()) throw no_answer("TX:0001", options_.timeout_s);
      }
      asked_s_.reset();
      const auto text = answer ? ndi::checked(*answer) : std::nullopt;
      if (text && text->rfind("ERROR", 0) == 0) throw says_error(*text, "TX:0001");
      const auto tools = text ? ndi::parse_tx(*text) : std::nullopt;
      if (!tools) {  // damaged on the way: the next frame is whole again
        ++counters_.malformed;
        continue;
      }
      for (const auto& tool : *tools) {
        if (tool.handle == handle_ && take(tool, out.front())) return 1;
      }
    }
    return 0;
  }

  [[nodiscard]] StreamCounters counters() const override { return counters_; }

 private:
  void open() {
    if (serial_) {
      auto line = std::make_unique<SerialLine>(options_.address, first_baud);
      SerialLine& port = *line;
      line_ = std::move(line);
      begin_at_first_speed(port);
      switch_speed();
    } else {
      line_ = std::make_unique<NetworkLine>(place_, options_.address, options_.port, options_.timeout_s);
      ask("INIT:");
    }
    const std::string handle = options_.tool_file.empty() ? wired_tool() : passive_tool();
    ask("PINIT:" + handle);
    ask("PENA:" + handle + "D");
    handle_ = static_cast<int>(std::strtol(handle.c_str(), nullptr, 16));
    identity_ = {std::string(ndi_device.id), "port handle " + handle, "ndicapi's commands, TX", "", line_->emulated()};
    ask("TSTART:");
  }

  // Tracking ends, and a serial line is as it was found: whoever opens it next begins at the device's first speed.
  void leave() noexcept {
    if (!line_) return;
    try {
      if (asked_s_) next_answer(clock_.now_s() + closing_answer_s);
      if (!identity_.id.empty()) ask("TSTOP:", closing_answer_s);  // else it never came to track
    } catch (const std::exception&) {
      // It is gone, or does not answer: what follows is worth a try.
    }
    try {
      if (switched_) ask("COMM:00000", closing_answer_s);
    } catch (const std::exception&) {
      // Nothing more can be done: the next one to open it sends a break.
    }
  }

  // A device that another program left at another speed hears a break: it resets and greets at its first speed.
  void begin_at_first_speed(SerialLine& port) {
    try {
      ask("INIT:", first_answer_s);
      return;
    } catch (const DeviceError& error) {
      if (error.device_status() == DeviceStatus::gone) throw;
    }
    port.send_break();
    came_.clear();
    const double until = clock_.now_s() + reset_s;
    for (;;) {
      const auto greeting = next_answer(until);
      if (!greeting) {
        throw DeviceError(
            DeviceStatus::timed_out,
            fmt::format("{}: answers neither at {} baud nor, within {} s, to a break", place_, first_baud, reset_s),
            "is it this line, and is it on?");
      }
      // What the line makes of the break may stand before.
      if (greeting->ends_with("RESETBE6F")) break;
    }
    clock_.sleep_until(clock_.now_s() + change_over_s);
    ask("INIT:");
  }

  void ask_for_frame() {
    came_.clear();
    // The rest of a damaged answer: no more than an answer holds.
    for (std::size_t more = 1, all = 0; more > 0 && all <= longest_answer_bytes; all += more)
      more = line_->read(clock_.now_s()).size();
    const double now = clock_.now_s();
    line_->write(ndi::command("TX:0001"));
    next_s_ = std::max(next_s_ + 0.5 / (options_.rate_Hz > 0.0 ? options_.rate_Hz : counted_Hz), now);
    asked_s_ = now;
  }

  // What came up to the next CR, without it; nothing by then, also while other bytes keep coming.
  std::optional<std::string> next_answer(double until_s) {
    for (;;) {
      if (const auto end = came_.find('\r'); end != std::string::npos) {
        arrived_s_ = clock_.now_s();
        auto answer = came_.substr(0, end);
        came_.erase(0, end + 1);
        return answer;
      }
      if (came_.size() > longest_answer_bytes) {
        throw DeviceError(DeviceStatus::failed,
                          fmt::format("{}: {} bytes came without the end of an answer (CR)", place_, came_.size()),
                          "is it an NDI tracker that listens at this address?");
      }
      came_ += line_->read(until_s);
      if (clock_.now_s() >= until_s && came_.find('\r') == std::string::npos) return std::nullopt;
    }
  }

  [[nodiscard]] DeviceError no_answer(const std::string& text, double patience_s) const {
    return {DeviceStatus::timed_out, fmt::format("{}: no answer to {} in {} s", place_, text, patience_s)};
  }
  [[nodiscard]] DeviceError says_error(const std::string& answer, const std::string& text) const {
    return {DeviceStatus::failed, fmt::format("{}: {} to {}", place_, answer, text),
            "the codes are in NDI's API guide"};
  }

  std::string ask(const std::string& text) { return ask(text, options_.timeout_s); }
  // The answer's text; throws for an error, a wrong CRC, or none in time.
  std::string ask(const std::string& text, double patience_s) {
    came_.clear();
    line_->write(ndi::command(text));
    const auto came = next_answer(clock_.now_s() + patience_s);
    if (!came) throw no_answer(text, patience_s);
    const auto answer = ndi::checked(*came);
    if (!answer)
      throw DeviceError(DeviceStatus::failed, fmt::format("{}: the answer to {} has a wrong CRC", place_, text));
    if (answer->rfind("ERROR", 0) == 0) throw says_error(*answer, text);
    return *answer;
  }

  void switch_speed() {
    constexpr std::pair<int, char> codes[] = {{9600, '0'},  {19200, '2'},  {38400, '3'},
                                              {57600, '4'}, {115200, '5'}, {921600, '6'}};
    const auto* const code =
        std::find_if(std::begin(codes), std::end(codes), [&](const auto& c) { return c.first == options_.baud; });
    if (code == std::end(codes))
      throw DeviceError(DeviceStatus::failed,
                        fmt::format("{}: {} baud is no speed of the device", place_, options_.baud),
                        "9600, 19200, 38400, 57600, 115200 and 921600 are");
    if (options_.baud == first_baud) return;
    ask(fmt::format("COMM:{}0000", code->second));
    line_.reset();
    clock_.sleep_until(clock_.now_s() + change_over_s);
    line_ = std::make_unique<SerialLine>(options_.address, options_.baud);
    switched_ = true;
  }

  std::string wired_tool() {
    const auto list = ask("PHSR:02");
    if (list.size() < 2 + 2 || list.substr(0, 2) == "00")
      throw DeviceError(DeviceStatus::failed, fmt::format("{}: no tool is plugged in", place_),
                        "a passive tool needs its definition: \"tool_file\" in the hardware map");
    return list.substr(2, 2);
  }

  std::string passive_tool() {
    auto rom = read_file(options_.tool_file);
    rom.resize((rom.size() + rom_piece_bytes - 1) / rom_piece_bytes * rom_piece_bytes, '\0');
    auto handle = ask("PHRQ:*********1****").substr(0, 2);
    for (std::size_t at = 0; at < rom.size(); at += rom_piece_bytes) {
      std::string hex;
      for (std::size_t i = 0; i < rom_piece_bytes; ++i)
        hex += fmt::format("{:02X}", static_cast<unsigned char>(rom[at + i]));
      ask(fmt::format("PVWR:{}{:04X}{}", handle, at, hex));
    }
    return handle;
  }

  // False for a frame that was seen.
  bool take(const ndi::Tool& tool, PoseSample& sample) {
    if (count_.started() && tool.frame == last_frame_) return false;
    sample = {};
    sample.flags |= count_.take(count_.started() ? steps_.ahead(tool.frame - last_frame_) : 1, counters_);
    last_frame_ = tool.frame;
    sample.t_s = arrived_s_;
    sample.sequence = count_.sequence();
    sample.device_status = tool.status;
    if (tool.missing) {
      sample.flags |= recording::sample_not_tracked;
    } else {
      sample.p_W_m = tool.p_W_m;
      sample.q_WB = tool.q_WB;
    }
    return true;
  }

  NdiOptions options_;
  std::string place_;
  bool serial_ = false, switched_ = false;  // the device is at options_.baud
  std::unique_ptr<Line> line_;
  std::string came_;
  std::optional<double> asked_s_;  // when the question went out that is open
  MonotonicClock clock_;
  DeviceIdentity identity_;
  StreamCounters counters_;
  int handle_ = 0;
  RecordCount count_;
  CountedSteps steps_;  // frames are counted at 60 Hz whatever the tracking rate: at 20 Hz every third is a pose
  std::uint32_t last_frame_ = 0;
  double next_s_ = 0.0, arrived_s_ = 0.0;
};

NdiOptions mapped_ndi(const MappedDevice& device) {
  NdiOptions options;
  options.address = device.address;
  if (device.port != 0) options.port = device.port;
  if (device.baud != 0) options.baud = device.baud;
  options.rate_Hz = device.rate_Hz;
  options.tool_file = device.tool_file;
  return options;
}

}  // namespace

void reach_ndi(const NdiOptions& options) {
  const NetworkLine line(place_of(options), options.address, options.port, options.timeout_s);
}

std::unique_ptr<PoseSource> open_ndi(const NdiOptions& options) { return std::make_unique<NdiSource>(options); }

constexpr KnownDevice ndi_device{
    .id = "ndi-polaris",
    .name = "NDI Polaris or Aurora",
    .role = DeviceRole::tracker,
    .bus = Bus::network,
    .source = "PlusToolkit's ndicapi",
    .confidence = Confidence::reported,
    .note = "serial node or network address in the hardware map",
    .address_example = "192.168.1.10 or /dev/ttyUSB0",
    .usual_port = ndi::usual_port,
    .open_poses = [](const MappedDevice& device) -> std::unique_ptr<PoseSource> {
      return open_ndi(mapped_ndi(device));
    },
    // To say more than that it is there it would have to be reset, and with it the program that tracks with it.
    .look = [](const MappedDevice& device, double timeout_s) -> DeviceSeen {
      NdiOptions options = mapped_ndi(device);
      options.timeout_s = timeout_s;
      reach_ndi(options);
      return {"", fmt::format("{} takes the connection at port {}; its tools show when it is recorded", device.address,
                              options.port)};
    }};

}  // namespace touchstone::hil
