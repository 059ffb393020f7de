// Dashboard runs that are kept to be sent: found in build folders, delivered (cdash_delivery.h), set aside if the
// server takes a part of them for good, and told.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "cdash_delivery.h"
#include "cdash_server.h"

namespace touchstone::dashboard {

// The folders dashboard-outbox in these build folders (or these themselves); without any, in those of build/. Sorted.
std::vector<std::filesystem::path> find_outboxes(const std::vector<std::string>& folders);

// Takes a line as soon as it is known: what was done, and what went wrong.
struct OutboxLog {
  std::function<void(const std::string&)> done, problem;
};

// Sends every kept run. A run that is delivered is removed; one of which the server refuses a part goes to the folder
// dashboard-set-aside beside the outbox; the others stay. An outbox that another process is sending is left to it, and
// a run that cannot be read keeps no other. True if nothing is left to be sent.
bool send_outboxes(CdashConnection& connection, const std::vector<std::filesystem::path>& outboxes,
                   const DeliveryOptions& options, const OutboxLog& log);

struct OutboxState {
  std::size_t kept = 0;  // runs
  std::string text;      // for people: each run with its parts, and what was set aside and why
};
// Throws BadData for a run that cannot be read.
OutboxState outbox_state(const std::vector<std::filesystem::path>& outboxes);

}  // namespace touchstone::dashboard
