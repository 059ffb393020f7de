#include "harness/importing/guess_proposal.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "harness/importing/foreign_unit.h"

namespace touchstone::importing {

std::string MapProposal::reference(const ImportTable& table, std::size_t c) const {
  const bool plain = as_utf8(table.names[c]) == table.names[c] && std::ranges::count(table.names, table.names[c]) == 1;
  const std::string name = plain ? table.names[c] : std::to_string(c + 1);
  return tables.size() > 1 ? table.name + ":" + name : name;
}

void MapProposal::use(const std::string& column, Json how, const std::string& from, const std::string& reason) {
  columns[column] = std::move(how);
  used.push_back(from);
  reasons.push_back(fmt::format("{} <- {}: {}", column, from, reason));
}

void MapProposal::ask(const std::string& what, const std::string& why) {
  decide.push_back(fmt::format("{}: {}", what, why));
}

}  // namespace touchstone::importing
