// SPDX-License-Identifier: Apache-2.0
// Messages quote names and bytes from outside; what is printed stays one printable line whatever they hold.
#pragma once

#include <iosfwd>
#include <string>
#include <string_view>

namespace farfield {

/// `text` with line ends, other control characters and bytes that are not UTF-8 as '?', and shortened in the middle to
/// about `most` bytes.
std::string one_line(std::string_view text, std::size_t most = 1000);

/// Prints "program: message" as one line.
void complain(std::ostream& talk, std::string_view program, std::string_view message);

}  // namespace farfield
