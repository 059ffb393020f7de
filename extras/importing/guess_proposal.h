// A map that is being proposed: the tables of a file, what their names and the lines above them say, and what was
// decided of it so far.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "guess_names.h"
#include "head_facts.h"
#include "import_table.h"

namespace touchstone::importing {

using Json = nlohmann::ordered_json;

struct MapProposal {
  explicit MapProposal(std::vector<ImportTable> read)
      : tables(std::move(read)), head(head_facts(tables.front().head)), named(named_columns(tables)) {}

  std::vector<ImportTable> tables;
  HeadFacts head;
  std::vector<NamedColumn> named;
  Json json, columns = Json::object();
  std::vector<std::string> reasons, used, decide;
  std::map<std::string, std::string> from;           // as in GuessedMap
  std::set<std::string> unit_assumed, sign_assumed;  // columns of the result, as in GuessedMap

  // How a map names a column: by its name; by its number where the name is not in UTF-8 or not the only one.
  [[nodiscard]] std::string reference(const ImportTable& table, std::size_t c) const;
  [[nodiscard]] std::string shown(const std::string& source) const;
  void use(const std::string& column, Json how, const std::string& source, const std::string& reason);
  void ask(const std::string& what, const std::string& why);
};

}  // namespace touchstone::importing
