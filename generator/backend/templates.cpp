#include "backend/templates.hpp"

#include <set>
#include <stdexcept>

namespace dalembert::backend {

std::string render(std::string_view name, const Fields& fields) {
  const auto skeleton = embedded_templates.find(name);
  if (skeleton == embedded_templates.end()) throw std::logic_error("no template " + std::string(name));
  const std::string_view text = skeleton->second;
  std::string out;
  std::set<std::string_view> used;
  size_t at = 0;
  while (true) {
    const size_t open = text.find("${", at);
    if (open == std::string_view::npos) break;
    const size_t close = text.find('}', open);
    if (close == std::string_view::npos) throw std::logic_error("template " + std::string(name) + ": ${ without }");
    const std::string_view key = text.substr(open + 2, close - open - 2);
    const auto field = fields.find(key);
    if (field == fields.end()) throw std::logic_error("template " + std::string(name) + ": no value for " + std::string(key));
    used.insert(field->first);
    out += text.substr(at, open - at);
    out += field->second;
    at = close + 1;
    const bool alone = (open == 0 || text[open - 1] == '\n') && at < text.size() && text[at] == '\n';
    if (alone && (field->second.empty() || field->second.back() == '\n')) ++at;
  }
  out += text.substr(at);
  for (const auto& [key, value] : fields)
    if (!used.contains(key)) throw std::logic_error("template " + std::string(name) + ": unused key " + key);
  return out;
}

}  // namespace dalembert::backend
