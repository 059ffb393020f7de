// Haply Inverse3 through Haply's Inverse service, which must run on this machine or in its network: a WebSocket on port
// 10001, JSON both ways.
//   On connecting the service sends an inventory: {"inverse3": [{"device_id", "config", "state", "status"}], ...}.
//   After
// that it sends exactly one state update for each message that it gets; without messages it sends nothing.
//   command: {"inverse3": [{"device_id": ID, "commands": {"set_cursor_force": {"values": {"x", "y", "z"}}}}]} [N]
//   state: cursor_position, cursor_velocity {"x", "y", "z"} [m, m/s]; status: calibrated, ready, ... (true or false)
//   a VerseGrip's buttons: {"wireless_verse_grip": [{"state": {"buttons": {"a", "b", "c"}}}]}
// Source: Haply's documentation, docs.haply.co/inverseSDK/service, pages "WebSocket Protocol" (3.5) and "Simulation
// Channel". Services before those say no status; without it the device counts as not calibrated, and no force is
// commanded. Nothing is documented on what the service does with the last force when its client falls silent: the
// device is taken to have no watchdog, and is driven behind the guard only.
#pragma once

#include <memory>
#include <string>

#include "harness/base/rooms.h"
#include "hil/devices/interfaces.h"

namespace touchstone::hil {

namespace haply {
inline constexpr int usual_port = 10001;
std::string force_command(const std::string& device_id, const Vec3& f_W_N);
}  // namespace haply

struct HaplyOptions {
  std::string host = "127.0.0.1";
  int port = haply::usual_port;
  std::string serial;      // device_id; empty: the only Inverse3
  double timeout_s = 2.0;  // while opening
};

// Throws DeviceError: absent (no service, no Inverse3: the message lists those that are), wrong_serial, failed.
std::unique_ptr<HapticDevice> open_haply(const HaplyOptions& options);

}  // namespace touchstone::hil
