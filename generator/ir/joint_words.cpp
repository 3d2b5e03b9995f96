#include "ir/joint_words.hpp"

#include <algorithm>

namespace dalembert::ir {
namespace {

// Neighbours of three and more by the first and the last.
std::vector<std::string> runs(const std::vector<bool>& wanted, const std::vector<std::string>& names) {
  std::vector<std::string> parts;
  for (size_t i = 0; i < names.size();) {
    size_t end = i;
    while (end < names.size() && wanted[end]) ++end;
    if (end - i > 2) parts.push_back(names[i] + " to " + names[end - 1]);
    else
      for (size_t k = i; k < end; ++k) parts.push_back(names[k]);
    i = end + 1;
  }
  return parts;
}

std::string listed(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

}  // namespace

std::vector<int> coordinates_at(const std::vector<int>& positions, const KinematicTree& tree) {
  if (!tree.any_quaternion()) return positions;
  const std::vector<int> first = tree.positions();
  std::vector<int> coordinates;
  int coordinate = 0;
  for (size_t k = 0; k < tree.bodies.size(); ++k) {
    const Body& body = tree.bodies[k];
    if (body.driven()) continue;
    const int count = body.of_quaternion() ? positions_of(body.kind) : 1;
    bool all = true;
    for (int i = first[k]; i < first[k] + count; ++i)
      all = all && std::find(positions.begin(), positions.end(), i) != positions.end();
    if (all) coordinates.push_back(coordinate);
    ++coordinate;
  }
  return coordinates;
}

std::string joints_in_words(const std::vector<int>& numbers, const KinematicTree& tree) {
  std::vector<std::string> names;
  for (const Body& body : tree.bodies)
    if (body.independent()) names.push_back(body.joint);
  std::vector<bool> wanted(names.size(), false), others(names.size(), true);
  for (const int i : numbers) {
    wanted[static_cast<size_t>(i)] = true;
    others[static_cast<size_t>(i)] = false;
  }
  const std::vector<std::string> these = runs(wanted, names), those = runs(others, names);
  if (those.empty()) return "all joints";
  // The few are named, unless they lie scattered.
  const bool most = 2 * numbers.size() > names.size();
  return most && those.size() <= these.size() + 2 ? "all joints but " + listed(those) : listed(these);
}

}  // namespace dalembert::ir
