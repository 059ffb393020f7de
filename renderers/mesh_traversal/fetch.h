// Has an object come from memory into the cache while other work goes on: for what the next step most likely reads.
#pragma once

#include <cstddef>

namespace touchstone::renderers {

template <class Object>
void fetch(const Object& object) noexcept {
  constexpr std::size_t line = 64;
  const auto* const first = reinterpret_cast<const char*>(&object);
  for (std::size_t offset = 0; offset < sizeof(Object); offset += line) __builtin_prefetch(first + offset);
  __builtin_prefetch(first + sizeof(Object) - 1);
}

}  // namespace touchstone::renderers
