// Exact cases as files and as what renderers of tools are held against.
#pragma once

#include <filesystem>
#include <string_view>

#include "contacts/exact_cases.h"
#include "harness/tool/coupling.h"
#include "tool_errors.h"

namespace touchstone::contacts {

// The case with the wrench of its equilibrium at each handle (quasi_static.h), as a solid tool of usual density. Throws
// UsageError for a name that is not known or a shape that there is not, BadData for stiffnesses at which no equilibrium
// was found.
tool::KnownContacts known_contacts(std::string_view name, const tool::Coupling& coupling,
                                   const tool::ContactShape& shape = {});

// The cases that can be slid along x, and one of them slid so far to each handle with this friction in every contact
// (sliding_equilibrium()). known_slides() throws as known_contacts(), and UsageError for a case that cannot.
inline constexpr double slide_m = 0.015;
std::vector<std::string> sliding_case_names();
tool::KnownContacts known_slides(std::string_view name, const tool::Coupling& coupling, double mu);

// tool.obj, object.obj (in m) and path.csv (scripted_path.h, at 1 kHz) in a folder. Throws BadData if they cannot be
// written. Returns the samples of the path.
std::size_t write_exact_case(const ExactCase& exact_case, double duration_s, const std::filesystem::path& folder);

}  // namespace touchstone::contacts
