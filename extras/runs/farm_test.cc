// The task's script is run by /bin/sh with a program that keeps rows as a stand-in; the files of HTCondor and
// Kubernetes are held against the keys that their manuals name, and the latter read by its own client where that is
// installed.
#include "farm.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace touchstone::runs {
namespace {

using ::testing::HasSubstr;

class Farm : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) / fmt::format("touchstone farm {}", ::getpid());
    std::filesystem::remove_all(folder_);
    ensure_writable_folder(folder_ / "all.sqlite.parts");
    ensure_writable_folder(folder_ / "node");
    // Adds a line to its last argument, its file; "slow" as first word: waits for a signal after that.
    write_file(
        folder_ / "keep",
        "#!/bin/sh\nfor file; do :; done\necho \"$MODULE $*\" >>\"$file\"\n[ \"$1\" != slow ] || { trap 'echo told "
        ">>\"$file\"; exit 1' TERM; while :; do sleep 0.05; done; }\n[ \"$1\" != bad ] || exit 3\n");
    ::chmod((folder_ / "keep").c_str(), 0755);
    request_.program = folder_ / "keep";
    request_.words = {"sweep", "spec.json"};
    request_.file_option = "--out";
    request_.out = folder_ / "all.sqlite";
    request_.shards = 8;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  FarmDescription farm(const std::string& text) const {
    write_file(folder_ / "farm.json", R"({"schema": "touchstone-farm/1", )" + text + "}");
    return load_farm(folder_ / "farm.json");
  }
  pid_t start(const FarmDescription& description, const std::string& shard) const {
    write_file(task_file(request_), task_script(request_, description));
    const pid_t child = ::fork();
    if (child == 0) {
      ::execl("/bin/sh", "sh", task_file(request_).c_str(), shard.c_str(), nullptr);
      ::_exit(127);
    }
    return child;
  }
  static int status_of(pid_t child) {
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  [[nodiscard]] std::string part(int n) const { return read_file(shard_file(request_, static_cast<std::uint64_t>(n))); }
  [[nodiscard]] std::string on_node() const { return R"("node_store": ")" + (folder_ / "node").string() + R"(")"; }

  std::filesystem::path folder_;
  SlurmRequest request_;
};

TEST_F(Farm, ATaskRunsItsShardAfterThePrologueAndWithinWhatItIsTold) {
  const auto description = farm(R"("prologue": ["MODULE=loaded", "export MODULE"], "inside": ["env", "A=it's"])");
  EXPECT_EQ(status_of(start(description, "3")), 0);
  EXPECT_THAT(part(3), HasSubstr("loaded sweep spec.json --shard 3/8 --threads 1 --out "));
  EXPECT_THAT(task_script(request_, description), HasSubstr("env 'A=it'\\''s' '"));
}

// As Lmod's module does; what comes after the prologue is ours, and a misspelt name there ends the task.
TEST_F(Farm, APrologueMayReadWhatIsNotSet) {
  const auto description = farm(
      R"("prologue": ["MODULE=loaded${NOT_SET_ANYWHERE}", "[ -z \"$NOT_SET_EITHER\" ] || exit 9", "export MODULE"])");
  EXPECT_EQ(status_of(start(description, "6")), 0);
  EXPECT_THAT(part(6), HasSubstr("loaded sweep"));
  const auto after = farm(R"("inside": ["env", "A=x"], "node_store": "/tmp${NOT_SET_ANYWHERE}")");
  EXPECT_NE(status_of(start(after, "7")), 0);
}

TEST_F(Farm, AStoreOnTheNodeIsFetchedAndTakenBack) {
  const auto description = farm(on_node());
  EXPECT_EQ(status_of(start(description, "1")), 0);
  EXPECT_EQ(status_of(start(description, "1")), 0);
  const std::string twice = part(1);
  EXPECT_EQ(std::ranges::count(twice, '\n'), 2) << twice;
  EXPECT_THAT(twice, HasSubstr("--out " + (folder_ / "node").string()));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "node"));
}

TEST_F(Farm, ATaskThatFailsOrIsToldToEndTakesItsRowsBack) {
  request_.words = {"bad"};
  EXPECT_EQ(status_of(start(farm(on_node()), "2")), 3);
  EXPECT_THAT(part(2), HasSubstr("bad --shard 2/8"));
  request_.words = {"slow"};
  const pid_t child = start(farm(on_node()), "4");
  for (int i = 0; i < 600 && std::filesystem::is_empty(folder_ / "node"); ++i) ::usleep(20000);
  ::usleep(300000);
  ::kill(child, SIGTERM);
  EXPECT_EQ(status_of(child), 143);
  EXPECT_THAT(part(4), HasSubstr("told"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "node"));
}

// A program that was killed leaves the journal of its last transaction, without which its file means nothing.
TEST_F(Farm, AJournalGoesWithItsFile) {
  write_file(folder_ / "keep",
             "#!/bin/sh\nfor file; do :; done\necho rows >\"$file\"; echo undo >\"$file-journal\"; kill -9 $$\n");
  ::chmod((folder_ / "keep").c_str(), 0755);
  EXPECT_NE(status_of(start(farm(on_node()), "5")), 0);
  EXPECT_EQ(part(5), "rows\n");
  EXPECT_EQ(read_file(shard_file(request_, 5).string() + "-journal"), "undo\n");
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "node"));
}

TEST_F(Farm, FilesOfTheFarmsNameTheOpenShards) {
  const auto description = farm(R"("kubernetes": {"image": "touchstone:0.1", "claim": "data", "mount": "/data"})");
  std::map<std::string, std::string> files;
  for (const FarmFile& file : farm_files(request_, description, {2, 5, 8}, 3)) files[file.name] = file.text;
  EXPECT_EQ(files["shards.txt"], "2\n5\n8\n");
  EXPECT_THAT(files["jobs.sub"],
              HasSubstr("queue shard from " + (folder_ / "all.sqlite.parts/shards.txt").string() + "\n"));
  EXPECT_THAT(files["jobs.sub"], HasSubstr("max_retries = 2\n"));
  EXPECT_THAT(files["job.yaml"], HasSubstr("completionMode: Indexed\n  completions: 3\n  parallelism: 3\n"));
  EXPECT_THAT(files["job.yaml"], HasSubstr("JOB_COMPLETION_INDEX + 1"));
  EXPECT_THAT(files["job.yaml"], HasSubstr("claimName: \"data\""));
  EXPECT_THAT(farm_commands(request_, description, 3), HasSubstr("kubectl create -f"));
  EXPECT_THAT(farm_commands(request_, description, 5), HasSubstr("--retries 5 "));
  EXPECT_THAT(files["job.yaml"], HasSubstr("generateName: touchstone-sweep-\n")) << "a second round is another job";
  EXPECT_EQ(farm_files(request_, {}, {1}, 3).size(), 3U) << "without an image no job of Kubernetes";
}

// What a command prints; nothing if it fails.
std::string printed(const std::string& command) {
  std::string text;
  FILE* const pipe = ::popen((command + " 2>/dev/null").c_str(), "r");
  std::array<char, 4096> part{};
  while (const std::size_t n = std::fread(part.data(), 1, part.size(), pipe)) text.append(part.data(), n);
  return ::pclose(pipe) == 0 ? text : "";
}

// Kubernetes' own client reads the job into its types without a server (set env --local): a field that they do not have
// is lost, a value of another type refused.
TEST_F(Farm, KubernetesOwnClientReadsTheJob) {
  const auto version = nlohmann::json::parse(printed("kubectl version --client -o json"), nullptr, false);
  if (!version.is_object()) GTEST_SKIP() << "needs kubectl";
  if (std::stoi(version.at("clientVersion").at("minor").get<std::string>()) < 21)
    GTEST_SKIP() << "needs kubectl 1.21, which knows indexed jobs";
  const auto description = farm(R"("kubernetes": {"image": "touchstone:0.1", "claim": "data", "mount": "/data"})");
  for (const FarmFile& file : farm_files(request_, description, {2, 5, 8}, 3))
    write_file(folder_ / file.name, file.text);
  const auto read = nlohmann::json::parse(
      printed("kubectl set env --local -f '" + (folder_ / "job.yaml").string() + "' SEEN=yes -o json"), nullptr, false);
  ASSERT_TRUE(read.is_object()) << "it cannot be read";
  EXPECT_EQ(read.at("kind"), "Job");
  const auto& spec = read.at("spec");
  EXPECT_EQ(spec.at("completionMode"), "Indexed");
  EXPECT_EQ(spec.at("completions"), 3);
  EXPECT_EQ(spec.at("parallelism"), 3);
  EXPECT_GT(spec.at("backoffLimit"), 0);
  const auto& pod = spec.at("template").at("spec");
  EXPECT_EQ(pod.at("restartPolicy"), "Never");
  EXPECT_EQ(pod.at("volumes").at(0).at("persistentVolumeClaim").at("claimName"), "data");
  const auto& container = pod.at("containers").at(0);
  EXPECT_EQ(container.at("image"), "touchstone:0.1");
  EXPECT_EQ(container.at("resources").at("requests").at("cpu"), std::to_string(request_.cores_per_task));
  EXPECT_EQ(container.at("volumeMounts").at(0).at("mountPath"), "/data");
  EXPECT_EQ(container.at("volumeMounts").at(0).at("name"), pod.at("volumes").at(0).at("name"));
  // The command line, as it comes out of YAML, is one that a shell reads.
  ASSERT_EQ(container.at("command").size(), 3U);
  write_file(folder_ / "command.sh", container.at("command").at(2).get<std::string>());
  EXPECT_EQ(std::system(("sh -n '" + (folder_ / "command.sh").string() + "'").c_str()), 0);
}

TEST_F(Farm, ADescriptionThatMakesNoSenseIsRefusedWithItsPlace) {
  for (const auto& [text, place] : {std::pair<std::string, std::string>{R"("prologue": "module load x")", "/prologue"},
                                    {R"("prologue": ["a\nb"])", "/prologue"},
                                    {R"x("node_store": "$(reboot)")x", "/node_store"},
                                    {R"("node_stor": "/tmp")", "node_stor"},
                                    {R"("kubernetes": {"image": "x"})", "/kubernetes"}}) {
    try {
      farm(text);
      ADD_FAILURE() << text;
    } catch (const BadData& e) {
      EXPECT_THAT(e.what(), HasSubstr("farm.json"));
      EXPECT_THAT(e.what(), HasSubstr(place));
    }
  }
}

}  // namespace
}  // namespace touchstone::runs
