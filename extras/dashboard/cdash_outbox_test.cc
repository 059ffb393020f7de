// Where kept runs are looked for, and what is said of them. Delivery itself is tried against a server in
// ci/testing/dashboard_test.
#include "cdash_outbox.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include "harness/testing/temporary_folder.h"

namespace touchstone::dashboard {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Outbox : public ::testing::Test {
 protected:
  std::filesystem::path made(const std::string& build) {
    const auto outbox = folder_.path() / build / "dashboard-outbox";
    std::filesystem::create_directories(outbox);
    return outbox;
  }
  testing::TemporaryFolder folder_;
};

TEST_F(Outbox, IsFoundInABuildFolderOrNamedItself) {
  const auto b = made("b"), a = made("a");
  std::filesystem::create_directories(folder_.path() / "none");
  EXPECT_THAT(find_outboxes({folder_.path() / "b", a, folder_.path() / "none"}), ElementsAre(a, b));
}

TEST_F(Outbox, NothingKeptIsNothingToSend) {
  const auto outbox = made("a");
  std::filesystem::create_directories(outbox / "half.part");  // a run that is still being written
  const OutboxState state = outbox_state({outbox});
  EXPECT_EQ(state.kept, 0U);
  EXPECT_EQ(state.text, "0 runs are kept to be sent\n");
}

TEST_F(Outbox, WhatAnotherProcessSendsIsLeftToIt) {
  const auto outbox = made("a");
  const int held = ::open((outbox / ".lock").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644);
  ASSERT_EQ(::flock(held, LOCK_EX | LOCK_NB), 0);
  std::vector<std::string> problems;
  CdashConnection connection(CdashServer{"http://127.0.0.1:1", "Project", ""});
  const OutboxLog log{[](const std::string&) {}, [&](const std::string& line) { problems.push_back(line); }};
  EXPECT_FALSE(send_outboxes(connection, {outbox}, {}, log));
  EXPECT_THAT(problems, ElementsAre(HasSubstr("another one is sending")));
  ::close(held);
  EXPECT_TRUE(send_outboxes(connection, {outbox}, {}, log)) << "nothing is kept";
}

}  // namespace
}  // namespace touchstone::dashboard
