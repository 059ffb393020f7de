// One renderer of a plug-in, wherever it runs and whichever version of the interface it follows.
#pragma once

#include <touchstone/plugin2.h>

#include <string>

namespace touchstone::plugin {

class PluginConnection {
 public:
  virtual ~PluginConnection() = default;
  // False when it failed: failure() then says how, and every later call fails too.
  virtual bool reset() noexcept = 0;
  // The result's contacts are written where its `contacts` points, at most `contact_capacity` of them; a plug-in that
  // says it wrote more has failed.
  virtual bool step(const touchstone2_input& input, touchstone2_result& result) noexcept = 0;
  // Such as "crashed in touchstone_step (SIGSEGV, ...)".
  [[nodiscard]] virtual std::string failure() const = 0;
};

}  // namespace touchstone::plugin
