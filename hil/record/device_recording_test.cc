#include "record/device_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/base/error.h"

namespace touchstone::hil {
namespace {

SessionExport two_sensors() {
  SessionExport session;
  session.tables.push_back({"left", "left.csv", {}});
  session.tables.push_back({"right", "right.csv", {}});
  session.tables.push_back({"tracker", "tracker.csv", {}});
  session.tables.back().report.kind = StreamKind::motion;
  return session;
}

std::string refusal(const std::function<void()>& asked) {
  try {
    asked();
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(DeviceRecording, ATableIsFoundByItsNameOrAsTheOnlyOne) {
  const SessionExport session = two_sensors();
  EXPECT_EQ(table_of(session, StreamKind::motion, "", "--motion"), "tracker.csv");
  EXPECT_EQ(table_of(session, StreamKind::force, "right", "--force"), "right.csv");
  EXPECT_THAT(refusal([&] { (void)table_of(session, StreamKind::force, "", "--force"); }),
              ::testing::HasSubstr("--force: left and right were recorded"));
  EXPECT_THAT(refusal([&] { (void)table_of(session, StreamKind::motion, "left", "--motion"); }),
              ::testing::HasSubstr("--motion: no such stream"));
}

TEST(DeviceRecording, ADeviceThatIsNotInTheMapIsSaidWithTheMap) {
  HardwareMap map;
  EXPECT_THAT(refusal([&] { (void)usable_device("ati-netft", map); }), ::testing::HasSubstr("give one with --map"));
  map.source = "lab/hardware.json";
  EXPECT_THAT(refusal([&] { (void)usable_device("ati-netft", map); }),
              ::testing::HasSubstr("is not in the hardware map lab/hardware.json"));
}

TEST(DeviceRecording, ASessionIsSaidTableByTable) {
  SessionExport session = two_sensors();
  session.tables[0].report.samples = 1000;
  session.tables[0].report.emulated = true;
  const std::string text = session_text(session);
  EXPECT_THAT(text, ::testing::HasSubstr("left                 1000 samples at 0.000 Hz, 0 missing, 0 damaged bytes "
                                         "(emulated) -> left.csv\n"));
  EXPECT_THAT(text, ::testing::HasSubstr("-> tracker.csv\n"));
}

}  // namespace
}  // namespace touchstone::hil
