// Rows that links keep to, and dynamics that keep to them: M v̇ + C v + g = τ + Jᵀ f, J v̇ + J̇ v = b.
//
// A contact's rows are the velocity of a point of its link along the world's axes, or the link's, then, of a weld, the angular
// velocity along them. f is what the world exerts on the robot along them. Rows that say the same twice make J M⁻¹ Jᵀ singular:
// f is found by proximal steps, (J M⁻¹ Jᵀ + R + μ N) f' = c + μ N f, f = 0 at first (Carpentier, Budhiraja, Mansard, "Proximal
// and sparse resolution of constrained dynamic equations", RSS 2021), as many as generated code takes; N is the mean of the
// diagonal over a constraint's linear rows, or its angular ones. A loop's rows are the velocity of one link against another;
// its f is what the first exerts on the second.
#pragma once

#include <dalembert/generic/dynamics.hpp>
#include <dalembert/generic/forward_dynamics.hpp>
#include <dalembert/generic/frames.hpp>
#include <initializer_list>
#include <limits>
#include <utility>
#include <vector>

namespace dalembert::generic {

template <class S>
struct Contact {
  int body = -1;            // −1: the base
  Transform<S> frame;       // in the body
  int rows = 6;             // 6, or 3: the point alone
  Axes axes = Axes::mixed;  // or body: the link's
};

// What holds a second body to a first, at a frame on each: rows of the second's motion against the first, along axes of the
// frame on the first, at the point of the second.
template <class S>
struct Loop {
  int bodies[2] = {-1, -1};
  Transform<S> frames[2];      // in the bodies
  std::vector<int> linear{};   // axes, 0 1 2
  std::vector<int> angular{};  // likewise
  // Else, above zero: one row, (|x_b − x_a|² − ℓ²) / 2ℓ, which is how far the points are from a distance apart.
  S distance = S(0);

  int linear_rows() const { return distance > S(0) ? 1 : static_cast<int>(linear.size()); }
  int rows() const { return linear_rows() + (distance > S(0) ? 0 : static_cast<int>(angular.size())); }
};

// What holds a robot: rows of contacts, and behind them those of loops.
template <class S>
struct Constraints {
  std::vector<Contact<S>> contacts;
  std::vector<Loop<S>> loops;

  Constraints() = default;
  Constraints(std::vector<Contact<S>> of_contacts, std::vector<Loop<S>> of_loops = {})
      : contacts(std::move(of_contacts)), loops(std::move(of_loops)) {}
  Constraints(std::initializer_list<Contact<S>> of_contacts) : contacts(of_contacts) {}

  // Per constraint: how many rows, and how many of them, the first, are linear.
  std::vector<std::pair<int, int>> rows() const {
    std::vector<std::pair<int, int>> all;
    for (const Contact<S>& contact : contacts) all.emplace_back(contact.rows, 3);
    for (const Loop<S>& loop : loops) all.emplace_back(loop.rows(), loop.linear_rows());
    return all;
  }
  int all_rows() const {
    int count = 0;
    for (const auto& [own, linear] : rows()) count += own;
    return count;
  }
};

// How constraints are solved for.
template <class S>
struct ConstraintOptions {
  S mu = S(1e-8);
  int steps = 3;
  std::vector<bool> active{};   // per constraint; empty: all are
  VectorX<S> regularization{};  // R, per row; empty: none
  VectorX<S> wanted{};          // b, per row; empty: zero
  VectorX<S> weights{};         // of forces, per row; empty: ones. For inverse dynamics
};

namespace detail {

// A loop's frames: where they are, and how they move, along the world's axes and at their own origins.
template <class S>
struct LoopFrames {
  Transform<S> poses[2];
  Vector6<S> twists[2], biases[2];

  LoopFrames(const Model<S>& model, const State<S>& at, const Loop<S>& loop, bool moving) {
    for (int i = 0; i < 2; ++i) {
      const int body = loop.bodies[i];
      poses[i] = frame_pose<S>(model, at.kinematics, at.q, body, loop.frames[i]);
      if (!moving) continue;
      twists[i] = from_body_axes<S>(poses[i], Axes::mixed) * frame_twist<S>(at.kinematics, body, loop.frames[i]);
      biases[i] = frame_acceleration_bias<S>(model, at.kinematics, at.q, at.v, body, loop.frames[i], Axes::mixed);
    }
  }
  Vector3<S> between() const { return poses[1].translation - poses[0].translation; }
};

// The rows asked for of a motion of b against a along a's axes.
template <class S, class Motion>
MatrixX<S> rows_of_loop(const Loop<S>& loop, const Motion& linear, const Motion& angular) {
  MatrixX<S> rows(loop.rows(), linear.cols());
  int row = 0;
  for (const int i : loop.linear) rows.row(row++) = linear.row(i);
  for (const int i : loop.angular) rows.row(row++) = angular.row(i);
  return rows;
}

// ṙ = Rᵀ (ẋ_b − ẋ_a − w_a × (x_b − x_a)), Rᵀ (w_b − w_a); or (x_b − x_a)·(ẋ_b − ẋ_a) / ℓ.
template <class S>
MatrixX<S> loop_jacobian(const Model<S>& model, const State<S>& at, const Loop<S>& loop) {
  const LoopFrames<S> frames(model, at, loop, false);
  MatrixX<S> J[2];
  for (int i = 0; i < 2; ++i) {
    MatrixX<S> whole = expanded_frame_jacobian<S>(model, at.kinematics, at.q, loop.bodies[i], loop.frames[i], Axes::mixed);
    // What moves both bodies moves neither against the other: no rounding is left of it.
    whole.leftCols(model.base_rows()).setZero();
    for (int one = loop.bodies[0]; one >= 0; one = model.bodies[static_cast<size_t>(one)].parent)
      for (int other = loop.bodies[1]; other >= 0; other = model.bodies[static_cast<size_t>(other)].parent)
        if (one == other) whole.col(model.base_rows() + one).setZero();
    J[i] = at.reduction.reduce_columns(whole);
  }
  const MatrixX<S> moving = J[1].topRows(3) - J[0].topRows(3);
  if (loop.distance > S(0)) return frames.between().transpose() * moving / loop.distance;
  const MatrixX<S> back = frames.poses[0].rotation.transpose();
  const MatrixX<S> against = moving + cross_matrix<S>(frames.between()) * J[0].bottomRows(3);
  return rows_of_loop<S, MatrixX<S>>(loop, back * against, back * (J[1].bottomRows(3) - J[0].bottomRows(3)));
}

// The rate of that where v̇ = 0.
template <class S>
VectorX<S> loop_bias(const Model<S>& model, const State<S>& at, const Loop<S>& loop) {
  const LoopFrames<S> frames(model, at, loop, true);
  const Vector3<S> d = frames.between(), w = frames.twists[0].template tail<3>(), alpha = frames.biases[0].template tail<3>(),
                   moving = frames.twists[1].template head<3>() - frames.twists[0].template head<3>(),
                   changing = frames.biases[1].template head<3>() - frames.biases[0].template head<3>();
  if (loop.distance > S(0)) return VectorX<S>::Constant(1, S((d.dot(changing) + moving.squaredNorm()) / loop.distance));
  const Vector3<S> w_other = frames.twists[1].template tail<3>(), alpha_other = frames.biases[1].template tail<3>();
  const auto cross = [](const Vector3<S>& a, const Vector3<S>& b) -> Vector3<S> { return cross_matrix<S>(a) * b; };
  const Vector3<S> linear =
                       changing - cross(alpha, d) - cross(w, cross(w, d)) - S(2) * cross(w, Vector3<S>(moving - cross(w, d))),
                   angular = alpha_other - alpha - cross(w, w_other);
  const MatrixX<S> back = frames.poses[0].rotation.transpose();
  return rows_of_loop<S, MatrixX<S>>(loop, back * linear, back * angular);
}

}  // namespace detail

// J, rows × nv.
template <class S>
MatrixX<S> constraint_jacobian(const Model<S>& model, const Constraints<S>& constraints, In<S> q) {
  const detail::State<S> at(model, q);
  MatrixX<S> J(constraints.all_rows(), model.nv());
  int row = 0;
  for (const Contact<S>& contact : constraints.contacts) {
    const MatrixX<S> whole = at.reduction.reduce_columns(
        expanded_frame_jacobian<S>(model, at.kinematics, at.q, contact.body, contact.frame, contact.axes));
    J.middleRows(row, contact.rows) = whole.topRows(contact.rows);
    row += contact.rows;
  }
  for (const Loop<S>& loop : constraints.loops) {
    J.middleRows(row, loop.rows()) = detail::loop_jacobian<S>(model, at, loop);
    row += loop.rows();
  }
  return J;
}

// J̇ v, per row.
template <class S>
VectorX<S> constraint_bias(const Model<S>& model, const Constraints<S>& constraints, In<S> q, In<S> v) {
  const detail::State<S> at(model, q, v);
  VectorX<S> bias(constraints.all_rows());
  int row = 0;
  for (const Contact<S>& contact : constraints.contacts) {
    const Vector6<S> whole =
        frame_acceleration_bias<S>(model, at.kinematics, at.q, at.v, contact.body, contact.frame, contact.axes);
    for (int i = 0; i < contact.rows; ++i) bias[row + i] = whole[i];
    row += contact.rows;
  }
  for (const Loop<S>& loop : constraints.loops) {
    bias.segment(row, loop.rows()) = detail::loop_bias<S>(model, at, loop);
    row += loop.rows();
  }
  return bias;
}

// J M⁻¹ Jᵀ.
template <class S>
Solution<MatrixX<S>> delassus_matrix(const Model<S>& model, const Constraints<S>& constraints, In<S> q) {
  const Factorisation<S> factors = detail::factorised(model, detail::State<S>(model, q));
  if (!factors.status().ok()) return {{}, factors.status()};
  const MatrixX<S> J = constraint_jacobian<S>(model, constraints, q);
  return {J * factors.solve(J.transpose()), factors.status()};
}

// A vector of nv, and the forces on the rows.
template <class S>
struct Constrained {
  VectorX<S> value, forces;
  FactorStatus<S> status;
  S residual = S(0);  // the largest error that the last step left of a row that acts
};

namespace detail {

// J, of rows of zeros where a constraint does not act, and what forces are solved for by: D = J M⁻¹ Jᵀ + R + μ N, a one on the
// diagonal where none acts; held: μ N.
template <class S>
struct ActingRows {
  MatrixX<S> J, D;
  VectorX<S> held, acts;  // acts: one or zero, per row
};

// Rows of rounding alone would hold what they do not touch; a robot's own numbers are rounded to double.
template <class S>
MatrixX<S> without_rounding(const MatrixX<S>& J) {
  S unmoved = S(0x1p-46);
  if (unmoved < S(64) * std::numeric_limits<S>::epsilon()) unmoved = S(64) * std::numeric_limits<S>::epsilon();
  return J.unaryExpr([&](const S& x) { return x <= unmoved && x >= -unmoved ? S(0) : x; });
}

template <class S>
ActingRows<S> acting_rows(const Constraints<S>& constraints, const MatrixX<S>& J, const Factorisation<S>& mass,
                          const ConstraintOptions<S>& options) {
  ActingRows<S> rows{without_rounding<S>(J), {}, VectorX<S>::Zero(J.rows()), VectorX<S>::Ones(J.rows())};
  const std::vector<std::pair<int, int>> blocks = constraints.rows();
  int row = 0;
  for (size_t c = 0; c < blocks.size(); row += blocks[c++].first)
    if (!options.active.empty() && !options.active[c]) {
      rows.J.middleRows(row, blocks[c].first).setZero();
      rows.acts.segment(row, blocks[c].first).setZero();
    }
  rows.D = rows.J * mass.solve(rows.J.transpose());
  const S sum = rows.D.trace();
  row = 0;
  for (size_t c = 0; c < blocks.size(); row += blocks[c++].first) {
    const bool acts = options.active.empty() || options.active[c];
    const auto [own, linear] = blocks[c];
    for (int begin = 0, end = linear; begin < own; begin = end, end = own) {
      S scale = rows.D.diagonal().segment(row + begin, end - begin).sum() / S(end - begin) + S(1e-6) * sum;
      if (!(scale > S(0))) scale = S(1);
      for (int r = row + begin; r < row + end; ++r) {
        // What no joint moves is held as firmly as others: by mu alone, rounding of what it asks for would be a force.
        const S mu = rows.D(r, r) > S(0) ? options.mu : S(1);
        rows.held[r] = acts ? S(mu * scale) : S(0);
        rows.D(r, r) += acts ? S(rows.held[r] + (options.regularization.size() > 0 ? options.regularization[r] : S(0))) : S(1);
      }
    }
  }
  return rows;
}

// What of b is left to the constraints when `free` moves without them, and what they make of it.
template <class S>
Constrained<S> constrained(const Model<S>& model, const Constraints<S>& constraints, In<S> q, const VectorX<S>& right,
                           const VectorX<S>& free, const ConstraintOptions<S>& options) {
  const Factorisation<S> factors = factorised(model, State<S>(model, q));
  if (!factors.status().ok()) return {{}, {}, factors.status()};
  const MatrixX<S> J = constraint_jacobian<S>(model, constraints, q);
  const Eigen::Index m = J.rows();
  const ActingRows<S> rows = acting_rows<S>(constraints, J, factors, options);
  const VectorX<S> rest = rows.acts.cwiseProduct(right - rows.J * free);
  const Factorisation<S> along(rows.D);
  VectorX<S> forces = VectorX<S>::Zero(m), before = forces;
  for (int step = 0; step < options.steps; ++step) {
    before = forces;
    forces = along.solve(VectorX<S>(rest + rows.held.cwiseProduct(before)));
  }
  Constrained<S> result{free + factors.solve(rows.J.transpose() * forces), forces, factors.status(), S(0)};
  for (Eigen::Index r = 0; r < m; ++r) {
    const S change = forces[r] - before[r], error = rows.held[r] * (change < S(0) ? S(-change) : change);
    if (error > result.residual) result.residual = error;
  }
  return result;
}

}  // namespace detail

// v̇ and f. tau and wrenches: as in forward_dynamics().
template <class S>
Constrained<S> constrained_forward_dynamics(const Model<S>& model, const Constraints<S>& constraints, In<S> q, In<S> v,
                                            In<S> tau, In<S> wrenches = VectorX<S>(),
                                            const ConstraintOptions<S>& options = {}) {
  const Solution<VectorX<S>> free = forward_dynamics<S>(model, q, v, tau, wrenches);
  if (!free.status.ok()) return {{}, {}, free.status};
  VectorX<S> right = -constraint_bias<S>(model, constraints, q, v);
  if (options.wanted.size() > 0) right += options.wanted;
  return detail::constrained<S>(model, constraints, q, right, free.value, options);
}

// τ and f for accelerations given, M v̇ + C v + g = τ + Jᵀ f: at the coordinates `undriven` τ is zero, as far as the constraints
// can bear it, and of all f that will do it is the least, Σ f² / weight. Where v̇ is not what the constraints allow, τ moves the
// robot as near to it as they do, in M's measure; f then is what they exert beside what takes v̇ there. residual: the largest τ
// that is left at those coordinates.
template <class S>
Constrained<S> constrained_inverse_dynamics(const Model<S>& model, const Constraints<S>& constraints, In<S> q, In<S> v,
                                            In<S> v_dot, const std::vector<int>& undriven, In<S> wrenches = VectorX<S>(),
                                            const ConstraintOptions<S>& options = {}) {
  Constrained<S> result{inverse_dynamics<S>(model, q, v, v_dot, wrenches), VectorX<S>::Zero(constraints.all_rows()), {}, S(0)};
  const MatrixX<S> J = detail::without_rounding<S>(constraint_jacobian<S>(model, constraints, q));
  VectorX<S> weights = options.weights.size() > 0 ? options.weights : VectorX<S>(VectorX<S>::Ones(J.rows()));
  int row = 0;
  const std::vector<std::pair<int, int>> blocks = constraints.rows();
  for (size_t c = 0; c < blocks.size(); row += blocks[c++].first)
    if (!options.active.empty() && !options.active[c]) weights.segment(row, blocks[c].first).setZero();
  if (weights.size() > 0)  // they matter by their ratios: so none is too small or large for products
    if (const S most = weights.maxCoeff(); most > S(1e10) || (most > S(0) && most < S(1e-10))) weights /= most;
  const auto count = static_cast<Eigen::Index>(undriven.size());
  MatrixX<S> own(J.rows(), count);
  VectorX<S> lacking(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    own.col(i) = J.col(undriven[static_cast<size_t>(i)]);
    lacking[i] = result.value[undriven[static_cast<size_t>(i)]];
  }
  const MatrixX<S> weighted = weights.asDiagonal() * own;
  MatrixX<S> G = own.transpose() * weighted;
  // N of the base: one of its three axes, one about them, whichever way these stand.
  VectorX<S> held = options.mu * G.diagonal(), y = VectorX<S>::Zero(count);
  for (int first = 0; first < model.base_rows(); first += 3) {
    std::vector<Eigen::Index> own;
    S sum = S(0);
    for (Eigen::Index i = 0; i < count; ++i)
      if (const int k = undriven[static_cast<size_t>(i)]; k >= first && k < first + 3) own.push_back(i), sum += held[i];
    for (const Eigen::Index i : own) held[i] = sum / S(static_cast<int>(own.size()));
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    if (!(held[i] > S(0))) held[i] = options.mu;
    G(i, i) += held[i];
  }
  if (count > 0) {
    const Factorisation<S> factors(G);
    for (int step = 0; step < options.steps; ++step) y = factors.solve(VectorX<S>(lacking + held.cwiseProduct(y)));
    result.forces = weighted * y;
    result.value -= J.transpose() * result.forces;
  }
  for (const int k : undriven) {
    const S left = result.value[k] < S(0) ? S(-result.value[k]) : result.value[k];
    if (left > result.residual) result.residual = left;
  }
  return result;
}

// v after an impact, and its impulses: J v⁺ = −e J v, `wanted` being −e J v.
template <class S>
Constrained<S> impact(const Model<S>& model, const Constraints<S>& constraints, In<S> q, In<S> v,
                      const ConstraintOptions<S>& options = {}) {
  const VectorX<S> right = options.wanted.size() > 0 ? options.wanted : VectorX<S>(VectorX<S>::Zero(constraints.all_rows()));
  return detail::constrained<S>(model, constraints, q, right, v, options);
}

}  // namespace dalembert::generic
