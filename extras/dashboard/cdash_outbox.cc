#include "cdash_outbox.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace touchstone::dashboard {
namespace {

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

std::vector<std::filesystem::path> kept_runs(const std::filesystem::path& outbox) {
  std::vector<std::filesystem::path> runs;
  for (const auto& entry : std::filesystem::directory_iterator(outbox)) {
    if (entry.is_directory() && entry.path().extension() != ".part") runs.push_back(entry.path());
  }
  std::ranges::sort(runs);
  return runs;
}

// True if nothing of the run is left to be sent.
bool send_run(CdashConnection& connection, const std::filesystem::path& folder, const DeliveryOptions& options,
              const OutboxLog& log) {
  const DashboardRun run = load_dashboard_run(folder);
  const Delivery delivery = deliver(connection, run, options);
  const std::string what = fmt::format("{} {} {}", run.build.site, run.build.name, run.build.stamp);
  for (const auto& problem : delivery.problems) log.problem(fmt::format("dashboard: {}", problem));
  std::string parts;
  for (const auto& part : run.parts) parts += " " + part.name;
  switch (delivery.outcome) {
    case Delivered::whole:
      log.done(fmt::format("dashboard: delivered: {} is build {}:{} Done", what, delivery.build_id, parts));
      break;
    case Delivered::unverified:
      log.done(fmt::format("dashboard: taken, not read back: {}:{} Done", what, parts));
      break;
    case Delivered::set_aside: {
      const auto aside = folder.parent_path().parent_path() / "dashboard-set-aside" / folder.filename();
      std::filesystem::create_directories(aside.parent_path());
      std::filesystem::remove_all(aside);
      std::filesystem::rename(folder, aside);
      log.done(fmt::format(
          "dashboard: delivered as far as the server takes it: {} is build {}; the rest and its reasons are in {}",
          what, delivery.build_id, aside.string()));
      return true;
    }
    case Delivered::kept:
      log.done(fmt::format(
          "dashboard: not delivered: {}; the results are kept in {}; send them later: touchstone dashboard send", what,
          folder.string()));
      return false;
  }
  std::filesystem::remove_all(folder);
  return true;
}

}  // namespace

std::vector<std::filesystem::path> find_outboxes(const std::vector<std::string>& folders) {
  std::vector<std::filesystem::path> found;
  const auto add = [&](const std::filesystem::path& folder) {
    const auto outbox = folder.filename() == "dashboard-outbox" ? folder : folder / "dashboard-outbox";
    if (std::filesystem::is_directory(outbox)) found.push_back(outbox);
  };
  for (const auto& folder : folders) add(folder);
  if (folders.empty() && std::filesystem::is_directory("build")) {
    for (const auto& entry : std::filesystem::directory_iterator("build")) add(entry.path());
  }
  std::ranges::sort(found);
  return found;
}

bool send_outboxes(CdashConnection& connection, const std::vector<std::filesystem::path>& outboxes,
                   const DeliveryOptions& options, const OutboxLog& log) {
  bool left = false;
  for (const auto& outbox : outboxes) {
    const OutboxLock lock(outbox);
    if (!lock.held()) {
      log.problem(fmt::format("dashboard: {}: another one is sending", outbox.string()));
      left = true;
      continue;
    }
    for (const auto& run : kept_runs(outbox)) {
      try {
        left = !send_run(connection, run, options, log) || left;
      } catch (const BadData& error) {  // one bad run does not keep the others
        log.problem(fmt::format("dashboard: {}", error.what()));
        left = true;
      }
    }
  }
  return !left;
}

OutboxState outbox_state(const std::vector<std::filesystem::path>& outboxes) {
  OutboxState state;
  for (const auto& outbox : outboxes) {
    for (const auto& folder : kept_runs(outbox)) {
      ++state.kept;
      const DashboardRun run = load_dashboard_run(folder);
      state.text +=
          fmt::format("kept: {} {} {} in {}\n", run.build.site, run.build.name, run.build.stamp, folder.string());
      for (const auto& part : run.parts) {
        const auto sent = folder / "sent" / part.name;
        state.text += fmt::format("  {:<14} {}\n", part.name,
                                  std::filesystem::exists(sent) ? "sent, " + read_file(sent).substr(0, 8) : "not sent");
      }
    }
    const auto aside = outbox.parent_path() / "dashboard-set-aside";
    if (!std::filesystem::is_directory(aside)) continue;
    for (const auto& run : std::filesystem::directory_iterator(aside)) {
      if (!std::filesystem::is_directory(run.path() / "set-aside")) continue;
      for (const auto& part : std::filesystem::directory_iterator(run.path() / "set-aside"))
        state.text += fmt::format("set aside: {} of {}: {}\n", part.path().filename().string(), run.path().string(),
                                  read_file(part.path()));
    }
  }
  state.text += fmt::format("{} runs are kept to be sent\n", state.kept);
  return state;
}

}  // namespace touchstone::dashboard
