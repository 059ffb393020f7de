// The files that extras read and write: tables that they bring as share/touchstone/formats/NAME.json
// ("touchstone-formats/1"), with the fields of a FileFormat and its FormatFields (harness/base/file_format.h; "part" is
// a list of fields).
#pragma once

#include <vector>

#include "harness/base/file_format.h"

namespace touchstone::apps {

// Of all extras that came with the program. They live as long as it does. Throws BadData for a table that is wrong.
std::vector<const FileFormat*> extra_formats();

}  // namespace touchstone::apps
