// A format as JSON Schema, draft 2020-12 (https://json-schema.org/draft/2020-12/json-schema-core), for editors that
// complete and check a file while it is written, and for programs that read one.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>

#include "harness/base/file_format.h"

namespace touchstone {

// Documents of other formats within it, of `known`, are among its definitions. What differences_from() has a line for
// does not validate, and the other way round. Throws UsageError for a format that is a table, not JSON.
[[nodiscard]] nlohmann::json json_schema_of(const FileFormat& format, std::span<const FileFormat> known);

}  // namespace touchstone
