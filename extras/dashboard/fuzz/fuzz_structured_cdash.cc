#include "fuzz/read_structured_cdash.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  touchstone::report::fuzz::read_structured_cdash(data, size);
  return 0;
}
