// Parts of results: rows and columns of some joints, columns of some links. What is not asked for is not computed, not stored.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ir/quantity.hpp"

namespace dalembert::ir {

struct KinematicTree;

// What is asked of a result, as a scene says it, and which coordinates and links of a tree that is (passes/resolve_parts.hpp).
struct Part {
  std::vector<std::string> joints;    // names, or patterns: * for any letters, ? for one
  std::vector<std::string> subtrees;  // links: the joints that move them, and all joints beyond
  std::optional<bool> base;           // its own six
  std::vector<std::string> links;     // whose columns are asked for, where columns are links'

  bool some_coordinates = false;
  std::vector<int> coordinates{};  // of v, ascending
  bool some_links = false;
  std::vector<int> bodies{};  // numbers among those that users see (ir/moved_links.hpp), ascending

  bool names_joints() const { return !joints.empty() || !subtrees.empty() || base; }
};

// Whether the name is the pattern's: * stands for any letters, ? for one.
bool matches(std::string_view pattern, std::string_view name);
bool is_pattern(std::string_view text);

// Whether parts of it can be asked for: rows and columns of joints, columns of links.
struct Parts {
  bool of_joints, of_links;
};
Parts parts_of(Quantity quantity);
bool has_parts(Extent rows, Extent columns);  // of a link's quantity, of joints

// Along one side of a result: which rows, or columns, of the whole are asked for; nothing where all are.
std::optional<std::vector<int>> chosen(const Part* part, Extent extent);

// The rows and columns of a whole result that were asked for.
struct Selection {
  std::optional<std::vector<int>> rows, columns;

  bool whole() const { return !rows && !columns; }
  Eigen::MatrixXd of(const Eigen::MatrixXd& result) const;
};
Selection selection(const Part* part, Extent rows, Extent columns);

// How many rows or columns it has; part: null, all.
int extent(Extent extent, const KinematicTree& tree, const Part* part);

// Where the rows, or columns, of the whole stand in the part; -1: not asked for. Empty where all are.
std::vector<int> map_of(const Part* part, Extent extent, const KinematicTree& tree);

// "rows and columns: left_hip_yaw to left_knee", of a part; empty: all.
std::string in_words(const Part& part, Extent rows, Extent columns, const KinematicTree& tree);

}  // namespace dalembert::ir
