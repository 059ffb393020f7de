// One renderer of a plug-in, wherever it runs.
#pragma once

#include <touchstone/plugin.h>

#include <string>

#include "harness/base/rooms.h"

namespace touchstone::plugin {

class PluginConnection {
 public:
  virtual ~PluginConnection() = default;
  // False when it failed: failure() then says how, and every later call fails too.
  virtual bool reset() noexcept = 0;
  virtual bool step(const touchstone_tip& tip, touchstone_result& result) noexcept = 0;
  // Such as "crashed in touchstone_step (SIGSEGV, ...)".
  [[nodiscard]] virtual std::string failure() const = 0;
};

}  // namespace touchstone::plugin
