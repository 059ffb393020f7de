// What the Falcon's driver says to a program that may not open its device.
#pragma once

#include <string>

namespace touchstone::hil {

struct ToldWithoutPermission {
  std::string status;   // of the DeviceError, in words
  std::string message;  // empty where the program itself failed, whose reason is then in `status`
};

// Runs falcon_without_permission.cc to its end.
ToldWithoutPermission permission_denied();

}  // namespace touchstone::hil
