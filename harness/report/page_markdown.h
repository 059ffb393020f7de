// The tables of a report as Markdown, for documents that show them: what is printed there is what a run computed.
#pragma once

#include <string>

#include "harness/report/page.h"

namespace touchstone::report {

// Every table of the page under a heading of its own ("### " and its caption, or the section's title where it has
// none; " (2)" and so on where a heading occurs again), figures set to the right.
std::string tables_to_markdown(const Page& page);

}  // namespace touchstone::report
