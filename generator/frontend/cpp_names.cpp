#include "frontend/cpp_names.hpp"

#include <fmt/format.h>

#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "ir/identifier.hpp"
#include "ir/library_names.hpp"

namespace dalembert::frontend {

namespace {

// What is wrong with an identifier by itself; empty when nothing is.
std::string reserved(const std::string& identifier, bool is_joint) {
  if (ir::is_cpp_keyword(identifier)) return "the name is a keyword of C++";
  // Enumerators bear joints' names bare.
  if (is_joint && ir::is_library_macro(identifier)) return "the name is a macro of the C++ library";
  if (is_joint && ir::is_macro_of_the_code(identifier)) return "the name could be a macro of the generated code";
  return "";
}

// Old names to new ones, of those that change.
template <class Outline>
std::unordered_map<std::string, std::string> rename(const std::string& file, std::vector<Outline>& elements, bool are_joints,
                                                    Diagnostics& warnings) {
  std::unordered_set<std::string> names;
  for (const Outline& element : elements) names.insert(ir::identifier(element.name));
  std::unordered_map<std::string, std::string> taken, renamed;  // identifier → place; name → name
  std::unordered_map<std::string, int> tried;                   // identifier → endings, so that none is tried twice
  for (Outline& element : elements) {
    const std::string identifier = ir::identifier(element.name);
    std::string fault = reserved(identifier, are_joints);
    if (const auto first = taken.find(identifier); fault.empty() && first != taken.end())
      fault = fmt::format("the name becomes '{}' in C++, as does that of {}", identifier, first->second);
    if (fault.empty()) {
      taken.emplace(identifier, place(element));
      continue;
    }
    const std::string was = place(element), old = element.name;
    // Where all names that begin so are reserved, no ending helps.
    const bool by_beginning = !reserved(ir::identifier(old + '_'), are_joints).empty();
    const std::string stem = by_beginning ? "joint_" + old : old;
    int& ending = tried[identifier];
    do element.name = ++ending > 1 ? fmt::format("{}_{}", stem, ending) : by_beginning ? stem : stem + '_';
    while (names.count(ir::identifier(element.name)) || !reserved(ir::identifier(element.name), are_joints).empty());
    names.insert(ir::identifier(element.name));
    renamed.emplace(old, element.name);
    warnings.push_back({Severity::warning, file, was, fault, fmt::format("it is called '{}' here", element.name)});
  }
  return renamed;
}

void replace(std::string& name, const std::unordered_map<std::string, std::string>& renamed) {
  if (const auto found = renamed.find(name); found != renamed.end()) name = found->second;
}

}  // namespace

void make_names_distinct(const std::string& file, UrdfOutline& outline, Diagnostics& warnings) {
  const auto links = rename(file, outline.links, false, warnings);
  const auto joints = rename(file, outline.joints, true, warnings);
  for (JointOutline& joint : outline.joints) {
    replace(joint.parent, links);
    replace(joint.child, links);
    if (joint.mimic) replace(joint.mimic->of, joints);
  }
  for (ir::Loop& loop : outline.loops)
    for (std::string& link : loop.links) replace(link, links);
}

}  // namespace dalembert::frontend
