// The remedy of a misspelt name: the nearest one that exists.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dalembert::frontend {

// "did you mean 'l_knee'?" when one of the names is close (edit distance at most about a third of the name's length, and at
// least one edit allowed, names of at most 200 bytes); otherwise "one of a, b, c" for few names, and for many the first of them
// and how many more.
std::string suggestion(std::string_view name, const std::vector<std::string>& names);

}  // namespace dalembert::frontend
