#include "passes/lower_rolled.hpp"

#include <algorithm>
#include <set>
#include <string_view>

#include "passes/equations.hpp"
#include "passes/lower.hpp"
#include "passes/lower_inputs.hpp"
#include "passes/lower_segment.hpp"
#include "passes/prune_rolled.hpp"
#include "passes/roles.hpp"

namespace dalembert::passes {
namespace {

using ir::InputKind;
using ir::Quantity;

class RolledLowering {
 public:
  RolledLowering(const ir::KinematicTree& tree, const ir::NormalTree& normal, const ir::Scene& scene, const ir::Plan& plan,
                 const ir::Graph::Options& options)
      : tree_(tree), normal_(normal), scene_(scene), plan_(plan), options_(options) {
    program_.root.graph = ir::Graph(options);
    program_.base_graph = ir::Graph(options);
  }

  ir::RolledProgram run() {
    program_.roles = make_roles();
    for (const ir::NormalBody& n : normal_.bodies) program_.all_revolute = program_.all_revolute && !n.prismatic;
    for (Quantity q : scene_.outputs) {
      program_.mass |= q == Quantity::mass_matrix;
      program_.coriolis |= q == Quantity::coriolis_matrix;
      program_.gravity |= q == Quantity::gravity && scene_.gravity_kind != ir::GravityKind::none;
      program_.bias |= q == Quantity::bias;
      program_.wrench |= q == Quantity::wrench_influence;
    }
    composite_mass_.resize(normal_.bodies.size());
    total_mass_ = normal_.base.mass;
    for (size_t k = normal_.bodies.size(); k-- > 0;) {
      composite_mass_[k] += normal_.bodies[k].moments.mass;
      const int parent = normal_.bodies[k].parent;
      (parent < 0 ? total_mass_ : composite_mass_[static_cast<size_t>(parent)]) += composite_mass_[k];
    }
    for (const ir::Segment& segment : plan_.segments) lower_segment(segment);
    base();
    prune_rolled(program_, tree_.floating_base);
    share_places(program_);
    return std::move(program_);
  }

 private:
  void lower_segment(const ir::Segment& segment) {
    program_.segments.emplace_back();
    passes::lower_segment(tree_, normal_, segment, program_, composite_mass_, options_, program_.segments.back());
    std::set<int> parents;
    for (size_t lane = 0; lane < segment.parents.size(); ++lane)
      if (segment.bodies[lane].front() >= 0) parents.insert(plan_.segment_of(segment.parents[lane]));
    program_.segments.back().parents.assign(parents.begin(), parents.end());
  }

  void root_store(int role, int component, Sym x) { program_.root.stores.push_back({role, component, x.id}); }
  void root_store(int role, const Vec3& x, int from = 0) {
    for (int i = 0; i < 3; ++i) root_store(role, from + i, x[static_cast<size_t>(i)]);
  }
  void element(std::string_view array, int row, int column, Sym x) {
    const auto arrays = output_arrays(tree_, scene_);
    for (size_t a = 0; a < arrays.size(); ++a)
      if (arrays[a].name == array && !x.graph->is_constant(x.id, 0))
        program_.base_elements.push_back({static_cast<int>(a), row, column, x.id});
  }

  // What is known at the root before the segments, and the base's own rows after them.
  void base() {
    const LowerInputs in(program_.root.graph, tree_, normal_, scene_);
    const Twist v = in.base_twist();
    const Vec3 gravity = in.gravity_in_base();
    for (int i = 0; i < 9; ++i) root_store(rotation, i, in.constant(i % 4 == 0 ? 1 : 0));
    root_store(position, in.zero());
    root_store(velocity, v.linear, 0);
    root_store(velocity, v.angular, 3);
    root_store(down, gravity);
    const Motion root{v.angular, in.zero(), cross(v.angular, v.linear) - gravity};
    root_store(motion, root.angular, 0);
    root_store(motion, root.angular_acceleration, 3);
    root_store(motion, root.acceleration, 6);
    if (!tree_.floating_base) return;

    const BodyConstants base = in.base();
    Sums s = moments({in.constant(Eigen::Matrix3d(Eigen::Matrix3d::Identity())), in.zero()}, base);
    add_velocity(s, v, base.mass, base.half_trace);
    each_sum(s, [this](int role, int i, Sym x) { root_store(role, i, x); });
    root_store(gravity_first, base.first);
    const Force f = body_force(root, base);
    root_store(force, f.force, 0);
    root_store(force, f.torque, 3);
    base_block();
  }

  void base_block() {
    ir::Graph& g = program_.base_graph;
    const LowerInputs in(g, tree_, normal_, scene_);
    const auto state = [&](int role, int i) { return Sym{&g, g.input({InputKind::state, role, i})}; };
    const auto state3 = [&](int role, int from) {
      return Vec3{state(role, from), state(role, from + 1), state(role, from + 2)};
    };
    if (program_.mass || program_.coriolis) {
      Sums s;
      for (int i = 0; i < 6; ++i) s.second[static_cast<size_t>(i)] = state(second, i);
      s.first = state3(first, 0), s.momentum = state3(momentum, 0);
      s.bias = {state3(bias_block, 0), state3(bias_block, 3), state3(bias_block, 6)};
      const Twist v = in.base_twist();
      const Sym mass = in.constant(total_mass_);
      for (size_t j = 0; j < 6; ++j) {
        const BaseColumn c = base_column(mass, s, v, j);
        for (size_t i = 0; i < 6; ++i) {
          const int row = static_cast<int>(i), column = static_cast<int>(j);
          element("mass_matrix", row, column, i < 3 ? c.inertia.linear[i] : c.inertia.angular[i - 3]);
          element("coriolis_matrix", row, column, i < 3 ? c.coriolis.linear[i] : c.coriolis.angular[i - 3]);
        }
      }
    }
    if (program_.gravity) {
      const Vec3 d = state3(down, 0), torque = cross(state3(gravity_first, 0), d);
      for (size_t i = 0; i < 3; ++i) {
        element("gravity", static_cast<int>(i), 0, -(in.constant(total_mass_) * d[i]));
        element("gravity", static_cast<int>(i) + 3, 0, -torque[i]);
      }
    }
    if (program_.bias)
      for (int i = 0; i < 6; ++i) element("bias", i, 0, state(force, i));
  }

  const ir::KinematicTree& tree_;
  const ir::NormalTree& normal_;
  const ir::Scene& scene_;
  const ir::Plan& plan_;
  const ir::Graph::Options options_;
  ir::RolledProgram program_;
  std::vector<double> composite_mass_;
  double total_mass_ = 0;
};

}  // namespace

ir::RolledProgram lower_rolled(const ir::KinematicTree& tree, const ir::NormalTree& normal, const ir::Scene& scene,
                               const ir::Plan& plan, const ir::Graph::Options& options) {
  return RolledLowering(tree, normal, scene, plan, options).run();
}

}  // namespace dalembert::passes
