// Haply Inverse3 through Haply's Inverse service, which must run on this machine or in its network: a WebSocket on port
// 10001, JSON both ways.
//
//   on connecting the service sends an inventory: {"inverse3": [{"device_id", "config", "state", "status"}], ...};
//     after that exactly one state update for each message that it gets, and nothing without messages
//
//   command: {"inverse3": [{"device_id": ID, "commands": {"set_cursor_force": {KEY: {"x", "y", "z"}}}}]} [N]
//     KEY is "vector" from 3.5 on, "values" before
//
//   state: cursor_position, cursor_velocity {"x", "y", "z"} [m, m/s]; current_cursor_force [N] from 3.5 on; status:
//     calibrated, ready, ... (true or false)
//
//   a VerseGrip's buttons: {"wireless_verse_grip": [{"state": {"buttons": {"a", "b", "c"}}}]}
//
// Known, from Haply's documentation (docs.haply.co/inverseSDK/service, 3.5: "WebSocket Protocol", "Control Commands",
// "JSON Conventions", "Mount & Workspace Transforms"; 3.4: "Simulation Channel"):
//   - Control commands are applied once and forgotten; a device whose client stops sending returns to idle. How soon is
//     not said: the device is taken to have no watchdog, and is driven behind the guard only.
//   - Keys that the service does not know are ignored without an error, and the state comes all the same: an answer
//     alone does not say that a force is applied.
//   - Positions and forces are in application space: axes by the basis, lengths by the scales of mount and workspace.
//     Other axes than XYZ and other scales than 1 at the time of opening are refused; where the mount puts the origin
//     is taken as it is.
//   - The types of devices are inverse3, inverse3x and minverse: anything else counts as emulated.
//   - Without a status the device counts as not calibrated, and no force is commanded.
// Assumed, and not tried with a device here:
//   - Services whose inventory states no basis are older than 3.5 (3.4's does not) and want "values", as published
//     clients of that time send (Isaac Lab 2.3.2, se3_haply).
//   - current_cursor_force is the force that the service applies: zero is confirmed once it says zero. Where it is not
//     said, the answer alone confirms.
//   - Forces reach the device as commanded. The service's filters (force gate, damping) and its global force scale are
//     not read.
#pragma once

#include <memory>
#include <string>

#include "devices/interfaces.h"
#include "devices/known_device.h"

namespace touchstone::hil {

namespace haply {
inline constexpr int usual_port = 10001;
// How a service names the components of a force.
enum class ForceKey { values, vector };
std::string force_command(const std::string& device_id, const Vec3& f_W_N, ForceKey key);
}  // namespace haply

struct HaplyOptions {
  std::string host = "127.0.0.1";
  int port = haply::usual_port;
  std::string serial;      // device_id; empty: the only Inverse3
  double timeout_s = 2.0;  // while opening
};

// Throws DeviceError: absent (no service, no Inverse3: the message lists those that are), wrong_serial, failed (also
// where the service has other axes or scales). Commands nothing before the first exchange(), also not when it is
// closed.
std::unique_ptr<HapticDevice> open_haply(const HaplyOptions& options);

extern const KnownDevice haply_device;

}  // namespace touchstone::hil
