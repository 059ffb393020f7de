#include "harness/recording/fuzz/read_structured_recording.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  touchstone::recording::fuzz::read_structured_recording(data, size);
  return 0;
}
