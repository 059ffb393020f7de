// The main() of test programs whose cases ctest runs together: with TOUCHSTONE_TEST_RESULTS in the environment the
// outcome of each is written into that folder, from which touchstone-test-result tells it.
#include <gmock/gmock.h>

#include <cstdlib>

#include "harness/testing/result_recorder.h"

int main(int argc, char** argv) {
  ::testing::InitGoogleMock(&argc, argv);
  if (const char* const results = std::getenv("TOUCHSTONE_TEST_RESULTS"))
    ::testing::UnitTest::GetInstance()->listeners().Append(new touchstone::testing::ResultRecorder(results));
  return RUN_ALL_TESTS();
}
