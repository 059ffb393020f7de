#include "harness/rendering/fuzz/read_structured_model.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  touchstone::rendering::fuzz::read_structured_model(data, size);
  return 0;
}
