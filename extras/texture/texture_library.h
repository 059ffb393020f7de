// A texture as one file that every command takes with --plugin: a copy of the plug-in with the model's XML behind the
// library's own bytes, which the system's loader does not look at. So a golden, which names the library's SHA-256,
// names the texture.
//
// Layout: the library, the XML, the XML's length as 8 bytes (least first), 16 bytes of name.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace touchstone::texture {

// The plug-in without a model, of this installation: ../libexec/touchstone from the running program's file. Throws
// BadData where it is not.
std::filesystem::path plain_texture_library();

// Writes the copy at `out`, whole or not at all.
void write_texture_library(const std::filesystem::path& library, const std::string& xml,
                           const std::filesystem::path& out);

// The XML behind the library; nothing if it has none.
std::optional<std::string> model_in_library(const std::filesystem::path& library);

}  // namespace touchstone::texture
