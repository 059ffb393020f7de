#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/commands.h"
#include "harness/base/bundled_files.h"
#include "harness/base/error.h"
#include "harness/base/file_description.h"
#include "harness/base/json_reader.h"
#include "harness/base/json_schema.h"

namespace touchstone::apps {
namespace {

struct FormatOptions {
  std::vector<std::string> names;
  std::vector<std::filesystem::path> explained, checked;
  std::string as, json_schema;
  bool markdown = false, unseen = false;
};

// Of the program and of the extras that came with it: share/touchstone/formats/NAME.json.
std::vector<FileFormat> known_formats() {
  const auto folder = find_bundled("formats");
  if (!folder) throw BadData("the tables of formats are missing: share/touchstone/formats belongs above the program");
  std::vector<std::filesystem::path> tables;
  for (const auto& entry : std::filesystem::directory_iterator(*folder)) tables.push_back(entry.path());
  std::ranges::sort(tables);
  return load_formats(tables);
}

// "findings" and "touchstone-findings" are the newest "touchstone-findings/N".
const FileFormat& find_format(const std::vector<FileFormat>& all, const std::string& name, const std::string& whose) {
  for (const FileFormat& format : all) {
    const std::string short_name = format.schema.substr(0, format.schema.find('/'));
    if (name == format.schema || name == short_name || "touchstone-" + name == short_name) return format;
  }
  throw UsageError(fmt::format("{}'{}' is no format that is known; `touchstone formats` lists them", whose, name));
}

const FileFormat& format_of(const std::vector<FileFormat>& all, const nlohmann::json& document,
                            const std::filesystem::path& file, const std::string& as) {
  const std::string whose = file.string() + ": ";
  if (!as.empty()) return find_format(all, as, whose);
  const bool named = document.is_object() && document.contains("schema") && document["schema"].is_string();
  if (!named) throw UsageError(whose + "has no \"schema\" that names its format; name it with --as");
  return find_format(all, document["schema"].get<std::string>(), whose);
}

ExitStatus check_files(const std::vector<FileFormat>& all, const FormatOptions& options) {
  std::size_t faults = 0;
  std::map<const FileFormat*, std::set<std::string>> seen;
  const auto say = [&](const std::filesystem::path& file, const std::vector<std::string>& differences) {
    for (const std::string& one : differences) fmt::print("{}: {}\n", file.string(), one);
    faults += differences.size();
  };
  for (const auto& file : options.explained) {
    const nlohmann::json document = load_json(file);
    const FileFormat& format = format_of(all, document, file, options.as);
    fmt::print("{}\n", format_text(format, &document));
    say(file, differences_from(format, document, all));
  }
  for (const auto& file : options.checked) {
    const nlohmann::json document = load_json(file);
    const FileFormat& format = format_of(all, document, file, options.as);
    say(file, differences_from(format, document, all));
    for (const std::string& key : keys_seen(format, document)) seen[&format].insert(key);
  }
  if (!options.unseen) return faults == 0 ? ExitStatus::passed : ExitStatus::failed;
  for (const auto& [format, keys] : seen) {
    for (const std::string& key : keys_of(*format)) {
      if (!keys.contains(key)) fmt::print("unseen {} {}\n", format->schema, key);
    }
  }
  return faults == 0 ? ExitStatus::passed : ExitStatus::failed;
}

ExitStatus run_formats(const FormatOptions& options) {
  const std::vector<FileFormat> all = known_formats();
  if (!options.explained.empty() || !options.checked.empty()) return check_files(all, options);
  if (!options.json_schema.empty()) {
    fmt::print("{}\n", json_schema_of(find_format(all, options.json_schema, ""), all).dump(1));
    return ExitStatus::passed;
  }
  if (options.markdown) {
    for (const FileFormat& format : all) fmt::print("{}", format_markdown(format));
    return ExitStatus::passed;
  }
  for (const std::string& name : options.names) fmt::print("{}\n", format_text(find_format(all, name, "")));
  if (!options.names.empty()) return ExitStatus::passed;
  std::size_t width = 0;
  for (const FileFormat& format : all) width = std::max(width, format.schema.size());
  for (const FileFormat& format : all) {
    fmt::print("{:{}}  {}{}\n", format.schema, width, format.internal ? "(internal) " : "",
               format.summary.substr(0, format.summary.find_first_of(".(")));
  }
  return ExitStatus::passed;
}

}  // namespace

void add_formats(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand("formats", "Say what is in the files that the program writes and reads");
  const auto options = std::make_shared<FormatOptions>();
  command->add_option("names", options->names, "Formats to describe: findings, touchstone-findings/1, ...");
  command->add_option("--explain", options->explained, "Say of each key of these JSON files what it is");
  command->add_option("--check", options->checked, "Say where these JSON files are not what their format says");
  command->add_option("--as", options->as, "Format of files without the key \"schema\"");
  command->add_flag("--unseen", options->unseen, "With --check: keys of their formats that none of the files has, too");
  command->add_option("--json-schema", options->json_schema,
                      "One format as JSON Schema (draft 2020-12): an editor completes and checks such files by it");
  command->add_flag("--markdown", options->markdown, "Everything, as docs/reference/formats.md has it");
  command->footer(
      "Exit status: 1 if a file is not what its format says.\n"
      "Examples:\n  touchstone formats\n  touchstone formats findings\n  touchstone formats --explain "
      "evaluation/result.json\n  touchstone formats --explain timing.json --as replay-timing\n"
      "  touchstone formats --json-schema golden-case > case.schema.json");
  command->callback([options, &run] { run = [options] { return run_formats(*options); }; });
}

}  // namespace touchstone::apps
