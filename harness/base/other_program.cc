#include "harness/base/other_program.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>

namespace touchstone {
namespace {

// Where one stream of the program goes. A file in memory: unlike a pipe it never fills, so that both streams can be
// kept and read when the program has ended.
class Stream {
 public:
  explicit Stream(Printed printed) {
    if (printed == Printed::kept) fd_ = ::memfd_create("printed", MFD_CLOEXEC);
    if (printed == Printed::dropped) fd_ = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    usable_ = printed == Printed::shown || fd_ >= 0;
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
         fd_ >= 0 && (got = ::pread(fd_, part.data(), part.size(), static_cast<::off_t>(out.size()))) > 0;)
      out.append(part.data(), static_cast<std::size_t>(got));
    return out;
  }

 private:
  int fd_ = -1;
  bool usable_ = false;
};

// In the new process, where only what is safe between fork() and exec() may be called. Returns what was wrong.
int become(const OtherProgram& program, char* const* words, const Stream& out, const Stream& err, pid_t parent) {
  std::signal(SIGXFSZ, SIG_DFL);  // what this program ignores the other one would
  if (program.ends_with_this) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) return ECHILD;  // it ended before that was asked for
  }
  if (program.without_terminal) ::setsid();
  if (!program.input.empty()) {
    const int input = ::open(program.input.c_str(), O_RDONLY);
    if (input < 0 || ::dup2(input, STDIN_FILENO) < 0) return errno;
  }
  if (!out.becomes(STDOUT_FILENO) || !err.becomes(STDERR_FILENO)) return errno;
  ::execvp(words[0], words);
  return errno;
}

}  // namespace

std::optional<ProgramEnd> run_other(const OtherProgram& program) {
  std::vector<std::string> words = program.words;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const Stream out(program.out), err(program.err);
  std::array<int, 2> failure{};
  if (!out.usable() || !err.usable() || ::pipe2(failure.data(), O_CLOEXEC) != 0) return std::nullopt;
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child == 0) {
    const int wrong = become(program, arguments.data(), out, err, parent);
    [[maybe_unused]] const auto told = ::write(failure[1], &wrong, sizeof wrong);
    ::_exit(127);
  }
  ::close(failure[1]);
  int wrong = 0;
  // exec() closes the pipe: nothing to read means that the program runs.
  const bool started = child > 0 && ::read(failure[0], &wrong, sizeof wrong) != static_cast<::ssize_t>(sizeof wrong);
  ::close(failure[0]);
  int status = 0;
  while (child > 0 && ::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!started) return std::nullopt;
  return ProgramEnd{WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), out.text(), err.text()};
}

}  // namespace touchstone
