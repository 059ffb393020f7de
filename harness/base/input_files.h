// Outputs never destroy inputs. Readers note the files that they open, writers (atomic_file.h) refuse to replace one of
// those, whatever it is called: another path, a hard link or a symbolic link to the same file counts as that file.
// Off until a program asks for it, since only a program knows that all that it reads belongs to one task.
#pragma once

#include <filesystem>

namespace touchstone {

// From here on files that were read are protected. For programs, once, at their start.
void protect_input_files();
// Ends that and forgets them: for a process that does one task after another.
void forget_input_files();

// Whoever reads a file says so. Files that this program itself wrote are no inputs.
void note_input_file(const std::filesystem::path& path);
// Whoever finished a file says so.
void note_output_file(const std::filesystem::path& path);

// Throws UsageError when writing `target` would destroy a file that was read. For commands whose output folder may hold
// their inputs: as soon as everything is read, before the long work begins.
void refuse_to_replace_input(const std::filesystem::path& target);

}  // namespace touchstone
