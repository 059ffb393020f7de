// The examples are the manuals' own (9610-05-Ethernet Axia-09, table 4.9 and section 4.8.2) and what ATI's demo logged.
#include "sensor_status.h"

#include <gtest/gtest.h>

namespace touchstone::importing {
namespace {

TEST(SensorStatus, TheAxiaManualsExamples) {
  const auto axia = [](std::uint32_t word) { return read_sensor_status(StatusDevice::ethernet_axia, word); };
  EXPECT_EQ(axia(0).text, "");
  EXPECT_TRUE(axia(0x80000001U).faulty);
  EXPECT_EQ(axia(0x80000005U).text, "broken gauge, temperature out of range");
  EXPECT_TRUE(axia(0xC0000000U).beyond_range);
  EXPECT_TRUE(axia(0x88000000U).beyond_range);
  EXPECT_FALSE(axia(0x88000000U).faulty);
  EXPECT_TRUE(axia(0xA0000000U).faulty);
  for (const std::uint32_t remark : {0x80000008U, 0x00010000U, 0x10000000U}) {
    EXPECT_FALSE(axia(remark).faulty || axia(remark).beyond_range) << remark;
    EXPECT_NE(axia(remark).text, "");
  }
}

TEST(SensorStatus, TheNetFtsBitsAreOthers) {
  const auto net = [](std::uint32_t word) { return read_sensor_status(StatusDevice::net_ft, word); };
  EXPECT_TRUE(net(0x80020000U).beyond_range);
  EXPECT_EQ(net(0x80020000U).text, "transducer saturation or A/D error");
  // A threshold was crossed: the force is as it should be.
  EXPECT_FALSE(net(0x80010000U).faulty || net(0x80010000U).beyond_range);
  EXPECT_TRUE(net(0xC0000000U).faulty);
  EXPECT_FALSE(net(0xC0000000U).beyond_range);
  EXPECT_TRUE(net(0x80000000U).faulty);
  EXPECT_TRUE(net(0x80018000U).faulty) << "a bit without a name beside a remark";
}

}  // namespace
}  // namespace touchstone::importing
