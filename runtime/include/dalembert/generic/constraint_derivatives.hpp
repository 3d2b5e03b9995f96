// How what keeps to constraints changes with q, v and τ.
//
// With r = ID(q, v, v̇) − Jᵀ f − τ and a = J v̇ + J̇ v − b both zero, d(v̇; f) follows from what r and a change by at v̇ and f held
// (Carpentier, Budhiraja, Mansard, "Proximal and sparse resolution of constrained dynamic equations", RSS 2021, section V):
//
//   ∂f = Λ (J M⁻¹ ∂r − ∂a)     ∂v̇ = M⁻¹ (Jᵀ ∂f − ∂r)     Λ = (J M⁻¹ Jᵀ + R)⁻¹,
//
// ∂r that of inverse dynamics with f as external wrenches, which keep to the axes and points of their rows. A row's ∂a is made
// of how the twist V and the acceleration A of its body change, for a joint above it, as seen from the base's axes as they
// stand (Ψ̇, Ψ̈: derivatives.hpp):
//
//   ∂V/∂q = Ψ̇ − V × S     ∂A/∂q = Ψ̈ − A × S − V × Ψ̇     ∂V/∂v = S     ∂A/∂v = Ψ̇ + Ṡ − V × S.
//
// They are derivatives of what solves the equations, not of proximal steps towards it. Where rows say the same twice f is one
// of many, and ∂f that change which is least in the measure of proximal steps; ∂v̇ is what it is, as long as these rows keep
// saying the same. Where they do so at one posture alone (a leg stretched to a line) there is no derivative.
#pragma once

#include <dalembert/generic/constraints.hpp>

namespace dalembert::generic {

// v̇: nv × nv each; forces: rows × nv. Of no elements unless status.ok().
template <class S>
struct ConstrainedDerivatives {
  MatrixX<S> dq, dv, dtau;
  MatrixX<S> forces_dq, forces_dv, forces_dtau;
  FactorStatus<S> status;
};

namespace detail {

// The joints above a body, a column each of all coordinates, and how the body moves: along the base's axes, about its origin, A
// less gravity.
template <class S>
struct MovedBody {
  MatrixX<S> axes, psi_dot, psi_ddot, rates;  // S, Ψ̇, Ψ̈, Ψ̇ + Ṡ; zero where no joint stands above
  Vector6<S> V, A;

  // How V and A change with q, or v.
  MatrixX<S> dV(bool by_q) const { return by_q ? MatrixX<S>(psi_dot - ad(V) * axes) : axes; }
  MatrixX<S> dA(bool by_q) const {
    return by_q ? MatrixX<S>(psi_ddot - ad(A) * axes - ad(V) * psi_dot) : MatrixX<S>(rates - ad(V) * axes);
  }
};

template <class S>
class MovedBodies {
 public:
  MovedBodies(const Model<S>& model, const State<S>& at, const VectorX<S>& v_dot)
      : model_(model), bodies_(moving_bodies<S>(model, at.kinematics, at.q, at.v, v_dot, VectorX<S>())) {
    int last = -1;
    for (int k = first(); k < model.joints(); ++k) {
      if (k < 0 || model.bodies[static_cast<size_t>(k)].part <= 0) ++last;
      part_of_.push_back(last);
    }
    gravity_ = gravity_in_base(model, at.q);
  }

  const Vector3<S>& gravity() const { return gravity_; }
  Eigen::Index coordinates() const { return model_.base_rows() + model_.joints(); }
  // body: −1 is the base.
  MovedBody<S> of(int body) const {
    const Eigen::Index n = coordinates();
    const MatrixX<S> none = MatrixX<S>::Zero(6, n);
    MovedBody<S> moved{none, none, none, none, Vector6<S>::Zero(), Vector6<S>::Zero()};
    moved.A.template head<3>() = -gravity_;
    if (body < first()) return moved;  // a base that stands
    int k = part_of_[static_cast<size_t>(body - first())];
    moved.V = bodies_[static_cast<size_t>(k)].V;
    moved.A = bodies_[static_cast<size_t>(k)].A;
    for (; k >= 0; k = bodies_[static_cast<size_t>(k)].parent) {
      const MovingBody<S>& joint = bodies_[static_cast<size_t>(k)];
      const Eigen::Index count = joint.axes.cols();
      moved.axes.middleCols(joint.row, count) = joint.axes;
      moved.psi_dot.middleCols(joint.row, count) = joint.psi_dot;
      moved.psi_ddot.middleCols(joint.row, count) = joint.psi_ddot;
      moved.rates.middleCols(joint.row, count) = joint.psi_dot + joint.axes_dot;
    }
    return moved;
  }

 private:
  int first() const { return model_.joints() - model_.moving_bodies(); }

  const Model<S>& model_;
  std::vector<MovingBody<S>> bodies_;
  std::vector<int> part_of_;
  Vector3<S> gravity_;
};

template <class S>
MatrixX<S> cross_columns(const Vector3<S>& a, const MatrixX<S>& columns) {
  return cross_matrix<S>(a) * columns;
}
template <class S>
Vector3<S> cross3(const Vector3<S>& a, const Vector3<S>& b) {
  return cross_matrix<S>(a) * b;
}

// A frame of a body in the base's axes.
template <class S>
Transform<S> frame_in_base(const State<S>& at, int body, const Transform<S>& frame) {
  return body < 0 ? frame : at.kinematics.bodies[static_cast<size_t>(body)].in_base * frame;
}

// What a contact's rows J v̇ + J̇ v change by, v̇ held: rows × coordinates.
template <class S>
MatrixX<S> contact_change(const MovedBodies<S>& bodies, const State<S>& at, const Matrix3<S>& base_axes,
                          const Contact<S>& contact, bool by_q) {
  const MovedBody<S> body = bodies.of(contact.body);
  const Transform<S> frame = frame_in_base(at, contact.body, contact.frame);
  const Vector3<S> x = frame.translation, u = body.V.template head<3>(), w = body.V.template tail<3>(),
                   alpha = body.A.template tail<3>(), rate = u + cross3<S>(w, x);
  const MatrixX<S> V = body.dV(by_q), A = body.dA(by_q), turned = body.axes.bottomRows(3);
  MatrixX<S> moved = MatrixX<S>::Zero(3, V.cols());
  if (by_q) moved = body.axes.topRows(3) - cross_columns<S>(x, turned);
  // The acceleration there that a spatial one means.
  MatrixX<S> linear = A.topRows(3) - cross_columns<S>(x, A.bottomRows(3)) + cross_columns<S>(alpha, moved),
             angular = A.bottomRows(3);
  Matrix3<S> axes = base_axes;
  if (contact.axes == Axes::body) {
    axes = frame.rotation.transpose();
    if (by_q) {
      const Vector3<S> there = body.A.template head<3>() + bodies.gravity() + cross3<S>(alpha, x);
      linear += cross_columns<S>(there, turned);
      angular += cross_columns<S>(alpha, turned);
    }
  } else {
    const MatrixX<S> rate_change = V.topRows(3) - cross_columns<S>(x, V.bottomRows(3)) + cross_columns<S>(w, moved);
    linear += cross_columns<S>(w, rate_change) - cross_columns<S>(rate, V.bottomRows(3));
  }
  MatrixX<S> rows(6, V.cols());
  rows << axes * linear, axes * angular;
  return rows.topRows(contact.rows);
}

// The same of a loop. What moves both bodies moves neither against the other.
template <class S>
MatrixX<S> loop_change(const MovedBody<S>& a, const MovedBody<S>& b, const Transform<S>& at_a, const Transform<S>& at_b,
                       const Loop<S>& loop, bool by_q) {
  const auto linear = [](const auto& six) { return six.topRows(3); };
  const auto angular = [](const auto& six) { return six.bottomRows(3); };
  const Vector3<S> x = at_b.translation, from = at_a.translation;
  const Vector3<S> ua = a.V.template head<3>(), wa = a.V.template tail<3>(), ub = b.V.template head<3>(),
                   wb = b.V.template tail<3>();
  const MatrixX<S> Va = a.dV(by_q), Vb = b.dV(by_q), Aa = a.dA(by_q), Ab = b.dA(by_q), none = MatrixX<S>::Zero(3, Va.cols());
  const auto point = [&](const MovedBody<S>& body, const Vector3<S>& at) -> MatrixX<S> {
    return by_q ? MatrixX<S>(linear(body.axes) - cross_columns<S>(at, angular(body.axes))) : none;
  };
  const MatrixX<S> moved = point(b, x), moved_from = point(a, from);
  const Vector3<S> rate = ub + cross3<S>(wb, x);
  const MatrixX<S> rate_change = linear(Vb) - cross_columns<S>(x, angular(Vb)) + cross_columns<S>(wb, moved);
  if (loop.distance > S(0)) {
    // (d·d̈ + ḋ·ḋ) / ℓ.
    const Vector3<S> rate_from = ua + cross3<S>(wa, from), d = x - from, d_dot = rate - rate_from;
    const MatrixX<S> rate_from_change = linear(Va) - cross_columns<S>(from, angular(Va)) + cross_columns<S>(wa, moved_from);
    const auto whole = [&](const MovedBody<S>& body, const Vector3<S>& at, const Vector3<S>& speed) -> Vector3<S> {
      return body.A.template head<3>() + cross3<S>(body.A.template tail<3>(), at) + cross3<S>(body.V.template tail<3>(), speed);
    };
    const auto whole_change = [&](const MovedBody<S>& body, const MatrixX<S>& V, const MatrixX<S>& A, const Vector3<S>& at,
                                  const MatrixX<S>& at_change, const Vector3<S>& speed,
                                  const MatrixX<S>& speed_change) -> MatrixX<S> {
      return linear(A) - cross_columns<S>(at, angular(A)) + cross_columns<S>(body.A.template tail<3>(), at_change) -
             cross_columns<S>(speed, angular(V)) + cross_columns<S>(body.V.template tail<3>(), speed_change);
    };
    const Vector3<S> d_ddot = whole(b, x, rate) - whole(a, from, rate_from);
    const MatrixX<S> d_ddot_change = whole_change(b, Vb, Ab, x, moved, rate, rate_change) -
                                     whole_change(a, Va, Aa, from, moved_from, rate_from, rate_from_change);
    return (d_ddot.transpose() * (moved - moved_from) + d.transpose() * d_ddot_change +
            S(2) * d_dot.transpose() * (rate_change - rate_from_change)) /
           loop.distance;
  }
  const Vector6<S> dv = b.V - a.V, da = b.A - a.A;
  const MatrixX<S> dV = Vb - Va, dA = Ab - Aa;
  const Vector3<S> w = dv.template tail<3>(), alpha = da.template tail<3>(), against = rate - ua - cross3<S>(wa, x);
  const MatrixX<S> against_change = rate_change - linear(Va) + cross_columns<S>(x, angular(Va)) - cross_columns<S>(wa, moved);
  const Vector3<S> there = da.template head<3>() + cross3<S>(alpha, x) + cross3<S>(w, rate) - cross3<S>(wa, against),
                   turning = alpha - cross3<S>(wa, w);
  MatrixX<S> l = linear(dA) - cross_columns<S>(x, angular(dA)) + cross_columns<S>(alpha, moved) -
                 cross_columns<S>(rate, angular(dV)) + cross_columns<S>(w, rate_change) +
                 cross_columns<S>(against, angular(Va)) - cross_columns<S>(wa, against_change),
             r = angular(dA) + cross_columns<S>(w, angular(Va)) - cross_columns<S>(wa, angular(dV));
  if (by_q) {  // the axes turn with a
    l += cross_columns<S>(there, angular(a.axes));
    r += cross_columns<S>(turning, angular(a.axes));
  }
  const MatrixX<S> back = at_a.rotation.transpose();
  return rows_of_loop<S, MatrixX<S>>(loop, back * l, back * r);
}

// A constraint's forces on one body, along the base's axes about its origin, and how they change with q.
template <class S>
struct HeldWrench {
  int body;
  Vector6<S> wrench;
  MatrixX<S> change;
};

template <class S>
std::vector<HeldWrench<S>> held_wrenches(const MovedBodies<S>& bodies, const State<S>& at, const Matrix3<S>& base_axes,
                                         const Constraints<S>& constraints, const VectorX<S>& forces) {
  std::vector<HeldWrench<S>> all;
  const auto about_base = [](const Vector3<S>& x, const Vector3<S>& f, const Vector3<S>& n) {
    Vector6<S> wrench;
    wrench << f, cross3<S>(x, f) + n;
    return wrench;
  };
  // d[f; x × f + n].
  const auto change = [](const Vector3<S>& x, const MatrixX<S>& dx, const Vector3<S>& f, const MatrixX<S>& df,
                         const MatrixX<S>& dn) {
    MatrixX<S> d(6, dx.cols());
    d << df, cross_columns<S>(x, df) - cross_columns<S>(f, dx) + dn;
    return d;
  };
  int row = 0;
  for (const Contact<S>& contact : constraints.contacts) {
    const MovedBody<S> body = bodies.of(contact.body);
    const Transform<S> frame = frame_in_base(at, contact.body, contact.frame);
    const bool of_link = contact.axes == Axes::body;
    const Matrix3<S> axes = of_link ? frame.rotation : Matrix3<S>(base_axes.transpose());
    const Vector3<S> x = frame.translation, f = axes * forces.segment(row, 3);
    Vector3<S> n = Vector3<S>::Zero();
    if (contact.rows == 6) n = axes * forces.segment(row + 3, 3);
    const MatrixX<S> turned = body.axes.bottomRows(3), none = MatrixX<S>::Zero(3, turned.cols()),
                     moved = body.axes.topRows(3) - cross_columns<S>(x, turned);
    all.push_back({contact.body, about_base(x, f, n),
                   change(x, moved, f, of_link ? MatrixX<S>(-cross_columns<S>(f, turned)) : none,
                          of_link ? MatrixX<S>(-cross_columns<S>(n, turned)) : none)});
    row += contact.rows;
  }
  for (const Loop<S>& loop : constraints.loops) {
    const MovedBody<S> a = bodies.of(loop.bodies[0]), b = bodies.of(loop.bodies[1]);
    const Transform<S> at_a = frame_in_base(at, loop.bodies[0], loop.frames[0]),
                       at_b = frame_in_base(at, loop.bodies[1], loop.frames[1]);
    const Vector3<S> x = at_b.translation;
    const MatrixX<S> moved = b.axes.topRows(3) - cross_columns<S>(x, b.axes.bottomRows(3));
    Vector3<S> f = Vector3<S>::Zero(), n = f;
    MatrixX<S> df, dn = MatrixX<S>::Zero(3, moved.cols());
    if (loop.distance > S(0)) {
      const S scale = forces[row] / loop.distance;
      f = scale * (x - at_a.translation);
      df = scale * (moved - a.axes.topRows(3) + cross_columns<S>(at_a.translation, a.axes.bottomRows(3)));
    } else {
      int r = row;
      for (const int i : loop.linear) f += forces[r++] * at_a.rotation.col(i);
      for (const int i : loop.angular) n += forces[r++] * at_a.rotation.col(i);
      df = -cross_columns<S>(f, a.axes.bottomRows(3));
      dn = -cross_columns<S>(n, a.axes.bottomRows(3));
    }
    const Vector6<S> wrench = about_base(x, f, n);
    const MatrixX<S> d = change(x, moved, f, df, dn);
    all.push_back({loop.bodies[0], -wrench, -d});
    all.push_back({loop.bodies[1], wrench, d});
    row += loop.rows();
  }
  return all;
}

}  // namespace detail

// tau, wrenches, options: as in constrained_forward_dynamics(), at whose v̇ and f they are. Columns of dq and dv: as in
// inverse_dynamics_derivatives(). turning: nv × nv, or of no elements: what ∂τ/∂q of inverse dynamics has more, where wrenches
// do not turn with their bodies.
template <class S>
ConstrainedDerivatives<S> constrained_derivatives(const Model<S>& model, const Constraints<S>& constraints, In<S> q, In<S> v,
                                                  In<S> tau, In<S> wrenches = VectorX<S>(),
                                                  const ConstraintOptions<S>& options = {},
                                                  const MatrixX<S>& turning = MatrixX<S>()) {
  const Constrained<S> motion = constrained_forward_dynamics<S>(model, constraints, q, v, tau, wrenches, options);
  if (!motion.status.ok()) return {{}, {}, {}, {}, {}, {}, motion.status};
  const detail::State<S> at(model, q, v);
  const VectorX<S> v_dot = at.acceleration(model, motion.value);
  const detail::MovedBodies<S> bodies(model, at, v_dot);
  const Matrix3<S> base_axes = base_pose(model, at.q).rotation;

  VectorX<S> pushed = VectorX<S>::Zero(6 * model.moving_bodies());
  if (wrenches.size() > 0) pushed = wrenches;
  MatrixX<S> more = MatrixX<S>::Zero(bodies.coordinates(), bodies.coordinates());
  for (const auto& held : detail::held_wrenches<S>(bodies, at, base_axes, constraints, motion.forces)) {
    const int place = held.body + model.moving_bodies() - model.joints();
    if (place < 0) continue;  // a base that stands
    const Transform<S> in_base = detail::frame_in_base<S>(at, held.body, Transform<S>());
    pushed.template segment<6>(6 * place) += adjoint(in_base).transpose() * held.wrench;
    const MatrixX<S> above = bodies.of(held.body).axes;
    more -= above.transpose() * (held.change - detail::cross_of_force<S>(held.wrench) * above);
  }
  const auto of_tau = expanded_derivatives<S>(model, at.kinematics, at.q, at.v, v_dot, pushed);
  MatrixX<S> rest_dq = at.reduction.reduce_matrix(of_tau.dq + more), rest_dv = at.reduction.reduce_matrix(of_tau.dv);
  if (turning.size() > 0) rest_dq += turning;

  MatrixX<S> change[2];
  for (int i = 0; i < 2; ++i) {
    change[i].resize(constraints.all_rows(), model.nv());
    const bool by_q = i == 0;
    int row = 0;
    for (const Contact<S>& contact : constraints.contacts) {
      change[i].middleRows(row, contact.rows) =
          at.reduction.reduce_columns(detail::contact_change<S>(bodies, at, base_axes, contact, by_q));
      row += contact.rows;
    }
    for (const Loop<S>& loop : constraints.loops) {
      detail::MovedBody<S> a = bodies.of(loop.bodies[0]), b = bodies.of(loop.bodies[1]);
      for (Eigen::Index k = 0; k < bodies.coordinates(); ++k) {
        if (a.axes.col(k).isZero(S(0)) || b.axes.col(k).isZero(S(0))) continue;
        for (detail::MovedBody<S>* body : {&a, &b})
          for (MatrixX<S>* columns : {&body->axes, &body->psi_dot, &body->psi_ddot, &body->rates}) columns->col(k).setZero();
      }
      change[i].middleRows(row, loop.rows()) = at.reduction.reduce_columns(
          detail::loop_change<S>(a, b, detail::frame_in_base<S>(at, loop.bodies[0], loop.frames[0]),
                                 detail::frame_in_base<S>(at, loop.bodies[1], loop.frames[1]), loop, by_q));
      row += loop.rows();
    }
  }

  const Factorisation<S> factors = detail::factorised(model, at);
  const MatrixX<S> J = constraint_jacobian<S>(model, constraints, q);
  const auto rows = detail::acting_rows<S>(constraints, J, factors, options);
  const Factorisation<S> along(rows.D);
  const MatrixX<S> acting = rows.acts.asDiagonal();
  // Λ, as proximal steps have it.
  MatrixX<S> inverse = MatrixX<S>::Zero(J.rows(), J.rows());
  for (int step = 0; step < options.steps; ++step) inverse = along.solve(MatrixX<S>(acting + rows.held.asDiagonal() * inverse));
  const MatrixX<S> transposed = rows.J.transpose(), back = inverse * factors.solve(transposed).transpose();
  ConstrainedDerivatives<S> result;
  result.status = factors.status();
  result.forces_dq = back * rest_dq - inverse * change[0];
  result.forces_dv = back * rest_dv - inverse * change[1];
  result.forces_dtau = -back;
  result.dq = factors.solve(MatrixX<S>(transposed * result.forces_dq - rest_dq));
  result.dv = factors.solve(MatrixX<S>(transposed * result.forces_dv - rest_dv));
  result.dtau = factors.solve(MatrixX<S>(transposed * result.forces_dtau + MatrixX<S>::Identity(model.nv(), model.nv())));
  return result;
}

}  // namespace dalembert::generic
