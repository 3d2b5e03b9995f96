#include "commands/report/page.hpp"

#include <stdexcept>

#include "commands/json.hpp"

namespace dalembert::reporting {
namespace {

// In a text node or an attribute.
std::string escaped(const std::string& text) {
  std::string html;
  for (char c : text) {
    if (c == '&') html += "&amp;";
    else if (c == '<') html += "&lt;";
    else if (c == '"') html += "&quot;";
    else html += c;
  }
  return html;
}

// As a string of the script language; no '<', so that nothing in it ends the element it stands in.
std::string script_string(const std::string& text) {
  std::string script;
  for (char c : json_string(text)) script += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return script;
}

// The first @key@ becomes the text.
void fill(std::string& html, std::string_view key, std::string_view text) {
  const std::string mark = "@" + std::string(key) + "@";
  const size_t at = html.find(mark);
  if (at == html.npos) throw std::logic_error("the page has no " + mark);
  html.replace(at, mark.size(), text);
}

}  // namespace

std::string page(const std::string& robot, const std::string& csv) {
  std::string html(page_frame());
  // What the user named comes last: a mark in it stays what it is.
  fill(html, "style", page_style());
  fill(html, "library", plot_library());
  fill(html, "script", page_script());
  fill(html, "rows", script_string(csv));
  fill(html, "title", escaped(robot));
  return html;
}

}  // namespace dalembert::reporting
