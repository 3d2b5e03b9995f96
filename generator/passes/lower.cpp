#include "passes/lower.hpp"

#include <algorithm>
#include <map>

#include "ir/identifier.hpp"
#include "passes/lower_inputs.hpp"

namespace dalembert::passes {
namespace {

using ir::Quantity;

struct BodyState {
  BodyConstants constants;
  JointPosition position;
  Sym rate;
  Pose pose;
  Twist twist, joint, joint_rate;
  Sym composite_mass;
  Sums sums;
};

class Lowering {
 public:
  Lowering(const ir::KinematicTree& tree, const ir::NormalTree& normal, const ir::Scene& scene, const LowerOptions& options)
      : tree_(tree),
        normal_(normal),
        scene_(scene),
        options_(options),
        program_{ir::Graph(options.graph), tree.floating_base ? 7 : 0, output_arrays(tree, scene), {}, {}},
        in_(program_.graph, tree, normal, scene),
        coordinates_(tree.coordinates()),
        bodies_(tree.bodies.size()) {}

  ir::Program run() {
    reserve();
    for (size_t k = 0; k < bodies_.size(); ++k) inputs(k);
    if (wanted("gravity")) gravity(array("gravity"));
    if (wanted("bias")) scene_.rates_zero ? gravity(array("bias")) : bias();
    const bool poses = std::any_of(program_.arrays.begin(), program_.arrays.end(),
                                   [](const ir::OutputArray& a) { return a.name != "gravity" && a.name != "bias"; });
    if (poses) {
      phase_one();
      if (wanted("mass_matrix") || wanted("coriolis_matrix")) phases_two_and_three();
      for (size_t a = 0; a < program_.arrays.size(); ++a) jacobians(static_cast<int>(a));
    }
    flush_elements();
    return std::move(program_);
  }

 private:
  int parent(size_t k) const { return tree_.bodies[k].parent; }
  bool is_reference(size_t k) const { return parent(k) < 0 && !tree_.floating_base; }
  JointPosition at_rest() { return {in_.constant(0), in_.constant(1), in_.constant(0)}; }
  int base_rows() const { return tree_.floating_base ? 6 : 0; }
  // About the nodes of Phase III, a few dozen for every joint and joint above it: they are most of a long chain's.
  void reserve() {
    std::vector<size_t> depth(bodies_.size(), 1);
    size_t pairs = 0;
    for (size_t k = 0; k < bodies_.size(); ++k) {
      if (parent(k) >= 0) depth[k] += depth[static_cast<size_t>(parent(k))];
      pairs += depth[k];
    }
    program_.graph.reserve(pairs * ((wanted("mass_matrix") ? 12 : 0) + (wanted("coriolis_matrix") ? 32 : 0)));
  }
  void tag(int phase, int body) { program_.graph.set_tag({static_cast<std::int16_t>(phase), body}); }

  int array(std::string_view name) const {
    for (size_t i = 0; i < program_.arrays.size(); ++i)
      if (program_.arrays[i].name == name) return static_cast<int>(i);
    return -1;
  }
  bool wanted(std::string_view name) const { return array(name) >= 0; }

  // Adds to an element: a driven joint's share falls on its driver's row and column.
  void put(int array, int row, int column, Sym value) {
    if (array < 0) return;
    const auto [at, made] = elements_.try_emplace({array, column, row}, value);
    if (!made) at->second = at->second + value;
  }
  int row_of(size_t body) const { return base_rows() + coordinates_[body]; }
  Sym scaled(size_t body, Sym x) const {
    return tree_.bodies[body].driven() ? in_.constant(tree_.bodies[body].multiplier) * x : x;
  }
  void flush_elements() {
    for (const auto& [key, value] : elements_)
      if (!program_.graph.is_constant(value.id, 0))
        program_.elements.push_back({std::get<0>(key), std::get<2>(key), std::get<1>(key), value.id});
    if (options_.names) program_.names.resize(static_cast<size_t>(program_.graph.size()));
  }

  void name(Sym x, int body, const std::string& what) {
    if (!options_.names) return;
    const ir::Op op = program_.graph[x.id].op;
    if (op == ir::Op::constant || op == ir::Op::input) return;
    if (program_.names.size() <= static_cast<size_t>(x.id)) program_.names.resize(static_cast<size_t>(x.id) + 64);
    std::string& at = program_.names[static_cast<size_t>(x.id)];
    if (!at.empty()) return;
    at = what + "_" + (body < 0 ? "base" : ir::identifier(tree_.bodies[static_cast<size_t>(body)].joint));
  }
  void name(const Vec3& v, int body, const std::string& what) {
    for (size_t i = 0; i < 3; ++i) name(v[i], body, what + "xyz"[i]);
  }
  void name(const Mat3& m, int body, const std::string& what) {
    for (size_t i = 0; i < 3; ++i) name(m[i], body, what + "xyz"[i]);
  }

  void inputs(size_t k) {
    BodyState& b = bodies_[k];
    tag(1, static_cast<int>(k));
    b.constants = in_.body(k);
    b.position = in_.position(k);
    b.rate = in_.rate(k);
    name(b.position.sine, static_cast<int>(k), "sin");
    name(b.position.cosine, static_cast<int>(k), "cos");
  }

  // g_i = −J_i·[m γ; h × γ] with γ and the subtree's first moment h along the body's own axes.
  void gravity(int array) {
    std::vector<Vec3> down(bodies_.size()), first(bodies_.size());
    std::vector<Sym> mass(bodies_.size());
    tag(1, -1);
    const Vec3 base_down = in_.gravity_in_base();
    tag(2, -1);
    const BodyConstants base = in_.base();
    Vec3 base_first = base.first;
    Sym base_mass = base.mass;
    for (size_t k = 0; k < bodies_.size(); ++k) {
      tag(1, static_cast<int>(k));
      const BodyState& b = bodies_[k];
      down[k] = to_child(b.constants, b.position, parent(k) < 0 ? base_down : down[static_cast<size_t>(parent(k))]);
      name(down[k], static_cast<int>(k), "down_");
      first[k] = b.constants.first;
      mass[k] = b.constants.mass;
    }
    for (size_t k = bodies_.size(); k-- > 0;) {
      tag(2, static_cast<int>(k));
      const BodyState& b = bodies_[k];
      name(first[k], static_cast<int>(k), "h_");
      const Sym moment = difference_of_products(first[k][0], down[k][1], first[k][1], down[k][0]);
      const Sym weight = mass[k] * down[k][2];
      put(array, row_of(k), 0, scaled(k, -sum_of_products(b.constants.revolute, moment, b.constants.prismatic, weight)));
      Vec3& h = parent(k) < 0 ? base_first : first[static_cast<size_t>(parent(k))];
      Sym& m = parent(k) < 0 ? base_mass : mass[static_cast<size_t>(parent(k))];
      const Vec3 origin = b.constants.translation + b.position.displacement * column(b.constants.rotation, 2);
      const Vec3 moved = mass[k] * origin;
      h = h + to_parent(b.constants, b.position, first[k]) + moved;
      m = m + mass[k];
    }
    if (!tree_.floating_base) return;
    tag(3, -1);
    const Vec3 torque = cross(base_first, base_down);
    for (size_t i = 0; i < 3; ++i) {
      put(array, static_cast<int>(i), 0, -(base_mass * base_down[i]));
      put(array, static_cast<int>(i) + 3, 0, -torque[i]);
    }
  }

  // Recursive Newton-Euler in body axes: C v + g, with the scene's damping and friction.
  void bias() {
    const int array = this->array("bias");
    tag(1, -1);
    const Twist v = in_.base_twist();
    const Vec3 gravity = in_.gravity_in_base();
    const Motion root{v.angular, in_.zero(), cross(v.angular, v.linear) - gravity};
    std::vector<Motion> motion(bodies_.size());
    std::vector<Force> force(bodies_.size());
    Force base;
    tag(2, -1);
    if (tree_.floating_base) base = body_force(root, in_.base());
    for (size_t k = 0; k < bodies_.size(); ++k) {
      const BodyState& b = bodies_[k];
      const int n = static_cast<int>(k);
      tag(1, n);
      motion[k] = propagate(parent(k) < 0 ? root : motion[static_cast<size_t>(parent(k))], b.constants, b.position, b.rate);
      name(motion[k].angular, n, "w_");
      name(motion[k].angular_acceleration, n, "alpha_");
      name(motion[k].acceleration, n, "a_");
      tag(2, n);
      force[k] = body_force(motion[k], b.constants);
    }
    for (size_t k = bodies_.size(); k-- > 0;) {
      const BodyState& b = bodies_[k];
      const ir::Body& joint = tree_.bodies[k];
      tag(2, static_cast<int>(k));
      name(force[k].force, static_cast<int>(k), "f_");
      name(force[k].torque, static_cast<int>(k), "n_");
      Sym torque = sum_of_products(b.constants.revolute, force[k].torque[2], b.constants.prismatic, force[k].force[2]);
      torque = scaled(k, torque);
      if (!joint.driven()) {
        torque = torque + in_.constant(joint.damping) * b.rate;
        if (joint.friction != 0) {
          const Sym sign{&program_.graph, program_.graph.sign(b.rate.id)};
          torque = torque + in_.constant(joint.friction) * sign;
        }
      }
      put(array, row_of(k), 0, torque);
      if (parent(k) < 0 && !tree_.floating_base) continue;
      Force& to = parent(k) < 0 ? base : force[static_cast<size_t>(parent(k))];
      const Vec3 origin = b.constants.translation + b.position.displacement * column(b.constants.rotation, 2);
      const Vec3 f = to_parent(b.constants, b.position, force[k].force);
      const Vec3 lever = cross(origin, f);
      to.torque = to.torque + to_parent(b.constants, b.position, force[k].torque) + lever;
      to.force = to.force + f;
    }
    if (!tree_.floating_base) return;
    for (size_t i = 0; i < 3; ++i) {
      put(array, static_cast<int>(i), 0, base.force[i]);
      put(array, static_cast<int>(i) + 3, 0, base.torque[i]);
    }
  }

  void phase_one() {
    const Mat3 identity = in_.constant(Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
    const Pose origin{identity, in_.zero()};
    const Twist base = in_.base_twist();
    for (size_t k = 0; k < bodies_.size(); ++k) {
      BodyState& b = bodies_[k];
      const int n = static_cast<int>(k);
      tag(1, n);
      const bool top = parent(k) < 0;
      const BodyState* above = top ? nullptr : &bodies_[static_cast<size_t>(parent(k))];
      // On a fixed base the first body's frame is the reference: what is before it cannot change M and C.
      const JointPosition position = tree_.carries_reference(k) ? at_rest() : b.position;
      b.pose = is_reference(k) ? origin : pose(top ? origin : above->pose, b.constants, position);
      b.joint = joint_twist(b.pose, b.constants);
      b.twist = body_twist(top ? base : above->twist, b.joint, b.rate);
      b.joint_rate = joint_twist_rate(top ? base : above->twist, b.joint);
      name(b.pose.rotation, n, "R_");
      name(b.pose.position, n, "p_");
      name(b.joint.linear, n, "J_");
      name(b.twist.linear, n, "u_");
      name(b.twist.angular, n, "w_");
      name(b.joint_rate.linear, n, "dJ_");
      name(b.joint_rate.angular, n, "dJw_");
    }
  }

  void phases_two_and_three() {
    const int mass = array("mass_matrix"), coriolis = array("coriolis_matrix");
    const Twist base_twist = in_.base_twist();
    BodyState base;
    if (tree_.floating_base) {
      tag(2, -1);
      base.constants = in_.base();
      base.composite_mass = base.constants.mass;
      base.pose = {in_.constant(Eigen::Matrix3d(Eigen::Matrix3d::Identity())), in_.zero()};
      base.sums = moments(base.pose, base.constants);
      add_velocity(base.sums, base_twist, base.constants.mass, base.constants.half_trace);
    }
    std::vector<bool> has_children(bodies_.size(), false);
    for (size_t k = bodies_.size(); k-- > 0;) {
      BodyState& b = bodies_[k];
      const int n = static_cast<int>(k);
      tag(2, n);
      Sums own = moments(b.pose, b.constants);
      add_velocity(own, b.twist, b.constants.mass, b.constants.half_trace);
      b.sums = has_children[k] ? own + b.sums : own;
      b.composite_mass = has_children[k] ? b.constants.mass + b.composite_mass : b.constants.mass;
      tag(3, n);
      name(b.sums.first, n, "h_");
      name(b.sums.momentum, n, "P_");
      name(b.sums.bias, n, "D_");
      const Twist f = apply_inertia(b.composite_mass, b.sums, b.joint);
      const Twist g_inertia = apply_inertia(b.composite_mass, b.sums, b.joint_rate);
      const Twist g_bias = apply_bias(b.sums, b.joint);
      const JointForces forces{
          f, {g_inertia.linear + g_bias.linear, g_inertia.angular + g_bias.angular}, apply_bias_transposed(b.sums, b.joint)};
      name(f.linear, n, "F_");
      name(f.angular, n, "Fw_");
      name(forces.bias.linear, n, "G_");
      name(forces.bias.angular, n, "Gw_");
      name(forces.transposed, n, "H_");
      for (int i = n; i >= 0; i = parent(static_cast<size_t>(i))) {
        const auto a = static_cast<size_t>(i);
        const BodyState& above = bodies_[a];
        const int row = row_of(a), col = row_of(k);
        Sym m = scaled(a, scaled(k, element(f, above.joint)));
        if (a == k && tree_.bodies[k].armature != 0 && !tree_.bodies[k].driven())
          m = m + in_.constant(tree_.bodies[k].armature);
        put(mass, row, col, m);
        put(coriolis, row, col, scaled(a, scaled(k, element(forces.bias, above.joint))));
        if (a == k) continue;
        put(mass, col, row, m);
        put(coriolis, col, row, scaled(a, scaled(k, element_below(forces, above.joint, above.joint_rate))));
      }
      if (tree_.floating_base) base_elements(k, forces, base_twist);
      if (parent(k) < 0 && !tree_.floating_base) continue;
      tag(2, n);
      const bool top = parent(k) < 0;
      BodyState& to = top ? base : bodies_[static_cast<size_t>(parent(k))];
      const bool first = !top && !has_children[static_cast<size_t>(parent(k))];
      to.sums = first ? b.sums : to.sums + b.sums;
      to.composite_mass = first ? b.composite_mass : to.composite_mass + b.composite_mass;
      if (!top) has_children[static_cast<size_t>(parent(k))] = true;
    }
    if (tree_.floating_base) base_block(base, base_twist);
  }

  // Columns and rows of the base for joint k: M_BJ = F, C_BJ = G, C_JB = ad(V)ᵀ F + H.
  void base_elements(size_t k, const JointForces& forces, const Twist& v) {
    const int mass = array("mass_matrix"), coriolis = array("coriolis_matrix"), row = row_of(k);
    const Vec3 below_linear = cross(forces.inertia.linear, v.angular);
    const Vec3 turning = cross(forces.inertia.angular, v.angular);
    const Vec3 below_angular = cross(forces.inertia.linear, v.linear) + turning + forces.transposed;
    for (size_t i = 0; i < 3; ++i) {
      const int linear = static_cast<int>(i), angular = linear + 3;
      for (const auto& [r, f, g, h] :
           {std::tuple{linear, forces.inertia.linear[i], forces.bias.linear[i], below_linear[i]},
            std::tuple{angular, forces.inertia.angular[i], forces.bias.angular[i], below_angular[i]}}) {
        put(mass, r, row, scaled(k, f));
        put(mass, row, r, scaled(k, f));
        put(coriolis, r, row, scaled(k, g));
        put(coriolis, row, r, scaled(k, h));
      }
    }
  }

  // M_BB = A*_0, C_BB = A*_0 ad(V) + B*_0, column by column.
  void base_block(const BodyState& base, const Twist& v) {
    tag(3, -1);
    for (size_t j = 0; j < 6; ++j) {
      const BaseColumn c = base_column(base.composite_mass, base.sums, v, j);
      for (size_t i = 0; i < 6; ++i) {
        const int row = static_cast<int>(i), column = static_cast<int>(j);
        put(array("mass_matrix"), row, column, i < 3 ? c.inertia.linear[i] : c.inertia.angular[i - 3]);
        put(array("coriolis_matrix"), row, column, i < 3 ? c.coriolis.linear[i] : c.coriolis.angular[i - 3]);
      }
    }
  }

  // Body Jacobians: the twist of a frame fixed to body `body`, in that frame's axes, per unit rate of every joint above it.
  void frame_jacobian(int array, int body, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation, bool transposed,
                      int offset) {
    tag(3, body);
    Pose frame{in_.constant(rotation), in_.constant(translation)};
    if (body >= 0) {
      const Pose& p = bodies_[static_cast<size_t>(body)].pose;
      frame = {p.rotation * frame.rotation, p.position + p.rotation * frame.position};
    }
    const auto put_column = [&](int row, Sym scale, const Twist& joint) {
      const Vec3 linear = transpose(frame.rotation) * (joint.linear + cross(joint.angular, frame.position));
      const Vec3 angular = transpose(frame.rotation) * joint.angular;
      for (size_t i = 0; i < 6; ++i) {
        const Sym x = scale * (i < 3 ? linear[i] : angular[i - 3]);
        transposed ? put(array, row, offset + static_cast<int>(i), x) : put(array, static_cast<int>(i), row, x);
      }
    };
    for (int i = body; i >= 0; i = parent(static_cast<size_t>(i))) {
      const auto a = static_cast<size_t>(i);
      put_column(row_of(a), scaled(a, in_.constant(1)), bodies_[a].joint);
    }
    for (size_t j = 0; j < 6 && tree_.floating_base; ++j) {
      Twist unit{in_.zero(), in_.zero()};
      (j < 3 ? unit.linear : unit.angular)[j % 3] = in_.constant(1);
      put_column(static_cast<int>(j), in_.constant(1), unit);
    }
  }

  void jacobians(int array) {
    const std::string& name = program_.arrays[static_cast<size_t>(array)].name;
    if (name == "wrench_influence") {
      const int first = tree_.floating_base ? -1 : 0;
      for (int b = first; b < tree_.joints(); ++b) {
        const ir::NormalBody* n = b < 0 ? nullptr : &normal_.bodies[static_cast<size_t>(b)];
        frame_jacobian(array, b, n ? n->link_rotation : Eigen::Matrix3d(Eigen::Matrix3d::Identity()),
                       n ? n->link_translation : Eigen::Vector3d(Eigen::Vector3d::Zero()), true, 6 * (b - first));
      }
    }
    for (const std::string& wanted : scene_.jacobians)
      for (const ir::LinkPlacement& link : tree_.links) {
        if (link.link != wanted || name != "jacobian_" + ir::identifier(wanted)) continue;
        Eigen::Isometry3d at = link.placement;
        if (link.body >= 0) {
          const ir::NormalBody& n = normal_.bodies[static_cast<size_t>(link.body)];
          at.linear() = n.link_rotation * link.placement.linear();
          at.translation() = n.link_rotation * link.placement.translation() + n.link_translation;
        }
        frame_jacobian(array, link.body, at.linear(), at.translation(), false, 0);
      }
  }

  const ir::KinematicTree& tree_;
  const ir::NormalTree& normal_;
  const ir::Scene& scene_;
  const LowerOptions& options_;
  ir::Program program_;
  LowerInputs in_;
  std::vector<int> coordinates_;
  std::vector<BodyState> bodies_;
  std::map<std::tuple<int, int, int>, Sym> elements_;  // array, column, row
};

}  // namespace

std::vector<ir::OutputArray> output_arrays(const ir::KinematicTree& tree, const ir::Scene& scene) {
  std::vector<ir::OutputArray> arrays;
  const int nv = tree.nv(), bodies = tree.joints() + (tree.floating_base ? 1 : 0);
  for (Quantity quantity : scene.outputs) {
    const std::string name(ir::name_of(quantity));
    switch (quantity) {
      case Quantity::mass_matrix:
      case Quantity::coriolis_matrix: arrays.push_back({name, nv, nv}); break;
      case Quantity::gravity:
      case Quantity::bias: arrays.push_back({name, nv, 1}); break;
      case Quantity::wrench_influence: arrays.push_back({name, nv, 6 * bodies}); break;
    }
  }
  for (const std::string& link : scene.jacobians) arrays.push_back({"jacobian_" + ir::identifier(link), 6, nv});
  return arrays;
}

ir::Program lower(const ir::KinematicTree& tree, const ir::NormalTree& normal, const ir::Scene& scene,
                  const LowerOptions& options) {
  return Lowering(tree, normal, scene, options).run();
}

}  // namespace dalembert::passes
