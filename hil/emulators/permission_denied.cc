#include "emulators/permission_denied.h"

#include <array>
#include <cstdio>

namespace touchstone::hil {

ToldWithoutPermission permission_denied() {
  std::FILE* const program = ::popen(TOUCHSTONE_FALCON_WITHOUT_PERMISSION, "r");
  if (program == nullptr) return {"the program could not be started", ""};
  std::string text;
  std::array<char, 256> some;
  for (std::size_t n = 0; (n = std::fread(some.data(), 1, some.size(), program)) > 0;) text.append(some.data(), n);
  ::pclose(program);
  const auto line = text.find('\n');
  return line == std::string::npos ? ToldWithoutPermission{"the program said nothing", ""}
                                   : ToldWithoutPermission{text.substr(0, line), text.substr(line + 1)};
}

}  // namespace touchstone::hil
