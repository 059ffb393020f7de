// Text of others inside HTML and XML: what a device, a file or a user says must not become a tag.
#pragma once

#include <string>
#include <string_view>

namespace touchstone {

// Text that may stand between the tags of XML or in an attribute with double quotes: & < > " as entities. XML 1.0 has
// no control characters but tab and the ends of lines, and no bytes that are not UTF-8: the caller leaves those out.
std::string escape_xml(std::string_view text);

// The same for HTML, where an attribute may have single quotes, too.
std::string escape_html(std::string_view text);

}  // namespace touchstone
