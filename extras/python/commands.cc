#include "apps/commands.h"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <mutex>

#include "acquire_command.h"
#include "apps/program.h"
#include "command_axis.h"
#include "dashboard_commands.h"
#include "dataset_commands.h"
#include "harness/base/input_files.h"
#include "leaderboard_command.h"
#include "module.h"
#include "study_commands.h"
#include "tool_commands.h"

namespace touchstone::python {
namespace {

namespace py = pybind11;

// While it lives, what the program prints goes into memory. Standard output belongs to the whole process: one at a
// time.
class PrintedText {
 public:
  PrintedText() : memory_(::memfd_create("touchstone", MFD_CLOEXEC)), before_(::dup(STDOUT_FILENO)) {
    if (memory_ < 0 || before_ < 0)
      throw BadData(fmt::format("standard output cannot be taken into memory: {}", std::strerror(errno)));
    std::fflush(stdout);
    ::dup2(memory_, STDOUT_FILENO);
  }
  ~PrintedText() {
    std::fflush(stdout);
    ::dup2(before_, STDOUT_FILENO);
    ::close(before_);
    ::close(memory_);
  }
  PrintedText(const PrintedText&) = delete;
  PrintedText& operator=(const PrintedText&) = delete;

  [[nodiscard]] std::string text() const {
    std::fflush(stdout);
    std::string out;
    std::array<char, 65536> part{};
    for (::ssize_t got = 0; (got = ::pread(memory_, part.data(), part.size(), static_cast<::off_t>(out.size()))) > 0;)
      out.append(part.data(), static_cast<std::size_t>(got));
    return out;
  }

 private:
  int memory_;
  int before_;
};

// Outputs of one command must not destroy its own inputs; the next command may read what this one wrote.
class ProtectedInputs {
 public:
  ProtectedInputs() { protect_input_files(); }
  ~ProtectedInputs() { forget_input_files(); }
  ProtectedInputs(const ProtectedInputs&) = delete;
  ProtectedInputs& operator=(const ProtectedInputs&) = delete;
};

// The program's, and those of the extras that have a function of the package.
std::vector<apps::AddCommand> all_commands() {
  std::vector<apps::AddCommand> all = apps::commands();
  all.insert(all.end(), {acquisition::add_acquire, axis::add_axis, board::add_leaderboard, dashboard::add_dashboard,
                         datasets::add_dataset, datasets::add_synth, dashboard::add_history, studies::add_atlas,
                         studies::add_sweep, tool::add_tool});
  return all;
}

// Exit status and standard output of a command of the program, run in this process.
std::pair<int, std::string> run_command(const std::vector<std::string>& words) {
  return LongWork::call([&] {
    static std::mutex one_at_a_time;
    const std::lock_guard lock(one_at_a_time);
    const ProtectedInputs inputs;
    const PrintedText printed;
    const ExitStatus status = apps::run_words(words, all_commands());
    return std::pair(static_cast<int>(status), printed.text());
  });
}

py::list options_of(const CLI::App& command) {
  py::list out;
  for (const CLI::Option* const option : command.get_options()) {
    if (option->check_lname("help")) continue;
    py::dict about;
    about["name"] = option->get_positional() ? option->get_name(true) : option->get_lnames().front();
    about["positional"] = option->get_positional();
    about["flag"] = option->get_items_expected_max() == 0;
    about["several"] = option->get_items_expected_max() > 1;
    about["required"] = option->get_required();
    about["default"] = option->get_default_str();
    about["type"] = option->get_type_name();
    about["meaning"] = option->get_description();
    out.append(about);
  }
  return out;
}

void describe(const CLI::App& parent, const std::string& prefix, py::dict& out) {
  for (const CLI::App* const command : parent.get_subcommands({})) {
    const std::string name = prefix + command->get_name();
    py::dict about;
    about["summary"] = command->get_description();
    about["options"] = options_of(*command);
    about["notes"] = command->get_footer();
    out[py::str(name)] = about;
    describe(*command, name + " ", out);
  }
}

// Every command with its options, as the program's own parser knows them; of a command's subcommand "golden accept".
py::dict describe_commands() {
  CLI::App program{"", "touchstone"};
  apps::Run unused;
  for (const auto add : all_commands()) add(program, unused);
  py::dict out;
  describe(program, "", out);
  return out;
}

}  // namespace

void bind_commands(py::module_& module) {
  module.def("run_command", &run_command, py::arg("words"));
  module.def("describe_commands", &describe_commands);
}

}  // namespace touchstone::python
