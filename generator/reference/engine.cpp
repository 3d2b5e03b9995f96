#include "reference/engine.hpp"

#include <algorithm>
#include <cmath>
#include <dalembert/constraint_shapes.hpp>
#include <limits>

#include "ir/constraint_paths.hpp"
#include "reference/digits50.hpp"
#include "reference/eigenvalues.hpp"
#include "reference/loading.hpp"

namespace dalembert::reference {

// Instantiated in evaluate_*.cpp.
template <class S>
std::vector<Eigen::MatrixXd> evaluate_in(const ir::KinematicTree& tree, const ir::Scene& scene,
                                         const std::vector<Wanted>& wanted, const Inputs& inputs);

namespace {
std::vector<Eigen::MatrixXd> evaluate_whole(const ir::KinematicTree& tree, const ir::Scene& scene,
                                            const std::vector<Wanted>& wanted, const Inputs& inputs, Precision precision);
}  // namespace

std::vector<Eigen::MatrixXd> evaluate(const ir::KinematicTree& tree, const ir::Scene& scene, const std::vector<Wanted>& wanted,
                                      const Inputs& inputs, Precision precision) {
  if (!inputs.loading.empty()) {
    ir::KinematicTree loaded = tree;
    ir::Scene own = scene;
    load(inputs.loading, loaded, own);
    Inputs others = inputs;
    others.loading = {};
    return evaluate(loaded, own, wanted, others, precision);
  }
  std::vector<Eigen::MatrixXd> results = evaluate_whole(tree, scene, wanted, inputs, precision);
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (!wanted[i].selection.whole()) results[i] = wanted[i].selection.of(results[i]);
  return results;
}

namespace {

std::vector<Eigen::MatrixXd> evaluate_whole(const ir::KinematicTree& tree, const ir::Scene& scene,
                                            const std::vector<Wanted>& wanted, const Inputs& inputs, Precision precision) {
  switch (precision) {
    case Precision::float32: return evaluate_in<float>(tree, scene, wanted, inputs);
    case Precision::float64: return evaluate_in<double>(tree, scene, wanted, inputs);
    case Precision::extended: return evaluate_in<long double>(tree, scene, wanted, inputs);
    case Precision::digits_50: return evaluate_in<Digits50>(tree, scene, wanted, inputs);
  }
  return {};
}

}  // namespace

double mass_condition(const ir::KinematicTree& tree, const ir::Scene& scene, const Inputs& inputs) {
  const Eigen::MatrixXd M = evaluate(tree, scene, {{ir::Quantity::mass_matrix, ""}}, inputs, Precision::float64).front();
  const Eigen::VectorXd values = eigenvalues(M);
  const double least = values.minCoeff(), largest = values.maxCoeff();
  return least > 0 ? largest / least : std::numeric_limits<double>::infinity();
}

namespace {

// The eigenvalues of a symmetric matrix whose diagonal is made ones, so that units do not count; by the largest.
Eigen::VectorXd relative_eigenvalues(Eigen::MatrixXd D) {
  for (Eigen::Index i = 0; i < D.rows(); ++i) {
    const double length = std::sqrt(D(i, i));
    if (!(length > 0)) continue;
    D.row(i) /= length;
    D.col(i) /= length;
  }
  Eigen::VectorXd values = eigenvalues(D);
  if (const double largest = values.maxCoeff(); largest > 0) values /= largest;
  return values;
}

// To a proximal step an eigenvalue of up to so many mu is none.
constexpr double given_up = 100;

// The largest of them by the least; where that is none, what is lost there, once or several times.
double symmetric_condition(const Eigen::MatrixXd& D, int times = 1) {
  const double least = relative_eigenvalues(D).minCoeff(), mu = Proximal<double>::mu;
  return least <= given_up * mu ? std::pow(16 / mu, times) : 1 / least;
}

// Of what constraints can do for coordinates without a motor.
double support_condition(const ir::KinematicTree& tree, const ir::Scene& scene, const Inputs& inputs) {
  const std::vector<int> undriven = ir::undriven_coordinates(tree, scene);
  if (undriven.empty()) return 0;
  // Elements that are rounding are none.
  Eigen::MatrixXd J = evaluate(tree, scene, {{ir::Quantity::constraint_jacobian, ""}}, inputs, Precision::extended)
                          .front()
                          .unaryExpr([](double x) { return std::abs(x) <= Proximal<double>::unmoved ? 0 : x; });
  for (Eigen::Index r = 0; r < inputs.acting.weights.size(); ++r) J.row(r) *= std::sqrt(inputs.acting.weights[r]);
  Eigen::Index row = 0;
  const std::vector<ir::Constraint> all = scene.constraints();
  for (std::size_t c = 0; c < inputs.acting.active.size(); row += all[c++].rows)
    if (!inputs.acting.active[c]) J.middleRows(row, all[c].rows).setZero();
  Eigen::MatrixXd own(J.rows(), static_cast<Eigen::Index>(undriven.size()));
  for (std::size_t i = 0; i < undriven.size(); ++i) own.col(static_cast<Eigen::Index>(i)) = J.col(undriven[i]);
  return symmetric_condition(own.transpose() * own);
}

}  // namespace

namespace {

// Pivots of what dependent joints are solved by: G has one below, its rate two.
double linkage_condition(const ir::KinematicTree& tree, const Inputs& inputs) {
  if (tree.linkages.empty()) return 0;
  Eigen::VectorXd q = inputs.q;
  const double pivot = ir::close_loops(tree, 1, q).least_pivot;
  return pivot > 0 ? 4 / (pivot * pivot) : std::numeric_limits<double>::infinity();
}

Eigen::MatrixXd along_rows(const ir::KinematicTree& tree, const ir::Scene& scene, const Inputs& inputs) {
  return evaluate(tree, scene, {{ir::Quantity::delassus_matrix, ""}}, inputs, Precision::extended).front();
}

double condition_of_solution(const Wanted& wanted, const ir::KinematicTree& tree, const ir::Scene& scene,
                             const Inputs& inputs) {
  if (!wanted.quantity) return 0;
  if (ir::row_of(*wanted.quantity).scale == ir::Scale::supported) return support_condition(tree, scene, inputs);
  if (!ir::is_solved(ir::row_of(*wanted.quantity).scale)) return 0;
  const double of_mass = mass_condition(tree, scene, inputs);
  if (ir::row_of(*wanted.quantity).scale == ir::Scale::solved || !std::isfinite(of_mass)) return of_mass;
  // Where rows say the same, and at velocities that contradict them, forces are 1/mu of what is asked for, and cancel; as they
  // turn with q, forces without meaning ask for others 1/mu as large.
  const bool by_q = *wanted.quantity == ir::Quantity::constrained_forward_dynamics_dq ||
                    *wanted.quantity == ir::Quantity::constraint_forces_dq;
  return of_mass * symmetric_condition(along_rows(tree, scene, inputs), by_q ? 2 : 1);
}

}  // namespace

double condition(const Wanted& wanted, const ir::KinematicTree& tree, const ir::Scene& scene, const Inputs& inputs) {
  return std::max(condition_of_solution(wanted, tree, scene, inputs), linkage_condition(tree, inputs));
}

bool depends_on_steps(const Wanted& wanted, const ir::KinematicTree& tree, const ir::Scene& scene, const Inputs& inputs) {
  if (!wanted.quantity) return false;
  const ir::QuantityRow& row = ir::row_of(*wanted.quantity);
  if (row.scale != ir::Scale::constrained || row.columns == ir::Extent::one) return false;
  const double mu = scene.scalar == ir::ScalarType::float32 ? Proximal<float>::mu : Proximal<double>::mu;
  const Eigen::VectorXd values = relative_eigenvalues(along_rows(tree, scene, inputs));
  return (values.array() > mu / 1000 && values.array() < given_up * mu).any();
}

double LeastScale::largest_mass() {
  if (!mass_)
    mass_ =
        evaluate(tree_, scene_, {{ir::Quantity::mass_matrix, ""}}, inputs_, Precision::float64).front().cwiseAbs().maxCoeff();
  return *mass_;
}

namespace {

// Moments of weights about the origin of the base, as far from it as their joints lead: what cancels where a joint's axis goes
// through all centres of mass.
double moments_about_base(const ir::KinematicTree& tree, double gravity) {
  std::vector<double> away;
  double sum = 0;
  for (const ir::Body& body : tree.bodies) {
    away.push_back((body.parent < 0 ? 0 : away[static_cast<std::size_t>(body.parent)]) + body.placement.translation().norm());
    sum += body.inertia.mass * away.back();
  }
  return gravity * sum;
}

// How far the masses may be from the base, on average.
double reach_of_masses(const ir::KinematicTree& tree) {
  double moments = 0, mass = tree.base.mass;
  std::vector<double> away;
  for (const ir::Body& body : tree.bodies) {
    away.push_back((body.parent < 0 ? 0 : away[static_cast<std::size_t>(body.parent)]) + body.placement.translation().norm());
    moments += body.inertia.mass * (away.back() + body.inertia.com.norm());
    mass += body.inertia.mass;
  }
  return mass > 0 ? moments / mass : 0;
}

// How far points that contacts and loops hold may be from the base: levers that cancel where a joint's axis goes through one.
double reach_of_constraints(const ir::KinematicTree& tree, const ir::Scene& scene) {
  double reach = 0;
  const auto add = [&](const std::string& link, const Eigen::Vector3d& at) {
    const ir::LinkPlacement& placed = *tree.find_link(link);
    double own = (placed.placement * at).norm();
    for (int body = placed.body; body >= 0; body = tree.bodies[static_cast<std::size_t>(body)].parent)
      own += tree.bodies[static_cast<std::size_t>(body)].placement.translation().norm();
    reach = std::max(reach, own);
  };
  for (const ir::Contact& contact : scene.contacts) add(contact.link, contact.at);
  for (const ir::Loop& loop : scene.loops)
    for (std::size_t i = 0; i < 2; ++i) add(loop.links[i], loop.at[i].translation());
  return reach;
}

}  // namespace

double LeastScale::largest_weight(ir::Quantity quantity) {
  if (const auto known = weight_.find(quantity); known != weight_.end()) return known->second;
  double& largest = weight_[quantity] = moments_about_base(tree_, scene_.gravity.norm());
  ir::Scene turned = scene_;
  Inputs inputs = inputs_;
  inputs.loading.gravity.reset();
  for (int i = 0; i < 3; ++i) {
    turned.gravity = scene_.gravity.norm() * Eigen::Vector3d::Unit(i);
    const Eigen::MatrixXd result = evaluate(tree_, turned, {{quantity, ""}}, inputs, Precision::float64).front();
    largest = std::max(largest, result.cwiseAbs().maxCoeff());
  }
  return largest;
}

// Derivatives of v' vanish where a robot has one joint: what cancels then are terms like v' itself, and like rates.
double LeastScale::largest_turned(ir::Quantity quantity) {
  const double rate = inputs_.v.cwiseAbs().maxCoeff();
  if (quantity == ir::Quantity::forward_dynamics_dv) return rate;
  if (quantity != ir::Quantity::forward_dynamics_dq) return 0;
  const Eigen::MatrixXd accelerations =
      evaluate(tree_, scene_, {{ir::Quantity::forward_dynamics, ""}}, inputs_, Precision::float64).front();
  return std::max(rate * rate, accelerations.cwiseAbs().maxCoeff());
}

// Contacts may leave no motion at all: then it is measured against what there were without them. Forces that need not be, or
// that do not change, against what moving bodies and their weight ask for.
double LeastScale::largest_free(ir::Quantity quantity) {
  const double rate = inputs_.v.cwiseAbs().maxCoeff();
  if (quantity == ir::Quantity::constraint_forces_dtau) return 1;
  if (quantity == ir::Quantity::constraint_forces_dv) return largest_mass() * rate;
  if (quantity == ir::Quantity::constraint_forces || quantity == ir::Quantity::constraint_forces_dq)
    return std::max(largest_mass() * rate * rate, largest_weight(ir::Quantity::gravity));
  if (ir::row_of(quantity).rows != ir::Extent::nv) return 0;
  if (quantity == ir::Quantity::impact) return rate;
  const auto largest = [&](ir::Quantity free) {
    return evaluate(tree_, scene_, {{free, ""}}, inputs_, Precision::float64).front().cwiseAbs().maxCoeff();
  };
  switch (quantity) {
    // Rows' accelerations change with velocities though those of a robot without them may not.
    case ir::Quantity::constrained_forward_dynamics_dq:
      return std::max(largest(ir::Quantity::forward_dynamics_dq), rate * rate);
    case ir::Quantity::constrained_forward_dynamics_dv: return std::max(largest(ir::Quantity::forward_dynamics_dv), rate);
    case ir::Quantity::constrained_forward_dynamics_dtau: return largest(ir::Quantity::inverse_mass_matrix);
    default: return largest(ir::Quantity::forward_dynamics);
  }
}

namespace {

ir::Quantity jacobian_of(ir::Quantity bias) {
  return bias == ir::Quantity::center_of_mass_bias ? ir::Quantity::center_of_mass_jacobian : ir::Quantity::constraint_jacobian;
}

}  // namespace

// What the two links of a loop do, all coordinates adding to it: the loop's own may be the difference of equal ones.
double LeastScale::largest_of_loops() {
  std::vector<Wanted> jacobians;
  for (const ir::Loop& loop : scene_.loops)
    for (const std::string& link : loop.links) jacobians.push_back({std::nullopt, link, ir::LinkQuantity::jacobian_world});
  double speed = 0;
  for (const Eigen::MatrixXd& jacobian : evaluate(tree_, scene_, jacobians, inputs_, Precision::float64))
    speed = std::max(speed, (jacobian.cwiseAbs() * inputs_.v.cwiseAbs()).maxCoeff());
  return speed * inputs_.v.cwiseAbs().sum();
}

// Of rows of contacts and loops, where what joints do to a point cancels.
double LeastScale::largest_lever(ir::Quantity quantity) {
  const double reach = reach_of_constraints(tree_, scene_);
  if (quantity != ir::Quantity::delassus_matrix) return reach;
  const Eigen::MatrixXd inverse =
      evaluate(tree_, scene_, {{ir::Quantity::inverse_mass_matrix, ""}}, inputs_, Precision::float64).front();
  double largest = 0;  // of what stands above them
  for (const int k : ir::constraint_paths(tree_, scene_).moving()) largest = std::max(largest, inverse(k, k));
  return reach * reach * largest;
}

// What wrenches on links push joints with, whatever cancels: one that turns with its link does not change with the link's
// joint.
double LeastScale::largest_push() {
  if (inputs_.wrenches.size() == 0) return 0;
  std::vector<Wanted> jacobians;
  for (const ir::ExternalWrench& wrench : scene_.wrenches)
    jacobians.push_back({std::nullopt, wrench.link, ir::LinkQuantity::jacobian_world});
  const std::vector<Eigen::MatrixXd> links = evaluate(tree_, scene_, jacobians, inputs_, Precision::float64);
  double largest = 0;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const double size = inputs_.wrenches.segment(6 * static_cast<Eigen::Index>(i), 6).cwiseAbs().maxCoeff();
    largest = std::max(largest, size * links[i].cwiseAbs().colwise().sum().maxCoeff());
  }
  return largest;
}

double LeastScale::of(const Wanted& wanted) {
  const double rate = inputs_.v.cwiseAbs().maxCoeff();
  double scale = 0;
  if (!wanted.quantity) {
    const ir::LinkScale kind = ir::row_of(wanted.of_link).scale;
    if (kind == ir::LinkScale::own) return 0;
    const Wanted jacobian{std::nullopt, wanted.link,
                          wanted.of_link == ir::LinkQuantity::acceleration_bias_world ? ir::LinkQuantity::jacobian_world
                                                                                      : ir::LinkQuantity::jacobian};
    scale = evaluate(tree_, scene_, {jacobian}, inputs_, Precision::float64).front().cwiseAbs().maxCoeff() * rate;
    return (kind == ir::LinkScale::rate ? scale : scale * rate) / 1000;
  }
  switch (ir::row_of(*wanted.quantity).scale) {
    case ir::Scale::own:
      // A joint whose axis goes through the centre of all that it moves does not move the centre of mass.
      if (*wanted.quantity == ir::Quantity::center_of_mass_jacobian) scale = reach_of_masses(tree_);
      if (*wanted.quantity == ir::Quantity::constraint_jacobian) scale = largest_lever(*wanted.quantity);
      if (!wanted.selection.whole())
        scale = std::max(
            scale,
            evaluate(tree_, scene_, {{*wanted.quantity, ""}}, inputs_, Precision::float64).front().cwiseAbs().maxCoeff());
      break;
    case ir::Scale::solved:
      if (*wanted.quantity != ir::Quantity::delassus_matrix) return largest_turned(*wanted.quantity);
      scale = largest_lever(*wanted.quantity);
      break;
    case ir::Scale::constrained: return largest_free(*wanted.quantity);
    case ir::Scale::turning:
      scale = evaluate(tree_, scene_, {{jacobian_of(*wanted.quantity), ""}}, inputs_, Precision::float64)
                  .front()
                  .cwiseAbs()
                  .maxCoeff() *
              rate * rate;
      if (*wanted.quantity == ir::Quantity::constraint_bias)
        scale = std::max({scale, largest_of_loops(), largest_lever(*wanted.quantity) * rate * rate});
      break;
    case ir::Scale::momentum: scale = largest_mass() * rate; break;
    case ir::Scale::weight: scale = largest_weight(*wanted.quantity); break;
    case ir::Scale::centrifugal: scale = largest_mass() * rate * rate; break;
    case ir::Scale::supported:
    case ir::Scale::force:
      scale = std::max({largest_mass() * rate * rate, largest_weight(ir::Quantity::gravity), largest_push()});
      break;
  }
  return scale / 1000;
}

}  // namespace dalembert::reference
