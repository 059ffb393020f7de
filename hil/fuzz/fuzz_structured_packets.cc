#include "fuzz/read_structured_packets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  touchstone::hil::fuzz::read_structured_packets(data, size);
  return 0;
}
