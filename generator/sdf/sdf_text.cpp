#include "sdf/sdf_text.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "frontend/numbers.hpp"

namespace dalembert::frontend {

namespace {

constexpr std::array idle_elements{"visual",
                                   "collision",
                                   "sensor",
                                   "plugin",
                                   "light",
                                   "material",
                                   "projector",
                                   "particle_emitter",
                                   "battery",
                                   "audio_sink",
                                   "actor",
                                   "audio",
                                   "road",
                                   "gripper",
                                   "gui",
                                   "scene",
                                   "state",
                                   "population",
                                   "wind",
                                   "atmosphere",
                                   "physics",
                                   "magnetic_field",
                                   "spherical_coordinates",
                                   "audio_source"};

bool is_idle(std::string_view name) {
  return std::find(idle_elements.begin(), idle_elements.end(), name) != idle_elements.end();
}

constexpr size_t nowhere = std::string_view::npos;

// Behind the tag, comment or the like that begins at `at`; nowhere where the text ends in it.
size_t end_of_markup(std::string_view text, size_t at) {
  struct Section {
    std::string_view begin, end;
  };
  for (const Section& section : {Section{"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<?", "?>"}})
    if (text.substr(at).starts_with(section.begin)) {
      const size_t end = text.find(section.end, at + section.begin.size());
      return end == nowhere ? nowhere : end + section.end.size();
    }
  for (size_t i = at + 1; i < text.size(); ++i) {
    if (text[i] == '>') return i + 1;
    if (text[i] == '"' || text[i] == '\'') i = text.find(text[i], i + 1);
    if (i == nowhere) return nowhere;
  }
  return nowhere;
}

std::string_view name_in(std::string_view tag) {
  const size_t begin = tag[1] == '/' ? 2 : 1;
  return tag.substr(begin, tag.find_first_of(" \t\r\n/>", begin) - begin);
}

}  // namespace

SdfText without_idle_elements(const std::string& text, const std::function<std::string(const std::string& uri)>& found) {
  const std::string_view all = text;
  SdfText result;
  std::vector<std::string_view> open;  // elements, from the root on
  size_t idle = 0;                     // how many are open where an idle one begins; 0: outside of them
  size_t kept = 0, content = 0;        // what is before is in the result; behind the latest start tag
  const auto pass = [&](size_t begin, size_t end, std::string_view instead) {
    result.text.append(all, kept, begin - kept).append(instead);
    result.text.append(static_cast<size_t>(std::count(all.begin() + static_cast<std::ptrdiff_t>(begin),
                                                      all.begin() + static_cast<std::ptrdiff_t>(end), '\n')),
                       '\n');
    kept = end;
  };
  size_t begin_of_idle = 0;
  for (size_t at = all.find('<'); at != nowhere; at = all.find('<', at)) {
    const size_t end = end_of_markup(all, at);
    if (end == nowhere) return {text, result.root};
    const std::string_view tag = all.substr(at, end - at);
    if (tag[1] != '!' && tag[1] != '?') {
      const std::string_view name = name_in(tag);
      const bool closes = tag[1] == '/', is_empty = tag[tag.size() - 2] == '/';
      if (!closes) {
        if (result.root.empty()) result.root = name;
        open.push_back(name);
        content = end;
        if (idle == 0 && is_idle(name)) {
          idle = open.size();
          begin_of_idle = at;
        }
      } else if (open.empty() || open.back() != name) {
        return {text, result.root};
      } else if (idle == 0 && name == "uri" && open.size() > 1 && open[open.size() - 2] == "include") {
        if (const std::string other = found(std::string(trimmed(all.substr(content, at - content)))); !other.empty())
          pass(content, at, other);
      }
      if (closes || is_empty) {
        const size_t level = open.size();
        open.pop_back();
        if (idle == level) {
          pass(begin_of_idle, end, name == "plugin" && !open.empty() && open.back() == "model" ? "<dalembert:plugin/>" : "");
          idle = 0;
        }
      }
    }
    at = end;
  }
  if (!open.empty()) return {text, result.root};
  result.text.append(all, kept);
  return result;
}

}  // namespace dalembert::frontend
