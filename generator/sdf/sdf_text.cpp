#include "sdf/sdf_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "frontend/numbers.hpp"
#include "frontend/text_encoding.hpp"

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

// Of those that libsdformat knows.
constexpr std::array<std::string_view, 9> joint_types{"ball",     "continuous", "fixed", "gearbox",  "prismatic",
                                                      "revolute", "revolute2",  "screw", "universal"};
bool is_joint_type(std::string_view type) {  // in capitals too
  std::string lower(trimmed(type));
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return std::find(joint_types.begin(), joint_types.end(), lower) != joint_types.end();
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

// The value of a tag's attribute; empty where it has none.
std::string_view attribute(std::string_view tag, std::string_view name) {
  constexpr std::string_view blanks = " \t\r\n";
  for (size_t at = tag.find(name); at != nowhere; at = tag.find(name, at + 1)) {
    if (at == 0 || blanks.find(tag[at - 1]) == nowhere) continue;
    const size_t equals = tag.find_first_not_of(blanks, at + name.size());
    if (equals == nowhere || tag[equals] != '=') continue;
    const size_t quote = tag.find_first_not_of(blanks, equals + 1);
    if (quote == nowhere || (tag[quote] != '"' && tag[quote] != '\'')) continue;
    return tag.substr(quote + 1, tag.find(tag[quote], quote + 1) - quote - 1);
  }
  return {};
}

// Elements whose text is numbers, by what they stand in. Those of <inertial> and of gearboxes are read by themselves.
struct Numbers {
  std::string_view within, name;
  size_t count;
  bool may_be_infinite = false;
};
constexpr std::array all_numbers{Numbers{"model", "pose", 6},
                                 Numbers{"link", "pose", 6},
                                 Numbers{"joint", "pose", 6},
                                 Numbers{"frame", "pose", 6},
                                 Numbers{"inertial", "pose", 6},
                                 Numbers{"include", "pose", 6},
                                 Numbers{"axis", "xyz", 3},
                                 Numbers{"axis2", "xyz", 3},
                                 Numbers{"dynamics", "damping", 1},
                                 Numbers{"dynamics", "friction", 1},
                                 Numbers{"dynamics", "spring_reference", 1},
                                 Numbers{"dynamics", "spring_stiffness", 1},
                                 Numbers{"limit", "lower", 1, true},
                                 Numbers{"limit", "upper", 1, true},
                                 Numbers{"limit", "effort", 1, true},
                                 Numbers{"limit", "velocity", 1, true},
                                 Numbers{"joint", "thread_pitch", 1},
                                 Numbers{"joint", "screw_thread_pitch", 1},
                                 Numbers{"world", "gravity", 3}};

const Numbers* numbers_of(std::string_view within, std::string_view name) {
  const auto* const found = std::find_if(all_numbers.begin(), all_numbers.end(), [&](const Numbers& numbers) {
    return numbers.name == name && numbers.within == within;
  });
  return found == all_numbers.end() ? nullptr : found;
}

// What stands between & and ; as the character it is for: false where there is no such.
bool append_referred(std::string& plain, std::string_view name) {
  using Entity = std::pair<std::string_view, char>;
  for (const auto& [entity, is] : {Entity{"amp", '&'}, {"lt", '<'}, {"gt", '>'}, {"quot", '"'}, {"apos", '\''}})
    if (name == entity) return plain += is, true;
  if (!name.starts_with('#')) return false;
  const bool hexadecimal = name.starts_with("#x");
  name.remove_prefix(hexadecimal ? 2 : 1);
  std::uint32_t code = 0;
  const auto read = std::from_chars(name.data(), name.data() + name.size(), code, hexadecimal ? 16 : 10);
  if (name.empty() || read.ec != std::errc() || read.ptr != name.data() + name.size() || code == 0 || code > 0x10ffff)
    return false;
  append_utf8(plain, code);
  return true;
}

// Text as a parser of XML has it: without comments, CDATA as it is, references decoded. Nothing where it is not well-formed.
std::optional<std::string> plain_text(std::string_view text) {
  std::string plain;
  while (!text.empty()) {
    const size_t begin = std::min(text.find_first_of("<&"), text.size());
    plain.append(text, 0, begin);
    text.remove_prefix(begin);
    if (text.starts_with('&')) {
      const size_t end = text.find(';');
      if (end == nowhere || !append_referred(plain, text.substr(1, end - 1))) return {};
      text.remove_prefix(end + 1);
      continue;
    }
    constexpr std::string_view cdata = "<![CDATA[";
    if (text.empty()) break;
    const size_t end = end_of_markup(text, 0);
    if (end == nowhere) return {};
    if (text.starts_with(cdata)) plain.append(text, cdata.size(), end - cdata.size() - 3);
    text.remove_prefix(end);
  }
  return plain;
}

// What is to stand instead of an element's text; nothing: it may stay. `remark` tells what is wrong with it.
std::optional<std::string> corrected(const Numbers& numbers, std::string_view tag, std::string_view text,
                                     const std::function<void(Severity, std::string what, std::string remedy)>& remark) {
  const bool quaternion = numbers.name == "pose" && attribute(tag, "rotation_format") == "quat_xyzw";
  const size_t count = numbers.count + (quaternion ? 1 : 0);
  const std::string element = fmt::format("<{0}>{1}</{0}>", numbers.name, trimmed(text));
  std::optional<std::vector<double>> all = parse_numbers(text);
  const auto is_usable = [&](double number) {
    return std::isfinite(number) || (numbers.may_be_infinite && !std::isnan(number));
  };
  if (all && all->empty() && numbers.name == "pose") return {};  // zeros, as SDF has it
  if (!all || all->size() != count || !std::all_of(all->begin(), all->end(), is_usable)) {
    const char* const finite = numbers.may_be_infinite ? "" : "finite ";
    remark(Severity::error,
           count == 1 ? fmt::format("{} is not a {}number", element, finite)
                      : fmt::format("{} is not {} {}numbers", element, count, finite),
           count == 1 ? "write a decimal number" : "write decimal numbers, with blanks between them");
    return {};
  }
  if (numbers.name == "xyz" && std::all_of(all->begin(), all->end(), [](double number) { return number == 0; }))
    remark(Severity::error, element + " is no direction", "write the axis, such as 0 0 1");
  if (!quaternion) return {};
  const double length = std::hypot(std::hypot((*all)[3], (*all)[4]), std::hypot((*all)[5], (*all)[6]));
  if (length == 0 || !std::isfinite(length)) {
    remark(Severity::error, element + ": its quaternion is none", "write x y z and then qx qy qz qw, of length 1");
    return {};
  }
  constexpr double rounding_in_files = 0.01;
  if (std::abs(length - 1) > rounding_in_files)
    remark(Severity::warning,
           fmt::format("{}: its quaternion has the length {:.6g} and is taken as of length 1", element, length),
           "write x y z and then qx qy qz qw, of length 1");
  std::for_each(all->begin() + 3, all->end(), [&](double& number) { number /= length; });
  std::vector<std::string> words;
  std::transform(all->begin(), all->end(), std::back_inserter(words),
                 [](double number) { return fmt::format("{:.17g}", number); });
  return fmt::format("{}", fmt::join(words, " "));
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
  std::string_view start;              // that tag
  const auto pass = [&](size_t begin, size_t end, std::string_view instead) {
    result.text.append(all, kept, begin - kept).append(instead);
    result.text.append(static_cast<size_t>(std::count(all.begin() + static_cast<std::ptrdiff_t>(begin),
                                                      all.begin() + static_cast<std::ptrdiff_t>(end), '\n')),
                       '\n');
    kept = end;
  };
  size_t begin_of_idle = 0;
  std::string_view tag_of_idle;
  const auto remark_at = [&](size_t at, Severity severity, std::string what, std::string remedy) {
    const auto line = 1 + std::count(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    (severity == Severity::error ? result.errors : result.warnings)
        .push_back({severity, "", fmt::format("line {}", line), std::move(what), std::move(remedy)});
  };
  const auto fault = [&](size_t at, std::string what, std::string remedy) {
    remark_at(at, Severity::error, std::move(what), std::move(remedy));
  };
  // A file of nothing but a light, such as model://sun, has to have one where it is included.
  const auto instead_of_idle = [&](std::string_view name) -> std::string {
    if (open.empty()) return "";
    if (name == "plugin" && open.back() == "model") return "<dalembert:plugin/>";
    if (name != "light" || open.back() != "sdf" || open.size() > 1) return "";
    return fmt::format("<light name='{}' type='point'/>", attribute(tag_of_idle, "name"));
  };
  const auto check_version = [&](size_t at, std::string_view version) {
    constexpr std::string_view versions[] = {"1.0", "1.2", "1.3", "1.4",  "1.5",  "1.6",
                                             "1.7", "1.8", "1.9", "1.10", "1.11", "1.12"};
    if (std::find(std::begin(versions), std::end(versions), version) != std::end(versions)) return;
    fault(at, version.empty() ? "<sdf> has no version" : fmt::format("<sdf version=\"{}\"> is no version", version),
          "write one, such as version=\"1.9\"");
  };
  // Of whom nobody knows what numbers within mean: elements of other namespaces.
  const auto is_foreign = [](std::string_view name) { return name.find(':') != nowhere; };
  for (size_t at = all.find('<'); at != nowhere; at = all.find('<', at)) {
    const size_t end = end_of_markup(all, at);
    if (end == nowhere) return {text, result.root, result.errors, result.warnings};
    const std::string_view tag = all.substr(at, end - at);
    if (tag[1] != '!' && tag[1] != '?') {
      const std::string_view name = name_in(tag);
      const bool closes = tag[1] == '/', is_empty = tag[tag.size() - 2] == '/';
      if (!closes) {
        if (result.root.empty()) result.root = name;
        else if (open.empty()) fault(at, fmt::format("a second <{}> stands behind the first", name), "keep one of them");
        if (open.empty() && name == "sdf") check_version(at, attribute(tag, "version"));
        if (idle == 0 && name == "joint" && !open.empty() && open.back() == "model" && !is_joint_type(attribute(tag, "type")))
          fault(at,
                fmt::format("joint '{}' has the type '{}', which there is not", attribute(tag, "name"), attribute(tag, "type")),
                fmt::format("choose from {}", fmt::join(joint_types, ", ")));
        open.push_back(name);
        content = end, start = tag;
        if (idle == 0 && is_idle(name)) {
          idle = open.size();
          begin_of_idle = at, tag_of_idle = tag;
        }
      } else if (open.empty() || open.back() != name) {
        return {text, result.root, result.errors, result.warnings};
      } else if (idle == 0 && name == "uri" && open.size() > 1 && open[open.size() - 2] == "include") {
        const std::optional<std::string> uri = plain_text(all.substr(content, at - content));
        if (const std::string other = uri ? found(std::string(trimmed(*uri))) : ""; !other.empty())
          pass(content, at, "<![CDATA[" + other + "]]>");
      } else if (const Numbers* const numbers =
                     idle == 0 && open.size() > 1 && std::none_of(open.begin(), open.end(), is_foreign)
                         ? numbers_of(open[open.size() - 2], name)
                         : nullptr) {
        const std::string_view numerals = all.substr(content, at - content);
        const auto remark = [&](Severity severity, std::string what, std::string remedy) {
          remark_at(content, severity, std::move(what), std::move(remedy));
        };
        if (const auto plain = plain_text(numerals)) {
          const auto instead = corrected(*numbers, start, *plain, remark);
          std::string written = instead ? *instead : *plain;
          std::replace(written.begin(), written.end(), '\n', ' ');  // lines are counted by what it stands for
          if (instead || *plain != numerals) pass(content, at, written);
        }
      }
      if (const bool blank = is_empty || (closes && trimmed(all.substr(content, at - content)).empty());
          blank && idle == 0 && open.size() > 1) {
        const std::string_view within = open[open.size() - 2];
        if (within == "inertial" && name == "mass") fault(at, "<mass> has no number", "write its mass in kg");
        if (within == "include" && name == "uri") fault(at, "<include> has no <uri>", "write the model's, such as model://arm");
      }
      if (closes || is_empty) {
        const size_t level = open.size();
        open.pop_back();
        if (idle == level) {
          pass(begin_of_idle, end, instead_of_idle(name));
          idle = 0;
        }
      }
    }
    at = end;
  }
  if (!open.empty()) return {text, result.root, result.errors, result.warnings};
  result.text.append(all, kept);
  return result;
}

}  // namespace dalembert::frontend
