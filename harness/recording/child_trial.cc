#include "harness/recording/child_trial.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

namespace touchstone::recording {
namespace {

constexpr unsigned longest_s = 120;

[[noreturn]] void run(const std::function<void()>& work) {
  // Crash handlers of the parent (of a sanitizer, a fuzzer, a test program) would report what is expected here.
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGALRM}) std::signal(signal, SIG_DFL);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  alarm(longest_s);
  try {
    work();
  } catch (...) {
    // An ordinary refusal: the parent meets it again and reports it.
  }
  _exit(0);
}

}  // namespace

ChildOutcome try_in_child(const std::function<void()>& work) {
  const pid_t child = fork();
  if (child < 0) return ChildOutcome::no_verdict;
  if (child == 0) run(work);
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return ChildOutcome::no_verdict;
  }
  if (WIFSIGNALED(status)) return WTERMSIG(status) == SIGALRM ? ChildOutcome::no_verdict : ChildOutcome::crashed;
  return WEXITSTATUS(status) == 0 ? ChildOutcome::survived : ChildOutcome::crashed;
}

}  // namespace touchstone::recording
