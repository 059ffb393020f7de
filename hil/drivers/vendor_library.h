// A vendor's shared library, opened when it is needed: the project is neither built nor shipped with it.
#pragma once

#include <string>
#include <vector>

#include "devices/device_error.h"

namespace touchstone::hil {

class VendorLibrary {
 public:
  // The first name that opens; throws DeviceError(no_driver) that says what was tried and where to get it.
  VendorLibrary(const std::vector<std::string>& names, const std::string& advice);
  ~VendorLibrary();
  VendorLibrary(const VendorLibrary&) = delete;
  VendorLibrary& operator=(const VendorLibrary&) = delete;

  // Throws DeviceError(no_driver) naming a function that this version lacks.
  template <class Function>
  void find(Function*& function, const char* name) const {
    function = reinterpret_cast<Function*>(symbol(name));
  }
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

 private:
  [[nodiscard]] void* symbol(const char* name) const;

  void* handle_ = nullptr;
  std::string name_;
};

}  // namespace touchstone::hil
