#include "signature.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <vector>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace touchstone::board {
namespace {

struct Answer {
  int status = 0;
  std::string out, err;
};

std::string all_of(int fd) {
  std::string text;
  std::array<char, 4096> buffer{};
  while (true) {
    const ssize_t n = ::read(fd, buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    text.append(buffer.data(), static_cast<std::size_t>(n));
  }
  ::close(fd);
  return text;
}

// ssh-keygen with these words, reading `input`; in a session of its own, without a terminal, so that it never asks.
Answer ssh_keygen(std::vector<std::string> words, const std::filesystem::path& input) {
  std::array<int, 2> out{};
  std::array<int, 2> err{};
  if (::pipe2(out.data(), O_CLOEXEC) != 0 || ::pipe2(err.data(), O_CLOEXEC) != 0)
    throw BadData("ssh-keygen cannot be started: no pipe");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, input.c_str(), O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out[1], 1);
  posix_spawn_file_actions_adddup2(&actions, err[1], 2);
  words.insert(words.begin(), "ssh-keygen");
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  pid_t child = 0;
  const int failed = ::posix_spawnp(&child, "ssh-keygen", &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  ::close(out[1]);
  ::close(err[1]);
  Answer answer;
  answer.out = all_of(out[0]);  // a signature is a kilobyte: the other pipe cannot fill meanwhile
  answer.err = all_of(err[0]);
  if (failed != 0)
    throw UsageError("ssh-keygen was not found; install openssh-client to sign submissions and to check signatures");
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  answer.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return answer;
}

std::string one_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

void need(const std::filesystem::path& file, const char* what) {
  if (!std::filesystem::is_regular_file(file)) throw BadData(fmt::format("{}: no such {}", file.string(), what));
}

}  // namespace

std::filesystem::path signature_of(const std::filesystem::path& file) { return file.string() + ".sig"; }

void sign_submission(const std::filesystem::path& file, const std::filesystem::path& key) {
  need(key, "key");
  const Answer answer = ssh_keygen({"-Y", "sign", "-q", "-f", key.string(), "-n", kSignatureNamespace}, file);
  if (answer.status != 0 || answer.out.find("BEGIN SSH SIGNATURE") == std::string::npos) {
    throw BadData(
        fmt::format("{} cannot be signed with {}: {}. Is it a private key of ssh-keygen, and without a "
                    "passphrase or in an agent?",
                    file.string(), key.string(), one_line(answer.err)));
  }
  write_file(signature_of(file), answer.out);
}

CheckedSignature check_signature(const std::filesystem::path& file, const std::filesystem::path& signature,
                                 const std::filesystem::path& allowed_signers) {
  need(signature, "signature");
  const Answer any = ssh_keygen({"-Y", "check-novalidate", "-n", kSignatureNamespace, "-s", signature.string()}, file);
  if (any.status != 0) {
    throw BadData(
        fmt::format("{}: is no signature of {}: {}", signature.string(), file.string(), one_line(any.err + any.out)));
  }
  CheckedSignature out;
  // Good "touchstone-submission" signature with ED25519 key SHA256:...
  const std::string said = one_line(any.out);
  const auto with = said.find(" with ");
  out.key = with == std::string::npos ? said : said.substr(with + 6);
  if (allowed_signers.empty()) return out;
  need(allowed_signers, "list of allowed signers");
  const Answer who =
      ssh_keygen({"-Y", "find-principals", "-s", signature.string(), "-f", allowed_signers.string()}, file);
  const std::string signer = who.out.substr(0, who.out.find('\n'));
  const bool listed = who.status == 0 && !signer.empty();
  const Answer good = listed ? ssh_keygen({"-Y", "verify", "-f", allowed_signers.string(), "-I", signer, "-n",
                                           kSignatureNamespace, "-s", signature.string()},
                                          file)
                             : who;
  if (!listed || good.status != 0) {
    throw BadData(fmt::format("{}: was made with {}, which {} does not allow: {}", signature.string(), out.key,
                              allowed_signers.string(), one_line(good.err)));
  }
  out.signer = signer;
  return out;
}

}  // namespace touchstone::board
