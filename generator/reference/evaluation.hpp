// One evaluation by the generic engine, in any number type. Compiled once per type, each in a file of its own: with Eigen and
// many digits that takes long.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <dalembert/constraint_shapes.hpp>
#include <dalembert/generic/centroidal.hpp>
#include <dalembert/generic/constraint_derivatives.hpp>
#include <dalembert/generic/dynamics.hpp>
#include <dalembert/generic/energy.hpp>
#include <dalembert/generic/frames.hpp>
#include <optional>

#include "ir/constraint_paths.hpp"
#include "ir/loop_length.hpp"
#include "ir/moved_links.hpp"
#include "reference/engine.hpp"
#include "reference/generic_model.hpp"

namespace dalembert::reference {

// Phases I and II once, then each result from them.
template <class S>
class Evaluation {
 public:
  Evaluation(const ir::KinematicTree& tree, const ir::Scene& scene, const std::vector<Wanted>& wanted, const Inputs& inputs)
      : Evaluation(tree, scene, wanted, inputs.q.cast<S>(), inputs.v.cast<S>(), inputs.more.cast<S>(),
                   inputs.wrenches.cast<S>(), inputs.acting) {}
  // The same, of inputs in the scalar.
  Evaluation(const ir::KinematicTree& tree, const ir::Scene& scene, const std::vector<Wanted>& wanted, const VectorX<S>& q,
             const VectorX<S>& v, const VectorX<S>& more, const VectorX<S>& wrenches, const ir::Acting& acting = {})
      : tree_(tree),
        scene_(scene),
        robot_(to_generic<S>(tree, scene.gravity, scene.coriolis)),
        reduction_(robot_),
        own_q_(q),
        own_v_(v),
        more_(more),
        given_(wrenches),
        acting_(acting) {
    generic::check_size<S>(q, robot_.nq(), "q");
    generic::check_size<S>(v, robot_.nv(), "v");
    if (scene.rates_zero) own_v_.setZero();
    q_ = reduction_.expand_position(own_q_);
    v_ = reduction_.expand_velocity(own_v_);
    kinematics_ = generic::phase1<S>(robot_, q_, v_);
    if (given_.size() > 0) collect_wrenches();
    const bool matrices = std::any_of(wanted.begin(), wanted.end(), [](const Wanted& w) {
      return w.quantity == ir::Quantity::mass_matrix || w.quantity == ir::Quantity::coriolis_matrix ||
             w.quantity == ir::Quantity::momentum_matrix;
    });
    if (matrices) composites_ = generic::phase2<S>(robot_, kinematics_);
  }

  MatrixX<S> result(const Wanted& wanted) const {
    if (!wanted.quantity) return of_link(wanted);
    switch (*wanted.quantity) {
      case ir::Quantity::mass_matrix:
        return reduction_.reduce_matrix(generic::phase3_mass_matrix<S>(robot_, kinematics_, composites_));
      case ir::Quantity::coriolis_matrix:
        return reduction_.reduce_matrix(generic::phase3_coriolis_matrix<S>(robot_, kinematics_, composites_));
      case ir::Quantity::gravity: return reduction_.reduce_rows(generic::expanded_gravity<S>(robot_, kinematics_, q_));
      case ir::Quantity::bias: {
        const VectorX<S> rest = VectorX<S>::Zero(v_.size());
        return reduction_.reduce_rows(generic::expanded_newton_euler<S>(robot_, kinematics_, q_, v_, rest));
      }
      case ir::Quantity::inverse_dynamics: return generic::inverse_dynamics<S>(robot_, own_q_, own_v_, more_, wrenches_);
      case ir::Quantity::inverse_dynamics_dq: return inverse_dynamics_dq(more_);
      case ir::Quantity::inverse_dynamics_dv: return generic::inverse_dynamics_dv<S>(robot_, own_q_, own_v_, more_, wrenches_);
      case ir::Quantity::forward_dynamics:
        return solved(generic::forward_dynamics<S>(robot_, own_q_, own_v_, more_, wrenches_), robot_.nv(), 1);
      case ir::Quantity::mass_matrix_factor:
        return solved(generic::mass_matrix_factor<S>(robot_, own_q_), robot_.nv(), robot_.nv());
      case ir::Quantity::inverse_mass_matrix:
        return solved(generic::inverse_mass_matrix<S>(robot_, own_q_), robot_.nv(), robot_.nv());
      case ir::Quantity::forward_dynamics_dq: return solved(forward_dynamics_dq(), robot_.nv(), robot_.nv());
      case ir::Quantity::forward_dynamics_dv:
        return solved(generic::forward_dynamics_dv<S>(robot_, own_q_, own_v_, more_, wrenches_), robot_.nv(), robot_.nv());
      case ir::Quantity::constraint_jacobian: return generic::constraint_jacobian<S>(robot_, constraints(), own_q_);
      case ir::Quantity::constraint_bias: return generic::constraint_bias<S>(robot_, constraints(), own_q_, own_v_);
      case ir::Quantity::delassus_matrix: return delassus_matrix();
      case ir::Quantity::impact:
        return constrained(generic::impact<S>(robot_, constraints(), own_q_, own_v_, options_of_impact()), false);
      case ir::Quantity::constrained_forward_dynamics: return constrained(constrained_motion(), false);
      case ir::Quantity::constraint_forces: return constrained(constrained_motion(), true);
      case ir::Quantity::constrained_forward_dynamics_dq: return derived(&Derivatives::dq);
      case ir::Quantity::constrained_forward_dynamics_dv: return derived(&Derivatives::dv);
      case ir::Quantity::constrained_forward_dynamics_dtau: return derived(&Derivatives::dtau);
      case ir::Quantity::constraint_forces_dq: return derived(&Derivatives::forces_dq);
      case ir::Quantity::constraint_forces_dv: return derived(&Derivatives::forces_dv);
      case ir::Quantity::constraint_forces_dtau: return derived(&Derivatives::forces_dtau);
      case ir::Quantity::constrained_inverse_dynamics: return supported().value;
      case ir::Quantity::inverse_constraint_forces: return supported().forces;
      case ir::Quantity::regressor: return of_links(generic::regressor<S>(robot_, own_q_, own_v_, more_), 10);
      case ir::Quantity::wrench_influence:
        return of_links(reduction_.reduce_rows(generic::expanded_wrench_influence<S>(robot_, kinematics_)), 6);
      case ir::Quantity::kinetic_energy: return scalar(generic::expanded_kinetic_energy<S>(robot_, kinematics_, v_));
      case ir::Quantity::potential_energy: return scalar(generic::potential_energy<S>(robot_, kinematics_, q_));
      case ir::Quantity::center_of_mass: return column(generic::center_of_mass<S>(robot_, kinematics_, q_));
      case ir::Quantity::center_of_mass_jacobian:
        return reduction_.reduce_columns(generic::expanded_center_of_mass_jacobian<S>(robot_, kinematics_, q_));
      case ir::Quantity::center_of_mass_bias:
        return column(generic::expanded_center_of_mass_bias<S>(robot_, kinematics_, q_, v_));
      case ir::Quantity::momentum_matrix:
        return reduction_.reduce_columns(generic::expanded_momentum_matrix<S>(robot_, kinematics_, composites_, q_));
      case ir::Quantity::momentum_bias: return generic::expanded_momentum_bias<S>(robot_, kinematics_, q_, v_);
    }
    return {};
  }

 private:
  // Zero where the mass matrix is singular, as the emitted code has it.
  template <class Value>
  static MatrixX<S> solved(const generic::Solution<Value>& solution, Eigen::Index rows, Eigen::Index columns) {
    if (!solution.status.ok()) return MatrixX<S>::Zero(rows, columns);
    return solution.value;
  }

  MatrixX<S> delassus_matrix() const {
    const auto rows = static_cast<Eigen::Index>(scene_.constraint_rows());
    return solved(generic::delassus_matrix<S>(robot_, constraints(), own_q_), rows, rows);
  }
  // As many proximal steps as code of the scene's number type takes.
  generic::ConstraintOptions<S> options() const {
    const bool single = scene_.scalar == ir::ScalarType::float32;
    return {single ? S(Proximal<float>::mu) : S(Proximal<double>::mu),
            single ? Proximal<float>::steps : Proximal<double>::steps,
            acting_.active,
            acting_.regularization.template cast<S>(),
            {},
            acting_.weights.template cast<S>()};
  }
  generic::ConstraintOptions<S> options_of_impact() const {
    generic::ConstraintOptions<S> options = this->options();
    if (acting_.restitution.empty()) return options;
    options.wanted = -(generic::constraint_jacobian<S>(robot_, constraints(), own_q_) * own_v_);
    Eigen::Index row = 0;
    const std::vector<ir::Constraint> all = scene_.constraints();
    for (std::size_t c = 0; c < all.size(); row += all[c++].rows)
      options.wanted.segment(row, all[c].rows) *= S(acting_.restitution[c]);
    return options;
  }
  generic::Constrained<S> constrained_motion() const {
    return generic::constrained_forward_dynamics<S>(robot_, constraints(), own_q_, own_v_, more_, wrenches_, options());
  }
  generic::Constrained<S> supported() const {
    return generic::constrained_inverse_dynamics<S>(robot_, constraints(), own_q_, own_v_, more_,
                                                    ir::undriven_coordinates(tree_, scene_), wrenches_, options());
  }
  MatrixX<S> constrained(const generic::Constrained<S>& solution, bool forces) const {
    if (!solution.status.ok()) return MatrixX<S>::Zero(forces ? scene_.constraint_rows() : robot_.nv(), 1);
    return forces ? solution.forces : solution.value;
  }
  using Derivatives = generic::ConstrainedDerivatives<S>;
  // All of them at once, when the first is asked for.
  MatrixX<S> derived(MatrixX<S> Derivatives::*which) const {
    if (!derivatives_)
      derivatives_ = generic::constrained_derivatives<S>(robot_, constraints(), own_q_, own_v_, more_, wrenches_, options(),
                                                         turned_wrenches());
    if (derivatives_->status.ok()) return (*derivatives_).*which;
    const bool forces =
        which == &Derivatives::forces_dq || which == &Derivatives::forces_dv || which == &Derivatives::forces_dtau;
    return MatrixX<S>::Zero(forces ? scene_.constraint_rows() : robot_.nv(), robot_.nv());
  }

 public:
  const generic::Model<S>& robot() const { return robot_; }
  generic::Constraints<S> constraints() const {
    generic::Constraints<S> all;
    for (const ir::Contact& contact : scene_.contacts) {
      const Place at = place(contact.link);
      const Transform<S> point{Matrix3<S>::Identity(), contact.at.template cast<S>()};
      all.contacts.push_back(
          {at.body, at.frame * point, contact.rows(), contact.along_link ? generic::Axes::body : generic::Axes::mixed});
    }
    for (const ir::Loop& loop : scene_.loops) {
      generic::Loop<S> held;
      for (std::size_t i = 0; i < 2; ++i) {
        const Place at = place(loop.links[i]);
        held.bodies[i] = at.body;
        held.frames[i] =
            at.frame * Transform<S>{loop.at[i].linear().template cast<S>(), loop.at[i].translation().template cast<S>()};
      }
      held.linear = loop.linear_axes();
      held.angular = loop.angular_axes();
      if (loop.type == ir::LoopType::distance) held.distance = S(ir::loop_length(tree_, loop));
      all.loops.push_back(std::move(held));
    }
    return all;
  }

 private:
  // Of so many columns per body those of links.
  MatrixX<S> of_links(const MatrixX<S>& all, Eigen::Index columns) const {
    const std::vector<int> links = ir::numbers_of_links(tree_);
    MatrixX<S> kept = all.leftCols(columns * ir::count_of_links(tree_));
    for (size_t k = 0; k < links.size(); ++k)
      if (links[k] >= 0)
        kept.middleCols(columns * links[k], columns) =
            all.middleCols(columns * (static_cast<Eigen::Index>(k) + (tree_.base_coordinates() > 0 ? 1 : 0)), columns);
    return kept;
  }

  static MatrixX<S> scalar(const S& value) { return MatrixX<S>::Constant(1, 1, value); }
  // Element by element: g++ 12 thinks that a register of four floats is read from a vector of three.
  static MatrixX<S> column(const Vector3<S>& value) {
    MatrixX<S> result(3, 1);
    for (int i = 0; i < 3; ++i) result(i, 0) = value[i];
    return result;
  }

  struct Place {
    int body;
    Transform<S> frame;  // in the body
  };
  Place place(const std::string& link) const {
    const ir::LinkPlacement* const placed = tree_.find_link(link);
    return {placed->body, {placed->placement.linear().template cast<S>(), placed->placement.translation().template cast<S>()}};
  }

  // The scene's wrench along its link's axes.
  Vector6<S> in_link(size_t which) const {
    const ir::ExternalWrench& external = scene_.wrenches[which];
    Vector6<S> wrench = given_.template segment<6>(6 * static_cast<Eigen::Index>(which));
    if (!external.in_world) return wrench;
    const Place at = place(external.link);
    const Transform<S> pose = generic::frame_pose<S>(robot_, kinematics_, q_, at.body, at.frame);
    return adjoint(Transform<S>{pose.rotation, Vector3<S>::Zero()}).transpose() * wrench;
  }

  void collect_wrenches() {
    wrenches_ = VectorX<S>::Zero(6 * robot_.moving_bodies());
    for (size_t i = 0; i < scene_.wrenches.size(); ++i) {
      const Place at = place(scene_.wrenches[i].link);
      const Vector6<S> in_body = adjoint_inverse(at.frame).transpose() * in_link(i);
      wrenches_.template segment<6>(6 * (at.body + robot_.moving_bodies() - robot_.joints())) += in_body;
    }
  }

  // A wrench along the world's axes does not turn with its link: as seen from there it turns back as the link turns by w,
  // dF = -[w x f; w x n], of which tau has -J' dF.
  MatrixX<S> inverse_dynamics_dq(const VectorX<S>& v_dot) const {
    return generic::inverse_dynamics_dq<S>(robot_, own_q_, own_v_, v_dot, wrenches_) + turned_wrenches();
  }
  MatrixX<S> turned_wrenches() const {
    MatrixX<S> result = MatrixX<S>::Zero(robot_.nv(), robot_.nv());
    for (size_t i = 0; i < scene_.wrenches.size() && given_.size() > 0; ++i) {
      if (!scene_.wrenches[i].in_world) continue;
      const Place at = place(scene_.wrenches[i].link);
      const MatrixX<S> J = generic::expanded_frame_jacobian<S>(robot_, kinematics_, q_, at.body, at.frame, generic::Axes::body);
      const Vector6<S> wrench = in_link(i);
      MatrixX<S> turned(6, J.cols());
      turned.topRows(3) = -cross_matrix<S>(wrench.template head<3>()) * J.bottomRows(3);
      turned.bottomRows(3) = -cross_matrix<S>(wrench.template tail<3>()) * J.bottomRows(3);
      result += reduction_.reduce_matrix(J.transpose() * turned);
    }
    return result;
  }

  generic::Solution<MatrixX<S>> forward_dynamics_dq() const {
    const auto acceleration = generic::forward_dynamics<S>(robot_, own_q_, own_v_, more_, wrenches_);
    const auto inverse = generic::inverse_mass_matrix<S>(robot_, own_q_);
    if (!acceleration.status.ok()) return {{}, acceleration.status};
    return {-inverse.value * inverse_dynamics_dq(acceleration.value), inverse.status};
  }

  MatrixX<S> of_link(const Wanted& wanted) const {
    using generic::Axes;
    const auto [body, frame] = place(wanted.link);
    const auto jacobian = [&, body = body, frame = frame](Axes axes) {
      return reduction_.reduce_columns(generic::expanded_frame_jacobian<S>(robot_, kinematics_, q_, body, frame, axes));
    };
    const auto bias = [&, body = body, frame = frame](Axes axes) -> MatrixX<S> {
      return generic::frame_acceleration_bias<S>(robot_, kinematics_, q_, v_, body, frame, axes);
    };
    switch (wanted.of_link) {
      case ir::LinkQuantity::pose: {
        const Transform<S> pose = generic::frame_pose<S>(robot_, kinematics_, q_, body, frame);
        MatrixX<S> result(3, 4);
        for (int i = 0; i < 3; ++i) {
          for (int k = 0; k < 3; ++k) result(i, k) = pose.rotation(i, k);
          result(i, 3) = pose.translation[i];
        }
        return result;
      }
      case ir::LinkQuantity::twist: return generic::frame_twist<S>(kinematics_, body, frame);
      case ir::LinkQuantity::jacobian: return jacobian(Axes::body);
      case ir::LinkQuantity::jacobian_world: return jacobian(Axes::world);
      case ir::LinkQuantity::jacobian_mixed: return jacobian(Axes::mixed);
      case ir::LinkQuantity::acceleration_bias: return bias(Axes::body);
      case ir::LinkQuantity::acceleration_bias_world: return bias(Axes::world);
      case ir::LinkQuantity::acceleration_bias_mixed: return bias(Axes::mixed);
    }
    return {};
  }

  const ir::KinematicTree& tree_;
  const ir::Scene& scene_;
  const generic::Model<S> robot_;
  const generic::Reduction<S> reduction_;
  VectorX<S> q_, v_;                         // of every joint
  VectorX<S> own_q_, own_v_, more_, given_;  // as given; the last: wrenches on links
  const ir::Acting acting_;
  mutable std::optional<Derivatives> derivatives_;
  VectorX<S> wrenches_;  // on bodies, along their axes and about their origins, in the order of W's columns
  generic::Kinematics<S> kinematics_;
  generic::Composites<S> composites_;
};

// Where loops are embedded: what the tree without them comes to, for the independent coordinates. With J of the loops as rows
// (generic/constraints.hpp), J_d and J_y its dependent and independent columns: T = [1; -J_d^-1 J_y]; T' column by column from
// J T e = 0, whose second derivative along v and e is symmetric in the two where both keep to the loops, so that differences of
// J'v give it. Nothing of dalembert/linkage.hpp is used.
template <class S>
class EmbeddedEvaluation {
 public:
  EmbeddedEvaluation(const ir::KinematicTree& tree, const ir::Scene& scene, const std::vector<Wanted>& wanted,
                     const Inputs& inputs)
      : tree_(tree), opened_(tree.opened()), scene_(without_embedded(scene)) {
    q_ = inputs.q.cast<S>();
    y_ = inputs.v.cast<S>();
    more_ = inputs.more.cast<S>();
    wrenches_ = inputs.wrenches.cast<S>();
    if (scene_.rates_zero) y_.setZero();
    find_motion();
    std::vector<Wanted> all = wanted;
    for (const ir::Quantity quantity : {ir::Quantity::mass_matrix, ir::Quantity::momentum_matrix})
      all.push_back({quantity, ""});
    const VectorX<S> v = times(T_, y_);
    const VectorX<S> acceleration = more_.size() == y_.size() ? VectorX<S>(times(T_, more_) + turning_) : turning_;
    at_rest_.emplace(opened_, scene_, all, q_, v, turning_, wrenches_);
    accelerated_.emplace(opened_, scene_, all, q_, v, acceleration, wrenches_);
    mass_ = at_rest_->result({ir::Quantity::mass_matrix, ""});
  }

  MatrixX<S> result(const Wanted& wanted) const {
    using Quantity = ir::Quantity;
    if (!wanted.quantity) return of_link(wanted);
    const auto whole = [&](Quantity quantity) { return at_rest_->result({quantity, ""}); };
    switch (*wanted.quantity) {
      case Quantity::mass_matrix: return along(times(mass_, T_));
      case Quantity::coriolis_matrix: return along(times(whole(Quantity::coriolis_matrix), T_) + times(mass_, T_rate_));
      case Quantity::bias: return along(whole(Quantity::bias) + times(mass_, turning_));
      case Quantity::gravity:
      case Quantity::wrench_influence: return along(whole(*wanted.quantity));
      case Quantity::inverse_dynamics:
      case Quantity::regressor: return along(accelerated_->result(wanted));
      case Quantity::center_of_mass_jacobian:
      case Quantity::momentum_matrix: return times(whole(*wanted.quantity), T_);
      case Quantity::center_of_mass_bias:
        return whole(*wanted.quantity) + times(whole(Quantity::center_of_mass_jacobian), turning_);
      case Quantity::momentum_bias: return whole(*wanted.quantity) + times(whole(Quantity::momentum_matrix), turning_);
      case Quantity::forward_dynamics:
      case Quantity::inverse_mass_matrix:
      case Quantity::mass_matrix_factor: return solved(*wanted.quantity);
      default: return whole(*wanted.quantity);
    }
  }

 private:
  // Of matrices alone: each kind of product of expressions takes Eigen a second to compile.
  static MatrixX<S> times(const MatrixX<S>& a, const MatrixX<S>& b) { return a * b; }
  MatrixX<S> along(const MatrixX<S>& a) const { return times(T_.transpose(), a); }

  static ir::Scene without_embedded(ir::Scene scene) {
    scene.loops = scene.embedded;
    scene.embedded.clear();
    return scene;
  }

  void find_motion() {
    const Evaluation<S> still(opened_, scene_, {}, q_, VectorX<S>::Zero(opened_.nv()), {}, wrenches_);
    const generic::Constraints<S> loops = still.constraints();
    const ir::Followers list = ir::followers(tree_);
    const auto n = static_cast<Eigen::Index>(tree_.nv());
    const MatrixX<S> J = generic::constraint_jacobian<S>(still.robot(), loops, q_);
    std::vector<int> dependent;
    for (const ir::Linkage& linkage : tree_.linkages)
      for (const int k : linkage.dependent)
        dependent.push_back(opened_.base_coordinates() + opened_.coordinates()[static_cast<std::size_t>(k)]);
    MatrixX<S> own(J.rows(), static_cast<Eigen::Index>(dependent.size())), others(J.rows(), n);
    for (std::size_t i = 0; i < dependent.size(); ++i) own.col(static_cast<Eigen::Index>(i)) = J.col(dependent[i]);
    for (Eigen::Index i = 0; i < n; ++i) others.col(i) = J.col(list.at[static_cast<std::size_t>(i)]);
    T_ = T_rate_ = MatrixX<S>::Zero(opened_.nv(), n);
    for (Eigen::Index i = 0; i < n; ++i) T_(list.at[static_cast<std::size_t>(i)], i) = S(1);
    turning_ = VectorX<S>::Zero(opened_.nv());
    Eigen::VectorXd q = q_.template cast<double>();
    regular_ = ir::close_loops(tree_, 1, q).ok();
    if (!regular_) return;
    const Eigen::PartialPivLU<MatrixX<S>> solver(own);
    const auto set = [&](MatrixX<S>& to, const MatrixX<S>& right) {
      const MatrixX<S> moved = solver.solve(right);
      for (std::size_t i = 0; i < dependent.size(); ++i) to.row(dependent[i]) = -moved.row(static_cast<Eigen::Index>(i));
    };
    set(T_, others);
    const VectorX<S> v = times(T_, y_);
    MatrixX<S> rates(J.rows(), n);
    const auto bias = [&](const VectorX<S>& at) { return generic::constraint_bias<S>(still.robot(), loops, q_, at); };
    for (Eigen::Index i = 0; i < n; ++i)
      rates.col(i) = (bias(VectorX<S>(v + T_.col(i))) - bias(VectorX<S>(v - T_.col(i)))) / S(4);
    set(T_rate_, rates);
    turning_ = times(T_rate_, y_);
  }

  // Where loops do not tell where joints are, everything is zero.
  MatrixX<S> solved(ir::Quantity quantity) const {
    const auto n = static_cast<Eigen::Index>(tree_.nv());
    const Eigen::Index columns = quantity == ir::Quantity::forward_dynamics ? 1 : n;
    const generic::Factorisation<S> factors(along(times(mass_, T_)));
    if (!factors.status().ok()) return MatrixX<S>::Zero(n, columns);
    if (quantity == ir::Quantity::mass_matrix_factor) return factors.upper();
    if (quantity == ir::Quantity::inverse_mass_matrix) return factors.solve(MatrixX<S>::Identity(n, n));
    return factors.solve(MatrixX<S>(more_ - along(at_rest_->result({ir::Quantity::inverse_dynamics, ""}))));
  }

  MatrixX<S> of_link(const Wanted& wanted) const {
    using ir::LinkQuantity;
    const auto with_jacobian = [&](LinkQuantity jacobian) -> MatrixX<S> {
      return at_rest_->result(wanted) + times(at_rest_->result({std::nullopt, wanted.link, jacobian}), turning_);
    };
    switch (wanted.of_link) {
      case LinkQuantity::jacobian:
      case LinkQuantity::jacobian_world:
      case LinkQuantity::jacobian_mixed: return times(at_rest_->result(wanted), T_);
      case LinkQuantity::acceleration_bias: return with_jacobian(LinkQuantity::jacobian);
      case LinkQuantity::acceleration_bias_world: return with_jacobian(LinkQuantity::jacobian_world);
      case LinkQuantity::acceleration_bias_mixed: return with_jacobian(LinkQuantity::jacobian_mixed);
      case LinkQuantity::pose:
      case LinkQuantity::twist: break;
    }
    return at_rest_->result(wanted);
  }

 public:
  bool regular() const { return regular_; }

 private:
  const ir::KinematicTree& tree_;
  const ir::KinematicTree opened_;
  const ir::Scene scene_;
  VectorX<S> q_, y_, more_, wrenches_, turning_;  // turning: accelerations where y'' = 0
  MatrixX<S> T_, T_rate_, mass_;
  bool regular_ = true;
  std::optional<Evaluation<S>> at_rest_, accelerated_;
};

template <class S>
std::vector<Eigen::MatrixXd> evaluate_embedded(const ir::KinematicTree& tree, const ir::Scene& scene,
                                               const std::vector<Wanted>& wanted, const Inputs& inputs) {
  const EmbeddedEvaluation<S> evaluation(tree, scene, wanted, inputs);
  std::vector<Eigen::MatrixXd> results;
  for (const Wanted& w : wanted) {
    results.push_back(evaluation.result(w).template cast<double>());
    if (!evaluation.regular()) results.back().setZero();
  }
  return results;
}

template <class S>
std::vector<Eigen::MatrixXd> evaluate_in(const ir::KinematicTree& tree, const ir::Scene& scene,
                                         const std::vector<Wanted>& wanted, const Inputs& inputs) {
  if (!tree.linkages.empty()) return evaluate_embedded<S>(tree, scene, wanted, inputs);
  const Evaluation<S> evaluation(tree, scene, wanted, inputs);
  std::vector<Eigen::MatrixXd> results;
  for (const Wanted& w : wanted) results.push_back(evaluation.result(w).template cast<double>());
  return results;
}

}  // namespace dalembert::reference
