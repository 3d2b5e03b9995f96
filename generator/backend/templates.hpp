// Skeletons of emitted files with `${key}` and nothing else to fill in.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace dalembert::backend {

using Fields = std::map<std::string, std::string, std::less<>>;

// The text of templates/<name> with every ${key} replaced. A key that the template has and `fields` has not, or the other way
// round, is a mistake of ours and throws std::logic_error naming it. A line that holds one key alone and gets an empty text
// disappears.
std::string render(std::string_view name, const Fields& fields);

// Defined by the build from the files of templates/.
extern const std::map<std::string_view, std::string_view> embedded_templates;

}  // namespace dalembert::backend
