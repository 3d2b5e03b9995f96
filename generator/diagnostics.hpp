// Diagnostics: what went wrong with the user's input, where, and what to do about it.
//
// Everything the compiler has to say about its input travels as a value. Warnings, and notices of what was taken where nobody
// said, are collected and printed by the command; errors are thrown as InputError, which carries every diagnostic found so far,
// and end the command with exit status 2 before any file is written.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace dalembert {

enum class Severity { notice, warning, error };

struct Diagnostic {
  Severity severity = Severity::error;
  std::string file;       // the file as the user named it; empty when the command line is at fault
  std::string element;    // the user's element, such as "joint 'l_knee'" or "line 3, column 5: key 'bas'"
  std::string message;    // what is wrong with it
  std::string remedy;     // what to do about it
  std::string kind = {};  // what it has in common with others that are told as one; empty: the message
};

// `file: element: severity: message; remedy`, one line, without the final newline. Control characters, which a terminal would
// obey, are written as \\x1b.
std::string to_string(const Diagnostic& diagnostic);

using Diagnostics = std::vector<Diagnostic>;

// Of each how many warnings of its kind there are in its file: at the first of them, and 0 at the others; of what is no warning
// 1.
std::vector<int> alike(const Diagnostics& diagnostics);

// One line each, as they come. Of warnings of one kind in one file only the first, with their number; all of them when
// `verbose`. Errors and notices are never left out.
std::vector<std::string> lines(const Diagnostics& diagnostics, bool verbose);

// Writes to stderr. What cannot be written there is lost: nobody is left to be told.
void tell(std::string_view text);

// Bad input or usage: exit status 2. Holds at least one diagnostic of severity error (and any warnings met before it).
class InputError : public std::runtime_error {
 public:
  explicit InputError(Diagnostic diagnostic);
  explicit InputError(Diagnostics diagnostics);
  const Diagnostics& diagnostics() const { return diagnostics_; }

 private:
  Diagnostics diagnostics_;
};

// Appends the error. The hundredth is the last: throws InputError with all of them, so that a file in ruins is refused without
// looking for the remedy of each.
void add_error(Diagnostics& errors, Diagnostic error);

}  // namespace dalembert
