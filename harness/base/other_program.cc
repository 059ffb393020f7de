#include "harness/base/other_program.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <map>
#include <thread>

namespace touchstone {
namespace {

// Where one stream of the program goes. A file in memory: unlike a pipe it never fills, so that both streams can be
// kept and read when the program has ended.
class Stream {
 public:
  // `how` a file is opened, if there is one.
  Stream(Printed printed, const std::filesystem::path& file, int how) {
    if (!file.empty()) {
      fd_ = ::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | how, 0644);
    } else if (printed == Printed::kept) {
      fd_ = ::memfd_create("printed", MFD_CLOEXEC);
    } else if (printed == Printed::dropped) {
      fd_ = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    }
    kept_ = file.empty() && printed == Printed::kept;
    usable_ = fd_ >= 0 || (file.empty() && (printed == Printed::shown || printed == Printed::with_errors));
  }
  ~Stream() {
    if (fd_ >= 0) ::close(fd_);
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  [[nodiscard]] bool usable() const noexcept { return usable_; }
  [[nodiscard]] bool becomes(int stream) const noexcept { return fd_ < 0 || ::dup2(fd_, stream) >= 0; }
  [[nodiscard]] std::string text() const {
    std::string out;
    std::array<char, 4096> part{};
    for (::ssize_t got = 0;
         kept_ && (got = ::pread(fd_, part.data(), part.size(), static_cast<::off_t>(out.size()))) > 0;)
      out.append(part.data(), static_cast<std::size_t>(got));
    return out;
  }

 private:
  int fd_ = -1;
  bool usable_ = false, kept_ = false;
};

// In the new process, where only what is safe between fork() and exec() may be called. Returns what was wrong.
int become(const OtherProgram& program, char* const* words, char* const* environment, const Stream& out,
           const Stream& err, pid_t parent) {
  std::signal(SIGXFSZ, SIG_DFL);  // what this program ignores the other one would
  if (program.ends_with_this) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) return ECHILD;  // it ended before that was asked for
  }
  if (program.without_terminal) ::setsid();
  if (program.stop != nullptr) ::setpgid(0, 0);
  if (!program.input.empty()) {
    const int input = ::open(program.input.c_str(), O_RDONLY);
    if (input < 0 || ::dup2(input, STDIN_FILENO) < 0) return errno;
  }
  if (!out.becomes(STDOUT_FILENO) || !err.becomes(STDERR_FILENO)) return errno;
  if (program.out == Printed::with_errors && program.out_file.empty() && ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0)
    return errno;
  if (!program.folder.empty() && ::chdir(program.folder.c_str()) != 0) return errno;
  ::execvpe(words[0], words, environment);
  return errno;
}

std::vector<std::string> whole_environment(const OtherProgram& program) {
  std::map<std::string, std::string> values;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    if (const auto equals = text.find('='); equals != std::string::npos)
      values[text.substr(0, equals)] = text.substr(equals + 1);
  }
  for (const auto& [name, value] : program.environment) values[name] = value;
  std::vector<std::string> result;
  result.reserve(values.size());
  for (const auto& [name, value] : values) result.emplace_back(name).append("=").append(value);
  return result;
}

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

// Ends the group, politely first: a compiler removes its partial files then.
void end_group(pid_t group) {
  constexpr auto patience = std::chrono::milliseconds(2000);
  constexpr auto pause = std::chrono::milliseconds(20);
  ::kill(-group, SIGTERM);
  int status = 0;
  for (auto waited = pause; waited < patience && ::waitpid(group, &status, WNOHANG) == 0; waited += pause)
    std::this_thread::sleep_for(pause);
  ::kill(-group, SIGKILL);
  ::waitpid(group, &status, 0);
}

int wait_for(pid_t child, const std::atomic<bool>* stop) {
  int status = 0;
  if (stop == nullptr) {
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
  }
  auto pause = std::chrono::milliseconds(1);
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (*stop) {
      end_group(child);
      throw Interrupted();
    }
    std::this_thread::sleep_for(pause);
    pause = std::min(pause * 2, std::chrono::milliseconds(50));
  }
  return status;
}

}  // namespace

std::optional<ProgramEnd> run_other(const OtherProgram& program) {
  std::vector<std::string> words = program.words;
  std::vector<std::string> environment = whole_environment(program);
  const std::vector<char*> arguments = pointers_to(words), variables = pointers_to(environment);
  const Stream out(program.out, program.out_file, O_TRUNC), err(program.err, program.err_file, O_APPEND);
  std::array<int, 2> failure{};
  if (!out.usable() || !err.usable() || ::pipe2(failure.data(), O_CLOEXEC) != 0) return std::nullopt;
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child == 0) {
    const int wrong = become(program, arguments.data(), variables.data(), out, err, parent);
    [[maybe_unused]] const auto told = ::write(failure[1], &wrong, sizeof wrong);
    ::_exit(127);
  }
  ::close(failure[1]);
  int wrong = 0;
  // exec() closes the pipe: nothing to read means that the program runs.
  const bool started = child > 0 && ::read(failure[0], &wrong, sizeof wrong) != static_cast<::ssize_t>(sizeof wrong);
  ::close(failure[0]);
  const int status = child > 0 ? wait_for(child, program.stop) : 0;
  if (!started) return std::nullopt;
  return ProgramEnd{WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), out.text(), err.text()};
}

}  // namespace touchstone
