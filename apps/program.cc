#include "apps/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <system_error>

#include "apps/extras.h"
#include "harness/base/bundled_files.h"
#include "harness/base/input_files.h"
#include "harness/base/known_names.h"
#include "harness/base/partial_files.h"
#include "harness/base/version.h"

namespace touchstone::apps {
namespace {

std::vector<std::string>& called_as() {
  static std::vector<std::string> words;
  return words;
}

std::vector<std::string> names_of_commands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* const command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

// The command that the first words name, unless the first names an extra, which the program becomes. UsageError with
// the one that was probably meant where there is none, before CLI11 says that some command is missing, or takes
// `--help` for the program's.
const CLI::App* named_command(const CLI::App& program, int argc, char** argv) {
  const CLI::App* app = &program;
  for (int i = 1; i < argc && argv[i][0] != '-'; ++i) {
    auto names = names_of_commands(*app);
    if (names.empty()) break;
    if (std::ranges::find(names, argv[i]) == names.end()) {
      if (i == 1) {
        if (const auto extra = find_extra(argv[1])) become_extra(*extra, argv + 2);
        for (const Extra& extra : find_extras(names)) names.push_back(extra.name);
      }
      throw UsageError(unknown_name("command", argv[i], names));
    }
    app = app->get_subcommand(argv[i]);
  }
  return app;
}

// Of what CLI11 did not expect, the first option and the one that was probably meant; "" where there is none.
std::string meant_option(const CLI::App& command, int argc, char** argv) {
  std::vector<std::string> known;
  for (const CLI::Option* const option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  }
  for (int i = 1; i < argc; ++i) {
    const std::string word = std::string(argv[i]).substr(0, std::string_view(argv[i]).find('='));
    if (!word.starts_with("--") || std::ranges::find(known, word) != known.end()) continue;
    const std::string meant = closest_name(word, known);
    if (!meant.empty()) return fmt::format("{}: did you mean {}?\n", word, meant);
  }
  return {};
}

// Nothing, or the extras with where they are.
std::string listed_extras(const CLI::App& program) {
  std::string out;
  for (const Extra& extra : find_extras(names_of_commands(program)))
    out += fmt::format("{}{} ({})", out.empty() ? "Extras: " : ", ", extra.name, extra.program.string());
  return out;
}

// Runs what was chosen; a folder that it made and left empty stays only where it passed.
ExitStatus run_chosen(const Run& chosen) {
  try {
    const ExitStatus status = chosen();
    remove_empty_made_folders(status == ExitStatus::passed);
    return status;
  } catch (...) {
    remove_empty_made_folders();
    throw;
  }
}

int run(int argc, char** argv, const std::vector<AddCommand>& commands) {
  CLI::App program{
      "Touchstone tells whether a haptic renderer is right: it replays measured probe trajectories through "
      "renderers and compares forces, positions and cost with the measured truth.",
      "touchstone"};
  program.require_subcommand(1);
  program.set_version_flag("--version", build_info().version);
  program.footer(
      "Exit status: 0 passed, 1 a regression or a disagreement beyond tolerance, 2 usage, 3 bad data, 77 skipped.");
  Run chosen;
  for (const auto add : commands) add(program, chosen);
  program.footer(
      [&program] { return listed_extras(program); });  // of the program alone: commands take the footer above
  const CLI::App* const command = named_command(program, argc, argv);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
      fmt::print(stderr, "{}", meant_option(*command, argc, argv));
    }
    const int status = program.exit(error);
    return status == 0 ? 0 : static_cast<int>(ExitStatus::usage);
  }
  return static_cast<int>(run_chosen(chosen));
}

int lost_output() {
  fmt::print(stderr, "touchstone: standard output cannot be written ({}); the results on it are not complete\n",
             std::strerror(errno));
  return static_cast<int>(ExitStatus::bad_data);
}

}  // namespace

const std::vector<std::string>& command_line() { return called_as(); }

ExitStatus run_words(const std::vector<std::string>& words, const std::vector<AddCommand>& commands) {
  CLI::App program{"", "touchstone"};
  program.require_subcommand(1);
  Run chosen;
  for (const auto add : commands) add(program, chosen);
  called_as() = words;
  called_as().insert(called_as().begin(), "touchstone");
  try {
    std::vector<std::string> reversed(words.rbegin(), words.rend());  // as CLI11 takes them
    program.parse(std::move(reversed));
  } catch (const CLI::CallForHelp&) {
    std::fputs(
        program.get_subcommands().empty() ? program.help().c_str() : program.get_subcommands().front()->help().c_str(),
        stdout);
    return ExitStatus::passed;
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  return run_chosen(chosen);
}

int run_program(int argc, char** argv, const std::vector<AddCommand>& commands) {
  called_as().assign(argv, argv + argc);
  remove_partial_files_when_interrupted();
  protect_input_files();
  // A file that grows beyond the limit (ulimit -f) is an error like a full disk, with its message and exit status.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    const int status = run(argc, argv, commands);
    // What is still in the buffer may not fit: only now it is known whether the result was written.
    return std::fflush(stdout) == 0 && std::ferror(stdout) == 0 ? status : lost_output();
  } catch (const Error& error) {
    fmt::print(stderr, "touchstone: {}\n", error.what());
    return static_cast<int>(error.status());
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "touchstone: out of memory\n");
    return static_cast<int>(ExitStatus::bad_data);
  } catch (const std::system_error& error) {
    if (std::ferror(stdout) != 0) return lost_output();
    fmt::print(stderr, "touchstone: the machine refused: {}\n", error.what());
    return static_cast<int>(ExitStatus::bad_data);
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return lost_output();
    fmt::print(stderr, "touchstone: internal error, please report it: {}\n", error.what());
    return 70;
  }
}

int run_extra(int argc, char** argv, const std::vector<AddCommand>& commands) {
  const char* const started_by = std::getenv("TOUCHSTONE_PROGRAM");
  std::error_code error;
  const std::filesystem::path beside =
      std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / "touchstone";
  search_bundled_above(started_by != nullptr ? std::filesystem::path(started_by) : beside);
  std::string called = std::filesystem::path(argc > 0 ? argv[0] : "").filename().string();
  std::vector<char*> words(argv, argv + argc);
  if (called.starts_with("touchstone-")) words.insert(words.begin() + 1, called.data() + called.find('-') + 1);
  words.push_back(nullptr);
  return run_program(static_cast<int>(words.size()) - 1, words.data(), commands);
}

}  // namespace touchstone::apps
