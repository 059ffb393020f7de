// A shared library that is loaded when it is first needed, and stays: linked, it would be paid for at every start.
#pragma once

#include <dlfcn.h>
#include <fmt/format.h>

#include <string>
#include <utility>

#include "harness/base/error.h"

namespace touchstone {

class LoadedLibrary {
 public:
  // `purpose`: what it is for, `package`: what brings it; for the message of the BadData where it cannot be loaded.
  LoadedLibrary(std::string file, const std::string& purpose, const std::string& package)
      : file_(std::move(file)), handle_(::dlopen(file_.c_str(), RTLD_NOW | RTLD_LOCAL)) {
    if (handle_ == nullptr) {
      throw BadData(fmt::format("{}, which {}, cannot be loaded ({}); install it (Debian: {})", file_, purpose,
                                ::dlerror(), package));
    }
  }

  // Throws BadData where the library has no such function.
  template <typename Function>
  void find(Function& function, const char* name) const {
    function = reinterpret_cast<Function>(::dlsym(handle_, name));
    if (function == nullptr) {
      throw BadData(fmt::format("{} has no function {}; its version is not known", file_, name));
    }
  }

 private:
  std::string file_;
  void* handle_;  // never closed: a library may keep threads and caches of its own
};

}  // namespace touchstone
