#include "signature.h"

#include <fmt/format.h>

#include <vector>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/other_program.h"

namespace touchstone::board {
namespace {

// ssh-keygen with these words, reading `input`, which never asks.
ProgramEnd ssh_keygen(const std::vector<std::string>& words, const std::filesystem::path& input) {
  OtherProgram program{{"ssh-keygen"}, Printed::kept, Printed::kept, input, true};
  program.words.insert(program.words.end(), words.begin(), words.end());
  auto end = run_other(program);
  if (!end)
    throw UsageError("ssh-keygen was not found; install openssh-client to sign submissions and to check signatures");
  return *std::move(end);
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
  const ProgramEnd answer = ssh_keygen({"-Y", "sign", "-q", "-f", key.string(), "-n", signature_namespace}, file);
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
  const ProgramEnd any =
      ssh_keygen({"-Y", "check-novalidate", "-n", signature_namespace, "-s", signature.string()}, file);
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
  const ProgramEnd who =
      ssh_keygen({"-Y", "find-principals", "-s", signature.string(), "-f", allowed_signers.string()}, file);
  const std::string signer = who.out.substr(0, who.out.find('\n'));
  const bool listed = who.status == 0 && !signer.empty();
  const ProgramEnd good = listed ? ssh_keygen({"-Y", "verify", "-f", allowed_signers.string(), "-I", signer, "-n",
                                               signature_namespace, "-s", signature.string()},
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
