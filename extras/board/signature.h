// Who vouches for a submission: a signature of its file by an SSH key, made and checked by OpenSSH's ssh-keygen (-Y
// sign, -Y verify; format SSHSIG, PROTOCOL.sshsig of OpenSSH 8.0 and later). A lab has such keys already, and a list of
// allowed signers is the file that git uses, too (ssh-keygen(1), ALLOWED SIGNERS).
#pragma once

#include <filesystem>
#include <string>

namespace touchstone::board {

// What the signature is for: one that was made for a commit or a mail is not good for a submission.
inline constexpr const char* signature_namespace = "touchstone-submission";

// `file` with ".sig" behind its name.
std::filesystem::path signature_of(const std::filesystem::path& file);

// Writes signature_of(file). `key`: a private key, or a public one whose private half an agent holds. Throws BadData
// with what ssh-keygen said, UsageError where there is no ssh-keygen.
void sign_submission(const std::filesystem::path& file, const std::filesystem::path& key);

struct CheckedSignature {
  std::string signer;  // by the list of allowed signers; empty where none was given
  std::string key;     // "ED25519 key SHA256:..."
};

// Throws BadData where the signature is not one of this file, or its key is not in `allowed_signers` ("": any key is
// taken, and `key` says which it was).
CheckedSignature check_signature(const std::filesystem::path& file, const std::filesystem::path& signature,
                                 const std::filesystem::path& allowed_signers);

}  // namespace touchstone::board
