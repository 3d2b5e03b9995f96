// A file as text, or a diagnostic that says why not.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <limits>
#include <string>

namespace dalembert::frontend {

// Throws InputError when the file is missing, a directory, cannot be read, or has more than `limit` bytes (a device may never
// end). `kind` names what was expected: "URDF".
std::string read_text_file(const std::string& path, const std::string& kind, size_t limit = std::numeric_limits<size_t>::max());

// The same of plain lines, from a file, or standard input where the path is "-". Stops as well at the first zero byte, which no
// such text has and a device may have nothing but.
std::string read_lines(const std::string& path, const std::string& kind, size_t limit);

}  // namespace dalembert::frontend
