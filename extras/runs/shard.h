// A part of many cases, so that several processes or machines can share them.
#pragma once

#include <cstdint>
#include <string>

namespace touchstone::runs {

// Part `index` (1 to `count`) of the cases: consecutive numbers, so that cases which share a surface stay together.
struct CaseShard {
  std::uint64_t index = 1;
  std::uint64_t count = 1;
  [[nodiscard]] std::uint64_t first(std::uint64_t cases) const noexcept;
  [[nodiscard]] std::uint64_t last(std::uint64_t cases) const noexcept;  // behind the last
};

// "3/8"; all of it where the text is empty. Throws UsageError naming the option.
CaseShard read_shard(const std::string& text);

}  // namespace touchstone::runs
