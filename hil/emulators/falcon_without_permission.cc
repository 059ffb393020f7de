// A program that opens an emulated Falcon whose node in /dev it may not touch, as nobody where it is root's: root may
// open everything. Prints the status, and in the next line the message, that the driver answers with.
// A program, since a fork of the test would inherit GLib's locks from umockdev's threads, but not the threads that
// free them (fork(2): until execve, only functions that are safe in signal handlers).
#include <fmt/format.h>
#include <unistd.h>

#include "drivers/falcon.h"
#include "emulators/usb_emulator.h"

int main() {
  using namespace touchstone::hil;
  constexpr uid_t nobody = 65534;
  if (::geteuid() == 0 && ::setresuid(nobody, nobody, nobody) != 0) {
    fmt::print("root cannot be given up\n");
    return 1;
  }
  try {
    touchstone::hil::FalconModel model(true);
    touchstone::hil::UsbEmulator usb(touchstone::hil::UsbEmulator::Identity{}, model);
    usb.forbid();
    touchstone::hil::FalconOptions options;
    options.emulated = true;
    open_falcon(options);
    fmt::print("none\n");
  } catch (const touchstone::hil::DeviceError& error) {
    fmt::print("{}\n{}\n", to_string(error.device_status()), error.what());
  } catch (const std::exception& error) {
    fmt::print("{}\n", error.what());
    return 1;
  }
  return 0;
}
