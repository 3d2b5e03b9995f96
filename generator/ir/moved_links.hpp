// The bodies that users see, in the order of W's and the regressor's columns and of body_names: the base first when it floats.
// Of a joint of several coordinates the last body alone is one.
#pragma once

#include <string>
#include <vector>

#include "ir/kinematic_tree.hpp"

namespace dalembert::ir {

// Per body: its number among them; -1: it is none.
inline std::vector<int> numbers_of_links(const KinematicTree& tree) {
  if (tree.within) return tree.within->links;
  std::vector<int> numbers;
  int next = tree.base_coordinates() > 0 ? 1 : 0;
  for (const Body& body : tree.bodies) numbers.push_back(body.part + 1 == body.parts ? next++ : -1);
  return numbers;
}
// Their names.
inline std::vector<std::string> names_of_links(const KinematicTree& tree) {
  std::vector<std::string> names;
  if (tree.base_coordinates() > 0) names.push_back(tree.base_link);
  for (const Body& body : tree.bodies)
    if (body.part + 1 == body.parts) names.push_back(body.name);
  return names;
}
// How many they are.
inline int count_of_links(const KinematicTree& tree) {
  if (tree.within) return tree.within->count_of_links;
  int count = tree.base_coordinates() > 0 ? 1 : 0;
  for (const Body& body : tree.bodies) count += body.part + 1 == body.parts;
  return count;
}

}  // namespace dalembert::ir
