#include "guess_proposal.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "foreign_unit.h"

namespace touchstone::importing {

std::string MapProposal::reference(const ImportTable& table, std::size_t c) const {
  const bool plain = as_utf8(table.names[c]) == table.names[c] && std::ranges::count(table.names, table.names[c]) == 1;
  const std::string name = plain ? table.names[c] : std::to_string(c + 1);
  return tables.size() > 1 ? table.name + ":" + name : name;
}

// With the name that stands behind a number.
std::string MapProposal::shown(const std::string& source) const {
  for (const ImportTable& table : tables) {
    for (std::size_t c = 0; c < table.names.size(); ++c) {
      if (reference(table, c) != source) continue;
      const std::string name = as_utf8(table.names[c]);
      return source.ends_with(name) ? source : fmt::format("{} ({})", source, name);
    }
  }
  return source;
}

void MapProposal::use(const std::string& column, Json how, const std::string& source, const std::string& reason) {
  columns[column] = std::move(how);
  used.push_back(source);
  from[column] = shown(source);
  reasons.push_back(fmt::format("{} <- {}: {}", column, shown(source), reason));
}

void MapProposal::ask(const std::string& what, const std::string& why) {
  decide.push_back(fmt::format("{}: {}", what, why));
}

}  // namespace touchstone::importing
