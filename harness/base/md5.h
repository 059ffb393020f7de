// MD5, for protocols that ask for it (CDash's submissions); it says nothing about who made the bytes.
#pragma once

#include <string>
#include <string_view>

namespace touchstone {

// Lower-case hexadecimal. Throws BadData where libcrypto is not installed.
std::string md5(std::string_view text);

}  // namespace touchstone
