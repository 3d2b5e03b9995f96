// The generic engine on the compiler's tree: what results ought to be, in several precisions.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert::reference {

// A quantity, or the body Jacobian (6 × nv) of a link when there is none.
struct Wanted {
  std::optional<ir::Quantity> quantity;
  std::string link;
};

enum class Precision { float32, float64, extended, digits_50 };  // extended: long double

// The results at the state (q: nq, v: nv, as `dalembert info` prints them), each rows × columns, computed in the precision and
// then rounded to double. Gravity is the scene's, whatever its kind; velocities count as zero where the scene says so.
std::vector<Eigen::MatrixXd> evaluate(const ir::KinematicTree& tree, const ir::Scene& scene, const std::vector<Wanted>& wanted,
                                      const Eigen::VectorXd& q, const Eigen::VectorXd& v, Precision precision);

// What a quantity's elements are to be measured against at least. Where a robot makes a quantity vanish (C of a turntable,
// gravity of whatever moves in a horizontal plane), its largest element is rounding noise of larger terms that cancel. So C
// counts as at least a thousandth of |M| |v|, gravity as a thousandth of what it is in other directions, and the bias as both.
class LeastScale {
 public:
  // At the state. Keeps references to all four.
  LeastScale(const ir::KinematicTree& tree, const ir::Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v)
      : tree_(tree), scene_(scene), q_(q), v_(v) {}

  double of(const Wanted& wanted);

 private:
  double largest_mass();
  double largest_gravity();  // over directions

  const ir::KinematicTree& tree_;
  const ir::Scene& scene_;
  const Eigen::VectorXd &q_, &v_;
  std::optional<double> mass_, gravity_;  // once computed
};

}  // namespace dalembert::reference
