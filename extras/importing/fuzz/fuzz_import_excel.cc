#include "fuzz/read_import.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  touchstone::importing::fuzz::read_import(data, size, ".xlsx");
  return 0;
}
