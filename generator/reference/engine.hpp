// The generic engine on the compiler's tree: what results ought to be, in several precisions.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ir/acting.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/loading.hpp"
#include "ir/part.hpp"
#include "ir/scene.hpp"

namespace dalembert::reference {

// A quantity, or one of a link when there is none.
struct Wanted {
  std::optional<ir::Quantity> quantity;
  std::string link;
  ir::LinkQuantity of_link = ir::LinkQuantity::jacobian;
  ir::Selection selection{};  // its rows and columns that are asked for
};

// What results depend on besides the robot and the scene.
struct Inputs {
  Eigen::VectorXd q, v;  // nq and nv, as `dalembert info` prints them
  Eigen::VectorXd
      more{};  // nv: what the function of the quantity takes besides (ir/function.hpp); empty where it takes nothing
  Eigen::VectorXd wrenches{};  // six numbers for each of the scene's; empty: all are zero
  ir::Acting acting{};         // of the scene's constraints
  ir::Loading loading{};       // of the scene's payloads, and gravity where it is given at run time
};

enum class Precision { float32, float64, extended, digits_50 };  // extended: long double

// The results, each rows × columns that are asked for, computed in the precision and then rounded to double. Gravity that
// the inputs do not give is the scene's, whatever its kind; velocities count as zero where the scene says so.
std::vector<Eigen::MatrixXd> evaluate(const ir::KinematicTree& tree, const ir::Scene& scene, const std::vector<Wanted>& wanted,
                                      const Inputs& inputs, Precision precision);

// The condition of M (the largest eigenvalue over the smallest): by how much solving with M may magnify rounding. Infinite
// where M is singular to double precision.
double mass_condition(const ir::KinematicTree& tree, const ir::Scene& scene, const Inputs& inputs);

// By how much rounding may be magnified in what is wanted: of what is solved for with M its condition, of what keeps to
// constraints that times the condition of the rows; where loops are embedded, by at least what their dependent joints are
// solved by; else zero.
double condition(const Wanted& wanted, const ir::KinematicTree& tree, const ir::Scene& scene, const Inputs& inputs);

// Whether it is a derivative with constraints of which more than rounding is lost: such a one is of the solution, and not of
// the proximal steps by which forces are found, and rows say so little that is new (next to mu of the most) that these neither
// find what it asks for nor give it up.
bool depends_on_steps(const Wanted& wanted, const ir::KinematicTree& tree, const ir::Scene& scene, const Inputs& inputs);

// What a quantity's elements are to be measured against at least. Where a robot makes a quantity vanish (C of a turntable,
// gravity of whatever moves in a horizontal plane), its largest element is rounding noise of larger terms that cancel. So every
// quantity counts as at least a thousandth of the scale in its row (ir::Scale).
class LeastScale {
 public:
  // Keeps references to all three.
  LeastScale(const ir::KinematicTree& tree, const ir::Scene& scene, const Inputs& inputs)
      : tree_(tree), scene_(scene), inputs_(inputs) {}

  double of(const Wanted& wanted);

 private:
  double largest_mass();
  double largest_weight(ir::Quantity quantity);  // over directions of gravity
  double largest_free(ir::Quantity quantity);    // of accelerations and velocities that contacts keep down
  double largest_of_loops();
  double largest_lever(ir::Quantity quantity);  // of constraints' points
  double largest_push();
  double largest_turned(ir::Quantity quantity);  // of what cancels in derivatives of v'

  const ir::KinematicTree& tree_;
  const ir::Scene& scene_;
  const Inputs& inputs_;
  std::optional<double> mass_;  // once computed
  std::map<ir::Quantity, double> weight_;
};

}  // namespace dalembert::reference
