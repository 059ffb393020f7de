#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "apps/command.h"
#include "apps/program.h"
#include "guess_map.h"
#include "harness/base/atomic_file.h"
#include "harness/base/bundled_files.h"
#include "harness/base/error.h"
#include "import_file.h"

namespace touchstone::importing {
namespace {

struct ImportOptions {
  std::string file, map, out, picture;
  bool guess = false, yes = false;
};

// Writes the proposal, or prints it where no file for it is named.
void propose_map(const ImportOptions& options, const GuessedMap& guessed) {
  for (const std::string& reason : guessed.reasons) fmt::print(stderr, "{}\n", reason);
  for (const std::string& reason : guessed.unused) fmt::print(stderr, "{}\n", reason);
  if (!guessed.missing.empty()) {
    fmt::print(stderr, "nothing was found for {}: a recording needs it\n", fmt::join(guessed.missing, ", "));
  }
  if (!guessed.decide.empty()) {
    fmt::print(stderr, "to be decided in the map, which is refused until its list \"decide\" is empty:\n");
    for (const std::string& question : guessed.decide) fmt::print(stderr, "  {}\n", question);
  }
  if (options.map.empty()) {
    fmt::print("{}", guessed.json);
    return;
  }
  if (std::filesystem::exists(options.map)) {
    throw UsageError(
        fmt::format("--map {} exists: a proposal does not take its place; name another file", options.map));
  }
  write_file(options.map, guessed.json);
  fmt::print("a proposal is written to {0}; read it, correct it, then\n  touchstone import {1} --map {0} --out R.csv\n",
             options.map, options.file);
}

// What stands against writing the file as it was understood.
std::vector<std::string> doubts_of(const GuessedMap& guessed) {
  std::vector<std::string> doubts = guessed.decide;
  // Of a map without columns: what is to be decided says more.
  const bool no_columns = !guessed.read && guessed.unreadable.find(": /columns: ") != std::string::npos;
  if (no_columns && guessed.decide.empty()) {
    doubts.emplace_back("no column is known to be a position or a force: say in a map which are");
  } else if (!guessed.read && !no_columns) {
    doubts.push_back(guessed.unreadable);
  }
  if (std::ranges::find(guessed.missing, "t_s") != guessed.missing.end() && guessed.decide.empty()) {
    doubts.emplace_back("t_s: nothing says when the rows were measured: put \"t_s\": {\"row_rate_Hz\": ...}");
  }
  return doubts;
}

// Lines of at most 80, those behind the first set in by as much as `label` is wide.
void print_wrapped(const std::string& label, const std::string& text) {
  constexpr std::size_t widest = 80;
  std::string line = label;
  std::size_t width = label.size();
  for (std::size_t at = 0; at < text.size();) {
    const auto end = std::min(text.find(' ', at), text.size());
    const std::string_view word = std::string_view(text).substr(at, end - at);
    // Bytes that continue a character take no room.
    const auto room = static_cast<std::size_t>(
        std::ranges::count_if(word, [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U; }));
    if (width + 1 + room > widest && width > label.size()) {
      fmt::print("{}\n", line);
      line.assign(label.size(), ' ');
      width = label.size();
    }
    line += " ";
    line += word;
    width += 1 + room;
    at = end + 1;
  }
  fmt::print("{}\n", line);
}

// Of the columns that are not used the names, and of the notes those that say that something of the file is missing.
void show_left_out(const ImportOptions& options, const GuessedMap& guessed) {
  std::vector<std::string> unused;
  constexpr std::size_t most = 6;
  for (const std::string& reason : guessed.unused) {
    if (unused.size() < most) unused.push_back(reason.substr(0, reason.find(": not used")));
  }
  if (!unused.empty()) {
    print_wrapped(
        "not used:",
        fmt::format("{}{}", fmt::join(unused, ", "),
                    guessed.unused.size() > most ? fmt::format(" and {} more", guessed.unused.size() - most) : ""));
  }
  const auto angle = std::ranges::find_if(guessed.unused, [](const auto& r) { return r.find("\"euler\"") != r.npos; });
  if (angle != guessed.unused.end()) print_wrapped("note:", *angle);
  for (const std::string& note : guessed.read ? guessed.read->notes : std::vector<std::string>{}) {
    if (note.find("left out") == std::string::npos && note.find("cut short") == std::string::npos) continue;
    print_wrapped("note:", note.starts_with(options.file + ": ") ? note.substr(options.file.size() + 2) : note);
  }
}

// What was understood without a map; with --yes it is written if nothing is in doubt.
ExitStatus show_understood(const ImportOptions& options, const GuessedMap& guessed) {
  if (guessed.read) fmt::print("{}", imported_text(*guessed.read, guessed.from));
  show_left_out(options, guessed);
  if (!guessed.missing.empty()) fmt::print("nothing was found for {}\n", fmt::join(guessed.missing, ", "));
  const std::vector<std::string> doubts = doubts_of(guessed);
  // Of a whole set one line, by its numbers, says more than one for each column; and what is in doubt says its own.
  for (const std::string& reason : guessed.reasons) {
    const bool said_elsewhere = reason.find("the file names no unit") != std::string::npos ||
                                (!doubts.empty() && reason.find("names no axis") != std::string::npos);
    if (!said_elsewhere && reason.find("assumed") != std::string::npos) print_wrapped("assumed:", reason);
  }
  if (guessed.read && !options.picture.empty()) {
    write_file(options.picture, imported_picture(*guessed.read, options.file));
  }
  for (const std::string& doubt : doubts) print_wrapped("in doubt:", doubt);
  if (!options.yes) {
    if (doubts.empty()) {
      fmt::print("nothing is in doubt: --yes --out R.csv writes it; --guess tells why\n");
    } else {
      fmt::print("--guess --map {}.map.json writes a map in which to decide\n",
                 std::filesystem::path(options.file).stem().string());
    }
    return ExitStatus::passed;
  }
  if (!doubts.empty()) {
    throw BadData(fmt::format("{}: not written, for {} in doubt: {}", options.file,
                              doubts.size() == 1 ? "one thing is" : fmt::format("{} things are", doubts.size()),
                              doubts.front()));
  }
  save_imported(options.out, *guessed.read);
  fmt::print("written: {}\n", options.out);
  return ExitStatus::passed;
}

std::string bundled_maps() {
  std::vector<std::string> names;
  if (const auto folder = find_bundled("import"))
    for (const auto& entry : std::filesystem::directory_iterator(*folder)) names.push_back(entry.path().filename());
  std::ranges::sort(names);
  return fmt::format("{}", fmt::join(names, ", "));
}

// The user's file; else the map of that name that comes with the program.
std::filesystem::path map_file(const std::string& map) {
  if (std::filesystem::exists(map)) return map;
  if (const auto folder = find_bundled("import");
      folder && !std::filesystem::path(map).has_parent_path() && std::filesystem::exists(*folder / map))
    return *folder / map;
  throw BadData(
      fmt::format("--map {}: there is no such file, and no map of that name comes with the program; these do: {}", map,
                  bundled_maps()));
}

ExitStatus import_command(const ImportOptions& options) {
  if (options.yes && options.out.empty()) throw UsageError("--yes: writes what was read: name it with --out R.csv");
  if (options.guess || options.map.empty()) {
    if (!options.guess && !options.out.empty() && !options.yes) {
      throw UsageError("--out: a map is needed (--map; --guess proposes one), or --yes where nothing is in doubt");
    }
    const GuessedMap guessed = guess_map(options.file);
    if (!options.guess) return show_understood(options, guessed);
    propose_map(options, guessed);
    return ExitStatus::passed;
  }
  const Imported imported = import_file(options.file, load_import_map(map_file(options.map)));
  for (const std::string& note : imported.notes) fmt::print(stderr, "note: {}\n", note);
  if (!options.out.empty()) save_imported(options.out, imported);
  if (!options.picture.empty()) write_file(options.picture, imported_picture(imported, options.file));
  fmt::print("{}", imported_text(imported));
  if (!options.out.empty()) fmt::print("written: {}\n", options.out);
  return ExitStatus::passed;
}

void add_import(CLI::App& program, apps::Run& run) {
  auto* const command =
      program.add_subcommand("import", "Foreign tables, .mat files, ROS bags and curves to a recording");
  const auto options = std::make_shared<ImportOptions>();
  command
      ->add_option(
          "file", options->file,
          "What the instrument wrote: a table of text, .xlsx, .lvm, .tdms, an AFM curve, .mat, a ROS bag (.bag, .mcap, "
          ".db3), HDF5, .npy, .npz")
      ->required();
  command->add_option(
      "--map", options->map,
      "What its columns mean (JSON, schema touchstone-import/1): a file, or the name of a map that comes with the "
      "program; with --guess: the file to write");
  auto* const guess = command->add_flag("--guess", options->guess,
                                        "Propose a map, each line of it with its reason, and import nothing");
  command
      ->add_flag("--yes", options->yes, "Write --out without a map, as the file was understood, if nothing is in doubt")
      ->excludes(guess);
  command->add_option("--out", options->out, "The recording to write (.csv); without it what was read is only shown");
  command->add_option("--picture", options->picture, "Draw what was read into this file (.svg)");
  command->footer(
      "Without a map the program shows what it understood of the file and what is in doubt. What is read is shown: "
      "rate, "
      "units, first values, ranges, course. Nothing is written where the result is no recording.\n\n"
      "Examples:\n"
      "  touchstone import log.txt\n"
      "  touchstone import log.txt --yes --out log.csv\n"
      "  touchstone import log.txt --guess --map log.map.json\n"
      "  touchstone import log.txt --map log.map.json --picture log.svg\n"
      "  touchstone import log.txt --map log.map.json --out log.csv\n"
      "  touchstone import netft.csv --map net-ft-demo.json --out wrench.csv\n\n"
      "Maps that come with the program: " +
      bundled_maps());
  command->callback([&run, options] { run = [options] { return import_command(*options); }; });
}

}  // namespace
}  // namespace touchstone::importing

int main(int argc, char** argv) { return touchstone::apps::run_extra(argc, argv, {touchstone::importing::add_import}); }
