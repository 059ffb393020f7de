// All samples, minutes of work.
#include "harness/pipeline/discrepancy/sample_check.h"

namespace touchstone::pipeline {
namespace {

class EverySample : public DiscrepancySamples, public ::testing::WithParamInterface<const char*> {};

TEST_P(EverySample, IsAnsweredRightly) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(samples, "discrepancy-sample");
  check(samples, GetParam());
}

INSTANTIATE_TEST_SUITE_P(Samples, EverySample,
                         ::testing::Values("5b2xcn5q", "atxjb5pb", "eqcpth3u", "f8mdh85b", "m5vrh5wn", "pw2huf7x",
                                           "sj6aqhqp", "vkkqfues", "warrewee", "xhfnzmn9"));

}  // namespace
}  // namespace touchstone::pipeline
