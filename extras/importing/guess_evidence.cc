#include "guess_evidence.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "harness/base/error.h"
#include "import_map.h"
#include "number_evidence.h"

namespace touchstone::importing {
namespace {

using Json = nlohmann::ordered_json;

void read_as_proposed(const std::filesystem::path& path, const Json& json, GuessedMap& guess) {
  guess.read.reset();
  guess.unreadable.clear();
  try {
    guess.read = import_file(path, parse_import_map(nlohmann::json::parse(json.dump()), "the proposed map"));
  } catch (const BadData& error) {
    guess.unreadable = error.what();
  }
}

// The file's own names of the columns that a finding is about: "'Tx', 'Ty', 'Tz'".
std::string names_in_file(const Json& json, const std::vector<std::string>& columns) {
  std::string names;
  for (const std::string& column : columns) {
    const auto found = json["columns"].find(column);
    if (found == json["columns"].end() || !found->contains("from")) continue;
    names += fmt::format("{}'{}'", names.empty() ? "" : ", ", (*found)["from"].get<std::string>());
  }
  return names.empty() ? "" : fmt::format(" ({})", names);
}

// Whether the position counts into the object or out of it, and whether the force is that on the probe, a column that
// names no axis does not say: the numbers must.
void ask_for_signs(const Json& json, GuessedMap& guess) {
  const std::vector<std::string> columns(guess.sign_assumed.begin(), guess.sign_assumed.end());
  guess.decide.push_back(fmt::format(
      "{}{}: no axis is named and the numbers do not tell the signs. z points out of the object and the force is that "
      "ON "
      "the probe: a depth, or the travel of a press, has a negative \"scale\", and so has the load of a tension test",
      fmt::join(columns, ", "), names_in_file(json, columns)));
}

// Where no row has all values, as of several topics in one table: at the rows of the force, else of the position.
void read_at_rows_of_one(const std::filesystem::path& path, Json& json, GuessedMap& guess) {
  const std::string as_it_is = guess.unreadable;
  for (const char* const column : {"fx_N", "fz_N", "x_m", "z_m"}) {
    const auto found = json["columns"].find(column);
    if (found == json["columns"].end() || !json["columns"].contains("t_s") || json.contains("rows")) continue;
    json["rows"] = {{"at", (*found)["from"]}};
    read_as_proposed(path, json, guess);
    if (guess.read) {
      guess.reasons.push_back(fmt::format(
          "rows <- those of {}: no row has all values, as of several topics in one table: the others are interpolated",
          (*found)["from"].dump()));
      return;
    }
    json.erase("rows");
  }
  guess.unreadable = as_it_is;
}

}  // namespace

void hold_against_numbers(const std::filesystem::path& path, GuessedMap& guess) {
  Json json = Json::parse(guess.json);
  read_as_proposed(path, json, guess);
  if (!guess.read) read_at_rows_of_one(path, json, guess);
  bool withdrawn = false, signs_told = false;
  for (const NumberFinding& finding : guess.read ? number_evidence(*guess.read, guess.unit_assumed, guess.static_poses)
                                                 : std::vector<NumberFinding>{}) {
    signs_told = signs_told || finding.of_signs;
    const std::string line =
        fmt::format("{}{}: {}", finding.about, names_in_file(json, finding.withdrawn), finding.what);
    (finding.contradicts ? guess.decide : guess.reasons).push_back(line);
    for (const std::string& column : finding.withdrawn) {
      withdrawn = json["columns"].erase(column) > 0 || withdrawn;
    }
  }
  if (withdrawn) read_as_proposed(path, json, guess);
  if (!signs_told && !guess.sign_assumed.empty()) ask_for_signs(json, guess);
  if (!guess.decide.empty()) json["decide"] = guess.decide;
  json["reasons"] = guess.reasons;
  guess.json = json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace touchstone::importing
