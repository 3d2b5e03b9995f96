#include "frontend/scene_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <vector>

#include "diagnostics.hpp"
#include "frontend/scene_reader.hpp"
#include "frontend/text_encoding.hpp"
#include "frontend/yaml_text.hpp"
#include "ir/plan_words.hpp"

namespace dalembert::frontend {
namespace {

std::string entry(const std::string& function, const ir::FunctionPlan& plan) {
  std::string parts;
  const auto add = [&](const char* part, const std::string& word) {
    parts += fmt::format("{}{}: {}", parts.empty() ? "" : ", ", part, word);
  };
  if (plan.form) add("form", word_of(ir::form_words(), *plan.form));
  if (plan.solver) add("solver", word_of(ir::solver_words(), *plan.solver));
  if (plan.order) add("order", word_of(ir::order_words(), *plan.order));
  return fmt::format("{}: {{{}}}", function, parts);
}

// Before anything is measured there is nothing to paste.
[[noreturn]] void refuse(const std::string& file, const std::string& message, const ScenePlan& plan) {
  const bool measured =
      std::any_of(plan.begin(), plan.end(), [](const auto& f) { return f.second.form || f.second.solver || f.second.order; });
  throw InputError({Severity::error, file, "key 'plan'", message + ": the file is as it was",
                    measured ? "paste this into it yourself:\n" + plan_lines(plan)
                             : "write it so that a plan can stand in it, or give its keys as options instead of --scene"});
}

// Lines with their ends.
std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    lines.push_back(text.substr(at, end == text.npos ? text.npos : end + 1 - at));
    at += lines.back().size();
  }
  return lines;
}

// Nothing, or a comment that begins its line: what may stand behind a key's value and belong to the next one.
bool is_between_keys(const std::string& line) {
  const std::size_t first = line.find_first_not_of(" \t\r\n");
  return first == line.npos || line[0] == '#';
}

}  // namespace

std::string plan_setting(const ScenePlan& plan) {
  std::string entries;
  for (const auto& [function, how] : plan) entries += (entries.empty() ? "" : ", ") + entry(function, how);
  return "{" + entries + "}";
}

std::string plan_lines(const ScenePlan& plan, const std::string& end_of_line) {
  std::string text = "plan:" + end_of_line;
  for (const auto& [function, how] : plan) text += "  " + entry(function, how) + end_of_line;
  return text;
}

std::string with_plan(const std::string& file, const std::string& text, const ScenePlan& plan) {
  const std::string mark = text.starts_with("\xEF\xBB\xBF") ? text.substr(0, 3) : "";
  if (as_utf8(text) != text.substr(mark.size())) refuse(file, "the file is not UTF-8", plan);
  std::vector<std::string> lines = lines_of(text.substr(mark.size()));
  const std::string end_of_line = !lines.empty() && lines.front().ends_with("\r\n") ? "\r\n" : "\n";
  const std::string made = plan_lines(plan, end_of_line);
  std::optional<YamlNode> root;
  try {
    root = read_yaml(text.substr(mark.size()));
  } catch (const YamlError&) {
    refuse(file, "the file is not YAML", plan);
  }
  std::size_t begin = lines.size(), end = lines.size();
  if (root && root->is_map()) {
    for (std::size_t i = 0; i < root->entries.size(); ++i) {
      const YamlNode& key = root->entries[i].key;
      if (key.scalar != "plan") continue;
      begin = static_cast<std::size_t>(key.line - 1);
      if (i + 1 < root->entries.size()) end = static_cast<std::size_t>(root->entries[i + 1].key.line - 1);
      while (end > begin + 1 && is_between_keys(lines[end - 1])) --end;
    }
    for (const YamlEntry& entry : root->entries)
      if (entry.key.column != 1) refuse(file, "its keys do not each begin a line", plan);
  }
  std::string result = mark;
  for (std::size_t i = 0; i < begin; ++i) result += lines[i];
  if (begin == lines.size() && !lines.empty() && !lines.back().ends_with('\n')) result += end_of_line;
  result += made;
  for (std::size_t i = end; i < lines.size(); ++i) result += lines[i];
  // What stands in a YAML file may mean anything: what was written is what is read.
  try {
    const SceneDocument before = read_scene_text(file, text, {}), after = read_scene_text(file, result, {});
    std::set<std::string> keys = before.given;
    keys.insert("plan");
    if (plan_setting(after.scene.plan) == plan_setting(plan) && after.given == keys) return result;
  } catch (const InputError&) {
  }
  refuse(file, "a plan cannot be put into the file as it is written", plan);
}

}  // namespace dalembert::frontend
