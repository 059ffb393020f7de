#include "harness/surface/fuzz/read_structured_mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  touchstone::surface::fuzz::read_structured_mesh(data, size);
  return 0;
}
