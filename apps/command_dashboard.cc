#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>

#include "apps/commands.h"
#include "harness/base/atomic_file.h"
#include "harness/report/cdash_delivery.h"
#include "harness/report/cdash_setup.h"

namespace touchstone::apps {
namespace {

struct DashboardOptions {
  CdashServer server;
  CdashSetup setup;
  DeliveryOptions delivery;
  std::vector<std::string> folders;
};

CdashServer dashboard_server(const DashboardOptions& options) {
  CdashServer server = cdash_from_environment(options.server);
  if (server.url.empty()) throw UsageError("no server is set: give --url, or set TOUCHSTONE_CDASH_URL");
  return server;
}

// Two senders of one folder at once would send a build twice.
class OutboxLock {
 public:
  explicit OutboxLock(const std::filesystem::path& outbox)
      : descriptor_(::open((outbox / ".lock").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644)) {
    held_ = descriptor_ >= 0 && ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
  }
  ~OutboxLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OutboxLock(const OutboxLock&) = delete;
  OutboxLock& operator=(const OutboxLock&) = delete;
  [[nodiscard]] bool held() const { return held_; }

 private:
  int descriptor_;
  bool held_ = false;
};

std::vector<std::filesystem::path> outboxes(const DashboardOptions& options) {
  std::vector<std::filesystem::path> found;
  const auto add = [&](const std::filesystem::path& folder) {
    const auto outbox = folder.filename() == "dashboard-outbox" ? folder : folder / "dashboard-outbox";
    if (std::filesystem::is_directory(outbox)) found.push_back(outbox);
  };
  for (const auto& folder : options.folders) add(folder);
  if (options.folders.empty() && std::filesystem::is_directory("build")) {
    for (const auto& entry : std::filesystem::directory_iterator("build")) add(entry.path());
  }
  std::ranges::sort(found);
  return found;
}

std::vector<std::filesystem::path> kept_runs(const std::filesystem::path& outbox) {
  std::vector<std::filesystem::path> runs;
  for (const auto& entry : std::filesystem::directory_iterator(outbox)) {
    if (entry.is_directory() && entry.path().extension() != ".part") runs.push_back(entry.path());
  }
  std::ranges::sort(runs);
  return runs;
}

// True if nothing of the run is left to be sent.
bool send_run(CdashConnection& connection, const std::filesystem::path& folder, const DeliveryOptions& options) {
  const DashboardRun run = load_dashboard_run(folder);
  const Delivery delivery = deliver(connection, run, options);
  const std::string what = fmt::format("{} {} {}", run.build.site, run.build.name, run.build.stamp);
  for (const auto& problem : delivery.problems) fmt::print(stderr, "dashboard: {}\n", problem);
  std::string parts;
  for (const auto& part : run.parts) parts += " " + part.name;
  switch (delivery.outcome) {
    case Delivered::whole:
      fmt::print("dashboard: delivered: {} is build {}:{} Done\n", what, delivery.build_id, parts);
      break;
    case Delivered::unverified:
      fmt::print("dashboard: taken, not read back: {}:{} Done\n", what, parts);
      break;
    case Delivered::set_aside: {
      const auto aside = folder.parent_path().parent_path() / "dashboard-set-aside" / folder.filename();
      std::filesystem::create_directories(aside.parent_path());
      std::filesystem::remove_all(aside);
      std::filesystem::rename(folder, aside);
      fmt::print(
          "dashboard: delivered as far as the server takes it: {} is build {}; the rest and its reasons are in {}\n",
          what, delivery.build_id, aside.string());
      return true;
    }
    case Delivered::kept:
      fmt::print(
          "dashboard: not delivered: {}; the results are kept in {}; send them later: touchstone dashboard send\n",
          what, folder.string());
      return false;
  }
  std::filesystem::remove_all(folder);
  return true;
}

ExitStatus dashboard_send(const DashboardOptions& options) {
  CdashConnection connection(dashboard_server(options));
  bool left = false;
  for (const auto& outbox : outboxes(options)) {
    const OutboxLock lock(outbox);
    if (!lock.held()) {
      fmt::print(stderr, "dashboard: {}: another one is sending\n", outbox.string());
      left = true;
      continue;
    }
    for (const auto& run : kept_runs(outbox)) {
      try {
        left = !send_run(connection, run, options.delivery) || left;
      } catch (const BadData& error) {  // one bad run does not keep the others
        fmt::print(stderr, "dashboard: {}\n", error.what());
        left = true;
      }
    }
  }
  return left ? ExitStatus::failed : ExitStatus::passed;
}

ExitStatus dashboard_status(const DashboardOptions& options) {
  std::size_t kept = 0;
  for (const auto& outbox : outboxes(options)) {
    for (const auto& folder : kept_runs(outbox)) {
      ++kept;
      const DashboardRun run = load_dashboard_run(folder);
      fmt::print("kept: {} {} {} in {}\n", run.build.site, run.build.name, run.build.stamp, folder.string());
      for (const auto& part : run.parts) {
        const auto sent = folder / "sent" / part.name;
        fmt::print("  {:<14} {}\n", part.name,
                   std::filesystem::exists(sent) ? "sent, " + read_file(sent).substr(0, 8) : "not sent");
      }
    }
    const auto aside = outbox.parent_path() / "dashboard-set-aside";
    if (!std::filesystem::is_directory(aside)) continue;
    for (const auto& run : std::filesystem::directory_iterator(aside)) {
      if (!std::filesystem::is_directory(run.path() / "set-aside")) continue;
      for (const auto& part : std::filesystem::directory_iterator(run.path() / "set-aside"))
        fmt::print("set aside: {} of {}: {}\n", part.path().filename().string(), run.path().string(),
                   read_file(part.path()));
    }
  }
  fmt::print("{} runs are kept to be sent\n", kept);
  return kept == 0 ? ExitStatus::passed : ExitStatus::failed;
}

ExitStatus dashboard_init(const DashboardOptions& options) {
  CdashConnection connection(dashboard_server(options));
  const auto changes = set_up_project(connection, options.setup);
  for (const auto& change : changes) fmt::print("{}\n", change);
  fmt::print("dashboard: project {} on {} is ready\n", connection.server().project, connection.server().url);
  return ExitStatus::passed;
}

}  // namespace

void add_dashboard(CLI::App& program, Run& run) {
  auto* const command =
      program.add_subcommand("dashboard", "CDash: set a project up, deliver kept runs, say what is kept");
  command->require_subcommand(1);
  auto options = std::make_shared<DashboardOptions>();
  const auto server = [&](CLI::App* to) {
    to->add_option("--url", options->server.url, "The server; default TOUCHSTONE_CDASH_URL");
    to->add_option("--project", options->server.project, "Default TOUCHSTONE_CDASH_PROJECT, else Touchstone");
  };
  const auto folders = [&](CLI::App* to) {
    to->add_option("folders", options->folders, "Build folders; default: those in build/ that hold kept runs");
  };
  auto* const init =
      command->add_subcommand("init", "Make groups, upload quota and pinned measurements of the project");
  server(init);
  init->add_option("--group", options->setup.groups, "Groups for tracks of its own")->capture_default_str();
  init->add_option("--pin", options->setup.pinned, "Measurements shown on every test's page")->capture_default_str();
  init->add_option("--quota", options->setup.upload_quota_GiB, "Upload quota in GiB")->capture_default_str();
  init->callback([options, &run] { run = [options] { return dashboard_init(*options); }; });
  auto* const send = command->add_subcommand("send", "Deliver kept runs, each row exactly once, and read them back");
  server(send);
  folders(send);
  send->add_option("--wait", options->delivery.wait_s, "Seconds for the server to show what it took")
      ->capture_default_str();
  send->add_option("--poll", options->delivery.poll_s, "Seconds between two looks")->capture_default_str();
  send->add_flag("--trust-answers", options->delivery.trust_answers,
                 "Where the token may not read the project: the server's OK is enough");
  send->callback([options, &run] { run = [options] { return dashboard_send(*options); }; });
  auto* const status = command->add_subcommand("status", "What is kept to be sent, and what was set aside and why");
  folders(status);
  status->callback([options, &run] { run = [options] { return dashboard_status(*options); }; });
  command->footer(
      "The token comes from TOUCHSTONE_CDASH_TOKEN or the file TOUCHSTONE_CDASH_TOKEN_FILE. Exit status: 1 if runs "
      "are\n"
      "left to be sent.\n"
      "Examples:\n"
      "  TOUCHSTONE_CDASH_TOKEN_FILE=~/.cdash touchstone dashboard init --url https://cdash.example.org\n"
      "  touchstone dashboard send --url https://cdash.example.org\n"
      "  touchstone dashboard status");
}

}  // namespace touchstone::apps
