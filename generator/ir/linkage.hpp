// Local linkages whose loops the scene embeds: dependent joints follow independent ones (dalembert/linkage.hpp).
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <dalembert/linkage.hpp>
#include <string>
#include <vector>

#include "ir/linkage_rows.hpp"

namespace dalembert::ir {

struct KinematicTree;

// A dependent joint costs the cube of their number: what is solved for at once is small.
inline constexpr int most_dependent_joints = 24, most_independent_joints = 24;

// A loop on the tree: the joints from the body that both links hang on to each.
struct LinkageLoop {
  std::string name;
  std::array<std::vector<int>, 2> joints;   // bodies, the upper ones first
  std::array<Eigen::Isometry3d, 2> frames;  // on the last of them, or on what both hang on
  std::vector<int> linear, angular;         // axes
  double length = 0;                        // of a distance, m

  int rows() const { return length > 0 ? 1 : static_cast<int>(linear.size() + angular.size()); }
};

// Loops that share dependent joints, which are as many as their rows.
struct Linkage {
  std::vector<LinkageLoop> loops;
  std::vector<int> dependent, independent;  // bodies
};

// Where a linkage's dependent joints are in q, and its independent ones in v.
struct LinkagePlaces {
  std::vector<int> positions, followed;
};
LinkagePlaces linkage_places(const Linkage& linkage, const KinematicTree& tree);

// Its rows as dalembert/linkage.hpp takes them, for any robot: expressions are evaluated as they are asked for.
class EvaluatedRows {
 public:
  static constexpr int most_dependent = most_dependent_joints, most_columns = most_dependent_joints + most_independent_joints;
  int dependent, independent;
  std::vector<int> positions, followed;

  EvaluatedRows(const Linkage& linkage, const KinematicTree& tree);
  void at(const double* q, double (&error)[most_dependent], double (&J)[most_dependent][most_columns]);
  void rates(const double* q, const double* rate, double (&J_rate)[most_dependent][most_columns]);

 private:
  void evaluate(const double* q, const double* rate);
  void fill(const std::vector<std::vector<NodeId>>& matrix, double (&to)[most_dependent][most_columns]) const;

  LinkageRows rows_;
  std::vector<double> values_;
};

// T as a list of its elements (dalembert/linkage.hpp): per coordinate of v, which it is where no loop is embedded; who follows.
struct Followers {
  int all = 0;  // coordinates where no loop is embedded
  std::vector<int> at;
  std::vector<Follower> elements;  // linkage by linkage, dependent joint by dependent joint
};
Followers followers(const KinematicTree& tree);

// Closes all loops from where q is: dependent positions change. What is left of them, and where the least pivot is.
LinkageStatus<double> close_loops(const KinematicTree& tree, int steps, Eigen::VectorXd& q);

// Positions of all joints of linkages at which loops are closed, from where they are in q or else drawn at random, always the
// same; off toggle points by a pivot of at least `least_pivot`. Others are left as they are. Where none was found q is the
// last.
struct ClosedState {
  bool closed = false;
  double least_error = 0, most_regular = 0;  // the least error and the largest pivot that were met
};
inline constexpr double well_off_toggle_points = 0.02;
ClosedState draw_closed(const KinematicTree& tree, Eigen::VectorXd& q, int tries, double least_pivot, bool from_q);

// As many steps of Newton's as generated code takes.
inline constexpr int closing_steps = 8;

}  // namespace dalembert::ir
