#include "drivers/vendor_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

namespace touchstone::hil {

VendorLibrary::VendorLibrary(const std::vector<std::string>& names, const std::string& advice) {
  std::string tried;
  for (const auto& name : names) {
    handle_ = ::dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle_ != nullptr) {
      name_ = name;
      return;
    }
    tried += (tried.empty() ? "" : ", ") + name;
  }
  throw DeviceError(DeviceStatus::no_driver, fmt::format("none of {} could be opened", tried), advice);
}

VendorLibrary::~VendorLibrary() {
  if (handle_ != nullptr) ::dlclose(handle_);
}

void* VendorLibrary::symbol(const char* name) const {
  void* const found = ::dlsym(handle_, name);
  if (found == nullptr)
    throw DeviceError(DeviceStatus::no_driver,
                      fmt::format("{} has no function {}: another version of it is needed", name_, name));
  return found;
}

}  // namespace touchstone::hil
