// The remedy of a misspelt name: the nearest one that exists.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dalembert::frontend {

// "did you mean 'l_knee'?" when one of the names is close, "did you mean 'left_foot' or 'right_foot'?" when up to three are
// equally close; otherwise "choose from a, b, c" for few names, and for many the first of them and how many more. Close is, the
// closest first: what differs in case and separators alone; what has the same parts in another order ("foot_left"), or a first
// letter in a part's place ("lfoot", "l_foot"); an edit distance of at most about a third of the name's length, and at least
// one edit; what begins or ends with the name or it with that ("foot", "left_foot_link"); what has all of the name's parts, or
// most letters of them. Names of more than 200 bytes are not compared. `also`: names that may be meant, but that a list to
// choose from need not have.
std::string suggestion(std::string_view name, const std::vector<std::string>& names, const std::vector<std::string>& also = {});

}  // namespace dalembert::frontend
