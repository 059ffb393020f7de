#include <fmt/format.h>

#include <filesystem>

#include "cdash_outbox.h"
#include "cdash_setup.h"
#include "dashboard_commands.h"
#include "harness/base/error.h"

namespace touchstone::dashboard {

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

std::vector<std::filesystem::path> outboxes_of(const DashboardOptions& options) {
  for (const std::string& folder : options.folders) {
    if (!std::filesystem::is_directory(folder))
      throw UsageError(folder + ": is no folder; expected build folders, or nothing for those below build");
  }
  return find_outboxes(options.folders);
}

ExitStatus dashboard_send(const DashboardOptions& options) {
  CdashConnection connection(dashboard_server(options));
  const OutboxLog log{[](const std::string& line) { fmt::print("{}\n", line); },
                      [](const std::string& line) { fmt::print(stderr, "{}\n", line); }};
  const bool all = send_outboxes(connection, outboxes_of(options), options.delivery, log);
  return all ? ExitStatus::passed : ExitStatus::failed;
}

ExitStatus dashboard_status(const DashboardOptions& options) {
  const OutboxState state = outbox_state(outboxes_of(options));
  fmt::print("{}", state.text);
  return state.kept == 0 ? ExitStatus::passed : ExitStatus::failed;
}

ExitStatus dashboard_init(const DashboardOptions& options) {
  CdashConnection connection(dashboard_server(options));
  const auto changes = set_up_project(connection, options.setup);
  for (const auto& change : changes) fmt::print("{}\n", change);
  fmt::print("dashboard: project {} on {} is ready\n", connection.server().project, connection.server().url);
  return ExitStatus::passed;
}

}  // namespace

void add_dashboard(CLI::App& program, apps::Run& run) {
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

}  // namespace touchstone::dashboard
