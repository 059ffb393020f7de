#include "emulators/serial_emulator.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <vector>

namespace touchstone::hil {
namespace {

template <class T>
void put_field(std::string& to, T value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  to.append(bytes, sizeof value);
}

// X.25: bits in the order of transmission (least significant first) into a register that the polynomial
// x^16 + x^12 + x^5 + 1 divides, begun with ones, complemented, and sent least significant bit first.
std::uint16_t checksum(const std::string& bytes) {
  std::vector<int> shift(16, 1);
  for (const char c : bytes) {
    for (int bit = 0; bit < 8; ++bit) {
      const int feedback = shift[15] ^ ((static_cast<unsigned char>(c) >> bit) & 1);
      for (int i = 15; i > 0; --i) shift[static_cast<std::size_t>(i)] = shift[static_cast<std::size_t>(i - 1)];
      shift[0] = feedback;
      shift[5] ^= feedback;
      shift[12] ^= feedback;
    }
  }
  unsigned crc = 0;
  for (int i = 0; i < 16; ++i) crc |= static_cast<unsigned>(shift[static_cast<std::size_t>(15 - i)] ^ 1) << i;
  return static_cast<std::uint16_t>(crc);
}

int baud_of(int line) {
  termios now{};
  if (::tcgetattr(line, &now) != 0) return 0;
  // Both ends of a pseudo-terminal share their settings.
  constexpr std::pair<speed_t, int> speeds[] = {{B9600, 9600},     {B19200, 19200},   {B38400, 38400},
                                                {B57600, 57600},   {B115200, 115200}, {B230400, 230400},
                                                {B460800, 460800}, {B921600, 921600}};
  for (const auto& [speed, baud] : speeds) {
    if (speed == ::cfgetispeed(&now)) return baud;
  }
  return 0;
}

class Bota {
 public:
  Bota(BotaFaults faults, std::function<Wrench(double)> wrench)
      : faults_(std::move(faults)), wrench_(std::move(wrench)) {}

  std::string operator()(const std::string& came, double t_s) {
    std::string said;
    if (!greeted_) said += "App Init\r\n", greeted_ = true;
    heard_ += came;
    if (!came.empty()) said += obey(t_s);
    while (running_ && static_cast<double>(count_ + 1) * period_s_ <= t_s - began_s_) said += frame();
    return said;
  }

 private:
  std::string obey(double t_s) {
    std::string said;
    if (heard_ == "C") running_ = false, said = "r,0,C,0\r\n";
    if (heard_ == "R") running_ = true, began_s_ = t_s, count_ = 0, said = "r,0,R,0\r\n";
    if (heard_.rfind("c,", 0) == 0) {
      if (faults_.configured) faults_.configured(heard_);
      said = "r,0,c,0\r\n";
    }
    if (int sinc = 0; heard_.rfind("f,", 0) == 0 && std::sscanf(heard_.c_str(), "f,%d", &sinc) == 1) {
      period_s_ = 0.00001953125 * sinc;
      said = faults_.refuses_filter ? "r,0,f,1\r\n" : "r,0,f,0\r\n";
    }
    if (!said.empty()) heard_.clear();
    return said;
  }

  std::string frame() {
    ++count_;
    const auto due = [&](std::uint32_t every) { return every != 0 && count_ % every == 0; };
    if (due(faults_.drop_every) || (count_ < faults_.halved_until && count_ % 2 == 0)) return {};
    const double t = static_cast<double>(count_) * period_s_;
    const Wrench w = wrench_(t);
    std::string data;
    put_field(data, static_cast<std::uint16_t>(due(faults_.status_every) ? 4 : 0));
    for (int k = 0; k < 3; ++k) put_field(data, static_cast<float>(w.f_N[k]));
    for (int k = 0; k < 3; ++k) put_field(data, static_cast<float>(w.torque_Nm[k]));
    const bool reset = faults_.resets_at != 0 && count_ >= faults_.resets_at;
    put_field(data, static_cast<std::uint32_t>((reset ? t - faults_.resets_at * period_s_ : t) * 1e6));
    put_field(data, 31.5F);
    const std::uint16_t sum = checksum(data);
    if (due(faults_.damage_every)) data[7] = static_cast<char>(data[7] ^ 0x21);
    std::string bytes("\xaa");
    bytes += data;
    put_field(bytes, sum);
    return bytes;
  }

  BotaFaults faults_;
  std::function<Wrench(double)> wrench_;
  std::string heard_;
  bool greeted_ = false, running_ = true;
  double period_s_ = 0.01, began_s_ = 0.0;
  std::uint64_t count_ = 0;
};

class Leptrino {
 public:
  Leptrino(LeptrinoFaults faults, std::function<Wrench(double)> wrench)
      : faults_(std::move(faults)), wrench_(std::move(wrench)), running_(faults_.was_sending) {}

  std::string operator()(const std::string& came, double t_s) {
    std::string said;
    heard_ += came;
    // A command is header, four bytes of which none is a DLE, trailer and check.
    constexpr std::size_t command_size = 9;
    for (; heard_.size() >= command_size; heard_.erase(0, command_size)) said += answer(heard_, t_s);
    while (running_ && static_cast<double>(count_ + 1) / faults_.sends_Hz <= t_s - began_s_) said += sample();
    return said;
  }

 private:
  // Section 2.3 of the specification: transparency, then the check over all but the inserted bytes.
  static std::string framed(const std::string& data) {
    std::string text("\x10\x02", 2);
    char check = 0;
    for (const char c : data) {
      text += c == '\x10' ? std::string("\x10\x10") : std::string(1, c);
      check = static_cast<char>(check ^ c);
    }
    return text + "\x10\x03" + static_cast<char>(check ^ '\x03');
  }
  static std::string response(char type, char result, const std::string& data = "") {
    return framed(std::string{static_cast<char>(4 + data.size()), '\xff', type, result} + data);
  }

  std::string answer(const std::string& command, double t_s) {
    const bool whole = command.substr(0, 9) == framed(command.substr(2, 4)) && command[2] == 4 && command[5] == 0;
    if (!whole || faults_.damaged_commands > 0) return --faults_.damaged_commands, "\x10\x15";
    if (faults_.endless) return faults_.endless = false, std::string("\x10\x02", 2) + std::string(3000, 'x');
    const char type = command[4];
    switch (type) {
      case '\x2a':
        return response(type, 0,
                        std::string("PFS055YA251U6   2606008 ") + (faults_.rate.empty() ? "1013" : "4009") +
                            (faults_.rate.empty() ? "" : fmt::format("{:<6}", faults_.rate)));
      case '\x2b': {
        std::string rated;
        for (const float value : {1.0F, 1.0F, 2.0F, 0.02F, 0.02F, 0.03F})
          put_field(rated, faults_.rated_force_N * value);
        return response(type, 0, rated);
      }
      case '\x32':
        running_ = faults_.start_result == 0, began_s_ = t_s, count_ = 0;
        return response(type, static_cast<char>(faults_.start_result));
      case '\x33':
        running_ = false;
        return response(type, 0);
      default:
        return response(type, 2);
    }
  }

  std::string sample() {
    ++count_;
    const auto due = [&](std::uint32_t every) { return every != 0 && count_ % every == 0; };
    if (due(faults_.drop_every)) return {};
    const Wrench w = wrench_(static_cast<double>(count_) / faults_.sends_Hz);
    const double rated_N = faults_.rated_force_N;
    std::string data;
    const auto put = [&](double value, double rated) {
      put_field(data, static_cast<std::int16_t>(std::clamp(std::round(1e4 * value / rated), -32000.0, 32000.0)));
    };
    for (int k = 0; k < 3; ++k) put(w.f_N[k], k == 2 ? 2.0 * rated_N : rated_N);
    for (int k = 0; k < 3; ++k) put(w.torque_Nm[k], (k == 2 ? 0.03F : 0.02F) * faults_.rated_force_N);
    put_field(data, std::uint16_t{0xabcd});  // undefined, as are the status' other bits and the last byte
    data += static_cast<char>(0xa8 | (due(faults_.status_every) ? faults_.status : 0));
    data += '\x5c';
    std::string text = response('\x32', 0, data);
    if (faults_.overflow_at != 0 && count_ == faults_.overflow_at) return text.substr(0, text.size() / 2);
    if (faults_.overflow_at != 0 && count_ > faults_.overflow_at && count_ <= faults_.overflow_at + 600) return {};
    if (due(faults_.damage_every)) text[text.size() - 4] = static_cast<char>(text[text.size() - 4] ^ 0x20);
    return text;
  }

  LeptrinoFaults faults_;
  std::function<Wrench(double)> wrench_;
  std::string heard_;
  bool running_;
  double began_s_ = 0.0;
  std::uint64_t count_ = 0;
};

// What setup() of bogde/HX711's HX711_full_example.ino (commit be5e3d25) prints, with raw counts before the scale is
// set.
constexpr char hx711_setup[] =
    "HX711 Demo\r\nInitializing the scale\r\nBefore setting up the scale:\r\n"
    "read: \t\t-153217\r\nread average: \t\t-153198\r\nget value: \t\t-153204.00\r\nget units: \t\t-153201.0\r\n"
    "After setting up the scale:\r\n"
    "read: \t\t-153221\r\nread average: \t\t-153207\r\nget value: \t\t-4.00\r\nget units: \t\t0.0\r\n"
    "Readings:\r\n";

}  // namespace

SerialEmulator::SerialEmulator(Device device) : device_(std::move(device)) {
  fd_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  if (fd_ < 0 || ::grantpt(fd_) != 0 || ::unlockpt(fd_) != 0) throw std::runtime_error("no pseudo-terminal");
  char name[128];
  if (::ptsname_r(fd_, name, sizeof name) != 0) throw std::runtime_error("a pseudo-terminal without a name");
  node_ = name;
  termios line{};
  ::tcgetattr(fd_, &line);
  ::cfmakeraw(&line);
  ::tcsetattr(fd_, TCSANOW, &line);
  thread_ = std::thread([this] {
    MonotonicClock clock;
    const double began = clock.now_s();
    while (!stop_) {
      char bytes[512];
      const auto n = ::read(fd_, bytes, sizeof bytes);
      const std::string said =
          device_(std::string(bytes, n > 0 ? static_cast<std::size_t>(n) : 0), clock.now_s() - began, baud_of(fd_));
      // A sensor does not wait: what the line cannot hold is lost, and never comes late.
      [[maybe_unused]] const auto sent = said.empty() ? 0 : ::write(fd_, said.data(), said.size());
      clock.sleep_until(clock.now_s() + 5e-4);
    }
  });
}

SerialEmulator::~SerialEmulator() { unplug(); }

void SerialEmulator::unplug() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

SerialEmulator::Device bota_sensor(BotaFaults faults, std::function<Wrench(double)> wrench) {
  const auto sensor = std::make_shared<Bota>(std::move(faults), std::move(wrench));
  return [sensor](const std::string& came, double t_s, int) { return (*sensor)(came, t_s); };
}

SerialEmulator::Device leptrino_sensor(LeptrinoFaults faults, std::function<Wrench(double)> wrench) {
  const auto sensor = std::make_shared<Leptrino>(std::move(faults), std::move(wrench));
  return [sensor](const std::string& came, double t_s, int) { return (*sensor)(came, t_s); };
}

SerialEmulator::Device load_cell_sketch(bool adc_library, double rate_Hz, const std::function<double(double)>& units) {
  const auto count = std::make_shared<std::uint64_t>(0);
  return [=](const std::string&, double t_s, int) {
    constexpr double starts_s = 0.5;
    std::string said;
    if (t_s < starts_s) return said;
    if (*count == 0) said += adc_library ? "\r\nStarting...\r\nStartup is complete\r\n" : hx711_setup;
    // Read when it is printed: the converter keeps its last value alone, so that a late sketch prints no old ones.
    if (const double since_s = t_s - starts_s; static_cast<double>(*count) / rate_Hz <= since_s) {
      *count = static_cast<std::uint64_t>(since_s * rate_Hz) + 1;
      const double value = units(since_s);
      said += adc_library ? fmt::format("Load_cell output val: {:.2f}\r\n", value)
                          : fmt::format("one reading:\t{:.1f}\t| average:\t{:.1f}\r\n", value, 0.99 * value);
    }
    return said;
  };
}

}  // namespace touchstone::hil
