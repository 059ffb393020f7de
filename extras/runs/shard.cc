#include "shard.h"

#include <fmt/format.h>

#include <stdexcept>

#include "harness/base/error.h"

namespace touchstone::runs {

std::uint64_t CaseShard::first(std::uint64_t cases) const noexcept { return cases * (index - 1) / count; }
std::uint64_t CaseShard::last(std::uint64_t cases) const noexcept { return cases * index / count; }

CaseShard read_shard(const std::string& text) {
  CaseShard shard;
  if (text.empty()) return shard;
  const auto slash = text.find('/');
  try {
    std::size_t used = 0;
    shard.index = std::stoull(text, &used);
    if (slash == std::string::npos || used != slash) throw std::invalid_argument("no slash");
    shard.count = std::stoull(text.substr(slash + 1), &used);
    if (used != text.size() - slash - 1) throw std::invalid_argument("more");
  } catch (const std::logic_error&) {
    shard.index = 0;
  }
  if (shard.index < 1 || shard.index > shard.count)
    throw UsageError(fmt::format("--shard {}: K/N was expected, with 1 <= K <= N, for instance 3/8", text));
  return shard;
}

}  // namespace touchstone::runs
