// Rows that links keep to, and dynamics that keep to them: M v̇ + C v + g = τ + Jᵀ f, J v̇ + J̇ v = b.
//
// A contact's rows are the velocity of a point of its link along the world's axes, or the link's, then, of a weld, the angular
// velocity along them. f is what the world exerts on the robot along them. Rows that say the same twice make J M⁻¹ Jᵀ singular:
// f is found by proximal steps, (J M⁻¹ Jᵀ + R + μ N) f' = c + μ N f, f = 0 at first (Carpentier, Budhiraja, Mansard, "Proximal
// and sparse resolution of constrained dynamic equations", RSS 2021), as many as generated code takes; N is the mean of the
// diagonal over three rows that belong together.
#pragma once

#include <dalembert/generic/forward_dynamics.hpp>
#include <dalembert/generic/frames.hpp>

namespace dalembert::generic {

template <class S>
struct Contact {
  int body = -1;            // −1: the base
  Transform<S> frame;       // in the body
  int rows = 6;             // 6, or 3: the point alone
  Axes axes = Axes::mixed;  // or body: the link's
};

// How constraints are solved for.
template <class S>
struct ConstraintOptions {
  S mu = S(1e-8);
  int steps = 3;
  std::vector<bool> active{};   // per contact; empty: all are
  VectorX<S> regularization{};  // R, per row; empty: none
  VectorX<S> wanted{};          // b, per row; empty: zero
};

template <class S>
int constraint_rows(const std::vector<Contact<S>>& contacts) {
  int rows = 0;
  for (const Contact<S>& contact : contacts) rows += contact.rows;
  return rows;
}

// J, rows × nv.
template <class S>
MatrixX<S> constraint_jacobian(const Model<S>& model, const std::vector<Contact<S>>& contacts, In<S> q) {
  const detail::State<S> at(model, q);
  MatrixX<S> J(constraint_rows(contacts), model.nv());
  int row = 0;
  for (const Contact<S>& contact : contacts) {
    const MatrixX<S> whole = at.reduction.reduce_columns(
        expanded_frame_jacobian<S>(model, at.kinematics, at.q, contact.body, contact.frame, contact.axes));
    J.middleRows(row, contact.rows) = whole.topRows(contact.rows);
    row += contact.rows;
  }
  return J;
}

// J̇ v, per row.
template <class S>
VectorX<S> constraint_bias(const Model<S>& model, const std::vector<Contact<S>>& contacts, In<S> q, In<S> v) {
  const detail::State<S> at(model, q, v);
  VectorX<S> bias(constraint_rows(contacts));
  int row = 0;
  for (const Contact<S>& contact : contacts) {
    const Vector6<S> whole =
        frame_acceleration_bias<S>(model, at.kinematics, at.q, at.v, contact.body, contact.frame, contact.axes);
    for (int i = 0; i < contact.rows; ++i) bias[row + i] = whole[i];
    row += contact.rows;
  }
  return bias;
}

// J M⁻¹ Jᵀ.
template <class S>
Solution<MatrixX<S>> delassus_matrix(const Model<S>& model, const std::vector<Contact<S>>& contacts, In<S> q) {
  const Factorisation<S> factors = detail::factorised(model, detail::State<S>(model, q));
  if (!factors.status().ok()) return {{}, factors.status()};
  const MatrixX<S> J = constraint_jacobian<S>(model, contacts, q);
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

// What of b is left to the constraints when `free` moves without them, and what they make of it.
template <class S>
Constrained<S> constrained(const Model<S>& model, const std::vector<Contact<S>>& contacts, In<S> q, const VectorX<S>& right,
                           const VectorX<S>& free, const ConstraintOptions<S>& options) {
  const Factorisation<S> factors = factorised(model, State<S>(model, q));
  if (!factors.status().ok()) return {{}, {}, factors.status()};
  MatrixX<S> J = constraint_jacobian<S>(model, contacts, q);
  const Eigen::Index m = J.rows();
  VectorX<S> rest = right - J * free, held = VectorX<S>::Zero(m), mean = VectorX<S>::Zero(m);
  int row = 0;
  for (size_t c = 0; c < contacts.size(); row += contacts[c++].rows)
    if (!options.active.empty() && !options.active[c]) {
      J.middleRows(row, contacts[c].rows).setZero();
      rest.segment(row, contacts[c].rows).setZero();
    }
  MatrixX<S> D = J * factors.solve(J.transpose());
  const S sum = D.trace();
  row = 0;
  for (size_t c = 0; c < contacts.size(); row += contacts[c++].rows) {
    const bool acts = options.active.empty() || options.active[c];
    for (int three = row; three < row + contacts[c].rows; three += 3) {
      S scale = (D(three, three) + D(three + 1, three + 1) + D(three + 2, three + 2)) / S(3) + S(1e-6) * sum;
      if (!(scale > S(0))) scale = S(1);
      for (int r = three; r < three + 3; ++r) {
        held[r] = acts ? S(options.mu * scale) : S(0);
        D(r, r) += acts ? S(held[r] + (options.regularization.size() > 0 ? options.regularization[r] : S(0))) : S(1);
      }
    }
  }
  const Factorisation<S> along(D);
  VectorX<S> forces = VectorX<S>::Zero(m), before = forces;
  for (int step = 0; step < options.steps; ++step) {
    before = forces;
    forces = along.solve(VectorX<S>(rest + held.cwiseProduct(before)));
  }
  Constrained<S> result{free + factors.solve(J.transpose() * forces), forces, factors.status(), S(0)};
  for (Eigen::Index r = 0; r < m; ++r) {
    const S change = forces[r] - before[r], error = held[r] * (change < S(0) ? S(-change) : change);
    if (error > result.residual) result.residual = error;
  }
  return result;
}

}  // namespace detail

// v̇ and f. tau and wrenches: as in forward_dynamics().
template <class S>
Constrained<S> constrained_forward_dynamics(const Model<S>& model, const std::vector<Contact<S>>& contacts, In<S> q, In<S> v,
                                            In<S> tau, In<S> wrenches = VectorX<S>(),
                                            const ConstraintOptions<S>& options = {}) {
  const Solution<VectorX<S>> free = forward_dynamics<S>(model, q, v, tau, wrenches);
  if (!free.status.ok()) return {{}, {}, free.status};
  VectorX<S> right = -constraint_bias<S>(model, contacts, q, v);
  if (options.wanted.size() > 0) right += options.wanted;
  return detail::constrained<S>(model, contacts, q, right, free.value, options);
}

// v after an impact, and its impulses: J v⁺ = −e J v, `wanted` being −e J v.
template <class S>
Constrained<S> impact(const Model<S>& model, const std::vector<Contact<S>>& contacts, In<S> q, In<S> v,
                      const ConstraintOptions<S>& options = {}) {
  const VectorX<S> right = options.wanted.size() > 0 ? options.wanted : VectorX<S>(VectorX<S>::Zero(constraint_rows(contacts)));
  return detail::constrained<S>(model, contacts, q, right, v, options);
}

}  // namespace dalembert::generic
