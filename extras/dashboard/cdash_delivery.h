// Brings a dashboard run to a CDash server, each row exactly once, and makes sure of it.
//
// A part counts as delivered when the body of the answer says OK and the build, read back, holds its rows. An answer of
// HTTP 200 alone says nothing: a proxy's log-in page has it too, and a server that queues its submissions (CDash's
// default) has processed nothing yet. So:
//   - before anything is sent, the state on the server is read; what is there is not sent again;
//   - a part whose answer was lost is looked for before it is sent again;
//   - Done goes last, when every part shows, and the build is then read once more;
//   - if a build holds rows twice or was ended too early, it is ended and replaced: the first part after Done makes
//     CDash delete it (Build::RemoveIfDone);
//   - a part that the server refuses three times is set aside with its reason, and the rest completes.
// What was tried is kept beside the run in sent/<part>, so that another process can go on.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cdash_parts.h"
#include "cdash_server.h"

namespace touchstone::dashboard {

struct DeliveryOptions {
  double wait_s = 120.0;  // for the server to show what it took
  double poll_s = 0.5;
  bool trust_answers = false;  // where the token may not read: OK in the answers is enough
};

enum class Delivered : unsigned char {
  whole,       // all rows are there and the build is done
  set_aside,   // all but the parts in `problems`, which this server does not take
  unverified,  // every answer said OK, and the build cannot be read back
  kept,        // not all is there: try again later
};

struct Delivery {
  Delivered outcome = Delivered::kept;
  std::string build_id;
  std::vector<std::string> problems;  // one sentence each
};

// Throws BadData only for a run that cannot be read; what server and network do becomes `problems`.
Delivery deliver(CdashConnection& connection, const DashboardRun& run, const DeliveryOptions& options);

}  // namespace touchstone::dashboard
