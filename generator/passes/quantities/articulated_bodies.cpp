// Articulated bodies (Featherstone 2008, ch. 7) as a factorisation of M along the tree: M = L' D L, where D_k is the inertia
// that joint k feels when all joints beyond it are free, and L_ki = V_k.J_i. With composite inertias at hand the articulated
// ones are A* less a sum K over the subtree,
//
//   U = F - K J, D = U.J, V = U / D, K_p += K + U V',
//
// and velocities and gravity enter through the bias alone: what is solved for is dv = M^-1 (tau - (C v + g)).
#include "passes/quantities/complete_guard.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Shape;

namespace {

// K: its blocks [linear, coupling; coupling', angular].
struct BlockRoles {
  int linear, coupling, angular;
};
struct Blocks {
  Sym6 linear;
  Mat3 coupling;
  Sym6 angular;
};

BlockRoles block_roles(Builder& b, const std::string& name, const std::string& symbol, const std::string& of) {
  return {b.role({name + "_linear", symbol + "l", "K of " + of + ", linear block", "kg", Shape::symmetric}),
          b.role({name + "_coupling", symbol + "c", "K of " + of + ", linear by angular", "kg m", Shape::matrix}),
          b.role({name + "_angular", symbol + "a", "K of " + of + ", angular block", "kg m^2", Shape::symmetric})};
}

template <class Three, class One>
Blocks blocks(const BlockRoles& r, const Three& three, const One& one) {
  Blocks k;
  for (int i = 0; i < 6; ++i) k.linear[static_cast<std::size_t>(i)] = one(r.linear, i);
  for (int i = 0; i < 3; ++i) k.coupling[static_cast<std::size_t>(i)] = three(r.coupling, 3 * i);
  for (int i = 0; i < 6; ++i) k.angular[static_cast<std::size_t>(i)] = one(r.angular, i);
  return k;
}

Twist operator*(const Blocks& k, const Twist& x) {
  const Vec3 coupled = k.coupling * x.angular, linear = full(k.linear) * x.linear + coupled;
  const Vec3 back = transpose(k.coupling) * x.linear;
  return {linear, full(k.angular) * x.angular + back};
}

// K + a b', the product being symmetric.
Blocks plus_product(Blocks k, const Twist& a, const Twist& b) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = i; j < 3; ++j) {
      k.linear[sym6_index[i][j]] = k.linear[sym6_index[i][j]] + a.linear[i] * b.linear[j];
      k.angular[sym6_index[i][j]] = k.angular[sym6_index[i][j]] + a.angular[i] * b.angular[j];
    }
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) k.coupling[i][j] = k.coupling[i][j] + a.linear[i] * b.angular[j];
  return k;
}

template <class Put>
void each(const Blocks& k, const BlockRoles& r, const Put& put) {
  for (int i = 0; i < 6; ++i) put(r.linear, i, k.linear[static_cast<std::size_t>(i)]);
  for (int i = 0; i < 9; ++i) put(r.coupling, i, k.coupling[static_cast<std::size_t>(i / 3)][static_cast<std::size_t>(i % 3)]);
  for (int i = 0; i < 6; ++i) put(r.angular, i, k.angular[static_cast<std::size_t>(i)]);
}

Sym& entry(Twist& x, int i) {
  return i < 3 ? x.linear[static_cast<std::size_t>(i)] : x.angular[static_cast<std::size_t>(i - 3)];
}

Sym inverse(Sym x) { return {x.graph, x.graph->divide(x.graph->constant(1), x.id)}; }

// The base's own factors: L' D L of what K leaves of A*, from the last coordinate to the first.
struct BaseFactors {
  std::array<Sym, 6> pivot, inverse_pivot, diagonal;
  std::array<std::array<Sym, 6>, 6> row;  // row[k][i]: L_ki, i < k
};
BaseFactors base_factors(Sym mass, const Sums& sums, const Blocks& removed, SweepBuilder& s) {
  BaseFactors f;
  std::array<Twist, 6> column;
  for (int k = 0; k < 6; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Twist unit = unit_twist(s, k), whole = apply_inertia(mass, sums, unit), less = removed * unit;
    Twist w = whole;
    f.diagonal[at] = entry(w, k);
    column[at] = {whole.linear - less.linear, whole.angular - less.angular};
  }
  for (int k = 5; k >= 0; --k) {
    const auto at = static_cast<std::size_t>(k);
    f.pivot[at] = entry(column[at], k);
    f.inverse_pivot[at] = inverse(f.pivot[at]);
    for (int i = 0; i < k; ++i) f.row[at][static_cast<std::size_t>(i)] = entry(column[at], i) * f.inverse_pivot[at];
    for (int j = 0; j < k; ++j)
      for (int i = 0; i <= j; ++i) {
        Sym& x = entry(column[static_cast<std::size_t>(j)], i);
        x = x - f.row[at][static_cast<std::size_t>(i)] * entry(column[at], j);
      }
  }
  return f;
}

// C v + g of the base: force and moment in its axes.
Twist base_bias(Builder& b, SweepBuilder& base) {
  if (!bias_is_gravity(b)) {
    const int wrench = newton_euler(b, Driven::at_rest).subtree_wrench;
    return {base.own3(wrench, 0), base.own3(wrench, 3)};
  }
  const GravityRoles g = gravity_torques(b);
  const Vec3 down = base.own3(g.down), turning = cross(base.own3(g.first), down);
  return {-(base.own(g.mass) * down), -turning};
}

BlockRoles removed_below(Builder& b) { return block_roles(b, "removed_below", "K", "the subtree"); }

BaseFactors base_factors_of(Builder& b, SweepBuilder& base) {
  const BlockRoles total = removed_below(b);
  const Blocks removed = blocks(
      total, [&](int role, int from) { return base.own3(role, from); }, [&](int role, int i) { return base.own(role, i); });
  const Sums sums = sums_of(base, subtree_sums(b));
  return base_factors(base.own(composite_mass(b)), sums, removed, base);
}

}  // namespace

Articulated articulated_bodies(Builder& b) {
  const Poses p = poses(b);
  const int force = forces(b).inertia;
  const BlockRoles handed = block_roles(b, "removed", "Kh", "the descendants"), total = removed_below(b);
  const Articulated r{b.role({"gain", "V", "V = U / D", "1, m per unit of the coordinate", Shape::wrench}),
                      b.role({"inverse_pivot", "Dinv", "1 / D", "1/kg or 1/(kg m^2)", Shape::scalar}),
                      b.role({"pivot", "D", "D", "kg or kg m^2", Shape::scalar}),
                      b.role({"diagonal", "Mkk", "M_kk", "kg or kg m^2", Shape::scalar})};
  if (b.has("articulated")) return r;
  SweepBuilder s = b.sweep("articulated", "U = F - K J, D = U.J, V = U / D; K_p += K + U V'", Direction::inwards);
  const Blocks below = blocks(
      handed, [&](int role, int from) { return s.carried3(role, from); }, [&](int role, int i) { return s.carried(role, i); });
  each(below, total, [&](int role, int i, Sym x) { s.store(role, i, x); });
  const Twist joint = joint_of(s, p), whole{s.own3(force, 0), s.own3(force, 3)}, less = below * joint;
  const Twist u{whole.linear - less.linear, whole.angular - less.angular};
  const Sym armature = s.parameter(b.armature()), pivot = element(u, joint) + armature, inverse_pivot = inverse(pivot);
  const Twist v{inverse_pivot * u.linear, inverse_pivot * u.angular};
  s.store(r.gain, v);
  s.store(r.inverse_pivot, inverse_pivot);
  s.store(r.pivot, pivot);
  s.store(r.diagonal, element(whole, joint) + armature);
  each(plus_product(below, u, v), handed, [&](int role, int i, Sym x) { s.hand_on(role, i, x); });
  if (b.base_coordinates() == 0) return r;

  SweepBuilder base = b.sweep_of_base("articulated_base", "L' D L = A* - K");
  const BaseFactors f = base_factors_of(b, base);
  for (int k = 0; k < 6; ++k) {
    const auto at = static_cast<std::size_t>(k);
    for (int i = 0; i < 6; ++i)
      base.store(r.gain, i, i < k ? f.row[at][static_cast<std::size_t>(i)] : base.constant(i == k ? 1 : 0), k);
    base.store(r.inverse_pivot, 0, f.inverse_pivot[at], k);
    base.store(r.pivot, 0, f.pivot[at], k);
    base.store(r.diagonal, 0, f.diagonal[at], k);
  }
  return r;
}

void guard(Builder& b, int array) {
  if (!b.guard() && !b.section().is_first()) {
    b.guard() = ir::Guard{-1, -1, {}};
  } else if (!b.guard() && b.factors()) {
    mass_matrix_factor(b);
  } else if (!b.guard()) {
    const Articulated a = articulated_bodies(b);
    b.guard() = ir::Guard{b.internal_array(b.own_name("pivots"), b.tree().nv(), 1),
                          b.internal_array(b.own_name("diagonal"), b.tree().nv(), 1),
                          {}};
    b.result({b.guard()->pivots, ir::Layout::per_coordinate, a.pivot});
    b.result({b.guard()->diagonal, ir::Layout::per_coordinate, a.diagonal});
  }
  b.guard()->arrays.push_back(array);
}

GainArrays gain_arrays(Builder& b) {
  if (const int made = b.array_called(b.own_name("gain")); made >= 0) return {made, b.array_called(b.own_name("joint"))};
  const Articulated a = articulated_bodies(b);
  const Poses p = poses(b);
  const GainArrays arrays{b.internal_array(b.own_name("gain"), 6, b.tree().nv()),
                          b.internal_array(b.own_name("joint"), 6, b.tree().nv())};
  b.result({arrays.gain, ir::Layout::columns, a.gain});
  b.result({arrays.joint, ir::Layout::columns, p.joint_linear});
  b.result({arrays.joint, ir::Layout::columns, p.joint_angular, 3});
  return arrays;
}

void complete_guard(Builder& b) {
  if (!b.guard() || b.guard()->factor >= 0) return;
  const GainArrays arrays = gain_arrays(b);
  b.guard()->gain = arrays.gain;
  b.guard()->joint = arrays.joint;
}

SolvedRoles solved_accelerations(Builder& b) {
  const Poses p = poses(b);
  const Articulated a = articulated_bodies(b);
  const int own_forces = bias_is_gravity(b) ? gravity_torques(b).torque : newton_euler(b, Driven::at_rest).torque;
  const int bias = less_external(b, own_forces), external = external_wrenches(b);
  const int solved = b.role({"solved_acceleration", "ddq", "dv", "m/s^2 or rad/s^2", Shape::scalar});
  const int handed = b.role({"reaction", "ph", "reaction of the descendants", "N, N m", Shape::wrench});
  const int total = b.role({"reaction_below", "p", "reaction of the subtree", "N, N m", Shape::wrench});
  const int start = b.role({"free_acceleration", "ddq0", "dv with the parent at rest", "m/s^2 or rad/s^2", Shape::scalar});
  const int motion =
      b.role({"solved_twist", "dV", "dV of the body, what velocities alone cause left out", "m/s^2, rad/s^2", Shape::wrench});
  const SolvedRoles roles{solved, motion, start};
  if (b.has("residuals")) return roles;

  SweepBuilder in = b.sweep("residuals", "e = tau - (C v + g) - p.J, ddq0 = e / D; p_p += p + V e", Direction::inwards);
  const Twist reaction{in.carried3(handed, 0), in.carried3(handed, 3)}, joint = joint_of(in, p);
  in.store(total, reaction);
  const Sym reacting = element(reaction, joint), biased = in.own(bias), residual = in.effort() - biased - reacting;
  in.store(start, residual * in.own(a.inverse_pivot));
  const Twist gain{in.own3(a.gain, 0), in.own3(a.gain, 3)};
  in.hand_on(handed, reaction.linear + residual * gain.linear, 0);
  in.hand_on(handed, reaction.angular + residual * gain.angular, 3);

  SweepBuilder base = b.sweep_of_base("base_solve", "dV = (A* - K)^-1 (tau - (C v + g) - p)");
  Twist x{base.zero(), base.zero()};
  if (b.base_coordinates() > 0) {
    const BaseFactors f = base_factors_of(b, base);
    const Twist effort = base.base_effort(), own_bias = base_bias(b, base);
    const Vec3 below = base.own3(total, 0);
    x.linear = effort.linear - own_bias.linear - below;
    const Vec3 turning_below = base.own3(total, 3);
    x.angular = effort.angular - own_bias.angular - turning_below;
    if (external >= 0) x = {x.linear + base.own3(external, 0), x.angular + base.own3(external, 3)};
    for (int k = 5; k >= 0; --k)
      for (int i = 0; i < k; ++i)
        entry(x, i) = entry(x, i) - f.row[static_cast<std::size_t>(k)][static_cast<std::size_t>(i)] * entry(x, k);
    for (int k = 0; k < 6; ++k) {
      entry(x, k) = f.inverse_pivot[static_cast<std::size_t>(k)] * entry(x, k);
      base.store(start, 0, entry(x, k), k);
      for (int i = 0; i < k; ++i)
        entry(x, k) = entry(x, k) - f.row[static_cast<std::size_t>(k)][static_cast<std::size_t>(i)] * entry(x, i);
      base.store(solved, 0, entry(x, k), k);
    }
  }
  base.store(motion, x);

  SweepBuilder out = b.sweep("accelerate", "ddq = ddq0 - V.dV_p, dV = dV_p + J ddq", Direction::outwards);
  const Twist above{out.carried3(motion, 0), out.carried3(motion, 3)}, own_gain{out.own3(a.gain, 0), out.own3(a.gain, 3)};
  const Sym taken = element(own_gain, above), acceleration = out.own(start) - taken;
  out.store(solved, acceleration);
  out.store(motion, body_twist(above, joint_of(out, p), acceleration));
  return roles;
}

}  // namespace dalembert::passes
