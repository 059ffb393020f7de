// Whether a MATLAB v5 file is whole and its sizes can be true: matio reads a file that was cut short up to the cut and
// does not say so, and allocates by whatever a damaged file says.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace touchstone::importing {

// The variables of a level 5 MAT-file ("MAT-File Format", The MathWorks, chapter 1: a head of 128 bytes whose last two
// are "IM" or "MI" for the order of bytes, then data elements, each a tag of type and size and its bytes).
// Throws BadData with the byte at which an element begins that does not end within the file, is of no known kind, or
// holds an array that says it has more than its bytes can hold.
std::size_t count_mat5_elements(std::string_view file, const std::string& source);

// The same for level 4 (chapter 1 of the same: matrices one after the other, each a head of five integers, a name and
// numbers).
std::size_t count_mat4_matrices(std::string_view file, const std::string& source);

}  // namespace touchstone::importing
