// The site of a board: one index.html that opens offline, on a phone too, with a table and a picture per recording and
// over all, the verdicts in words, and links into the reports.
#pragma once

#include <string>
#include <vector>

#include "harness/pipeline/board.h"
#include "harness/report/provenance.h"

namespace touchstone::pipeline {

struct SiteNotes {
  report::Provenance provenance;
  std::vector<std::string> changes;                        // since the last run; see board_json.h
  bool compared = false;                                   // there was a last run: no changes is worth a line
  std::vector<std::pair<std::string, std::string>> links;  // name and file, for the foot of the page
};

// Everything in it is data: nothing of a name or message is read as HTML or script.
std::string site_html(const Board& board, const SiteNotes& notes);

}  // namespace touchstone::pipeline
