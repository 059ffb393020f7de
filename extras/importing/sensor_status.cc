#include "sensor_status.h"

#include <array>
#include <span>

namespace touchstone::importing {
namespace {

enum class Says { remark, beyond_range, faulty };

struct StatusBit {
  int bit;
  Says says;
  const char* text;
};

constexpr int summary_bit = 31;  // of both: set with every error

constexpr std::array net_ft_bits{
    StatusBit{30, Says::faulty, "CPU or RAM error"},
    StatusBit{29, Says::faulty, "digital board error"},
    StatusBit{28, Says::faulty, "analog board error"},
    StatusBit{27, Says::faulty, "serial link communication error"},
    StatusBit{26, Says::faulty, "program memory verification error"},
    StatusBit{25, Says::faulty, "halted by errors of configuration"},
    StatusBit{24, Says::faulty, "settings validation error"},
    StatusBit{23, Says::faulty, "configuration incompatible with the calibration"},
    StatusBit{22, Says::faulty, "network communication failure"},
    StatusBit{21, Says::faulty, "CAN communication error"},
    StatusBit{20, Says::faulty, "RDT communication error"},
    StatusBit{19, Says::faulty, "EtherNet/IP protocol failure"},
    StatusBit{18, Says::faulty, "DeviceNet protocol failure"},
    StatusBit{17, Says::beyond_range, "transducer saturation or A/D error"},
    StatusBit{16, Says::remark, "monitor condition latched"},
    StatusBit{14, Says::faulty, "watchdog timeout"},
    StatusBit{13, Says::faulty, "stack check error"},
    StatusBit{12, Says::faulty, "serial EEPROM failure"},
    StatusBit{11, Says::faulty, "serial flash failure"},
    StatusBit{10, Says::faulty, "analog board watchdog timeout"},
    StatusBit{9, Says::faulty, "excessive gauge excitation current"},
    StatusBit{8, Says::faulty, "insufficient gauge excitation current"},
    StatusBit{7, Says::faulty, "analog ground out of range"},
    StatusBit{6, Says::faulty, "analog supply too high"},
    StatusBit{5, Says::faulty, "analog supply too low"},
    StatusBit{4, Says::faulty, "serial link data unavailable"},
    StatusBit{3, Says::faulty, "reference voltage or power error"},
    StatusBit{2, Says::faulty, "internal temperature error"},
    StatusBit{1, Says::remark, "HTTP protocol failure"},  // of the web pages: forces do not pass there
};

constexpr std::array axia_bits{
    StatusBit{30, Says::beyond_range, "force or torque out of range"},
    StatusBit{29, Says::faulty, "calibration checksum error"},
    StatusBit{28, Says::remark, "simulated error"},
    StatusBit{27, Says::beyond_range, "gauge out of range"},
    StatusBit{16, Says::remark, "monitor condition latched"},
    StatusBit{7, Says::faulty, "calibration not accessible"},
    StatusBit{5, Says::faulty, "other error"},
    StatusBit{3, Says::remark, "busy: settings were changing"},
    StatusBit{2, Says::faulty, "broken gauge"},
    StatusBit{1, Says::faulty, "supply voltage out of range"},
    StatusBit{0, Says::faulty, "temperature out of range"},
};

}  // namespace

std::optional<StatusDevice> find_status_device(std::string_view name) {
  if (name == "net-ft") return StatusDevice::net_ft;
  if (name == "ethernet-axia") return StatusDevice::ethernet_axia;
  return std::nullopt;
}

SensorStatus read_sensor_status(StatusDevice device, std::uint32_t word) {
  SensorStatus status;
  const auto set = [&](int bit) { return (word >> static_cast<unsigned>(bit) & 1U) != 0; };
  const std::span<const StatusBit> bits =
      device == StatusDevice::net_ft ? std::span<const StatusBit>(net_ft_bits) : std::span<const StatusBit>(axia_bits);
  bool error = false;
  std::uint32_t listed = std::uint32_t{1} << static_cast<unsigned>(summary_bit);
  for (const StatusBit& one : bits) {
    if (!set(one.bit)) continue;
    listed |= std::uint32_t{1} << static_cast<unsigned>(one.bit);
    error = error || one.says != Says::remark;
    status.beyond_range = status.beyond_range || one.says == Says::beyond_range;
    status.faulty = status.faulty || one.says == Says::faulty;
    status.text += (status.text.empty() ? "" : ", ") + std::string(one.text);
  }
  // The summary bit is set by a remark, too; it may stand for a bit without a name.
  if (set(summary_bit) && !error && (status.text.empty() || (word & ~listed) != 0)) {
    status.faulty = true;
    status.text += (status.text.empty() ? "" : ", ") + std::string("an error that the manual does not list");
  }
  return status;
}

}  // namespace touchstone::importing
