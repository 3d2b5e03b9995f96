// Writes algorithms: what the files of passes/quantities/ say their sweeps, pairs and results with.
//
//   Builder& b = …;
//   const int down = b.role({"down", "down", "gravity along the body's axes", "m/s^2", ir::Shape::vector});
//   SweepBuilder s = b.sweep("falling", "down = (Rk Rz(q))' down_p", ir::Direction::outwards);
//   s.store(down, to_child(s.body(), s.position(), s.carried3(down)));
//
// Roles and sweeps are known by their names: what two quantities share they ask for by the same name, and it is there once.
#pragma once

#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "ir/algorithm.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/normal_tree.hpp"
#include "ir/scene.hpp"
#include "passes/equations.hpp"
#include "passes/parameters.hpp"

namespace dalembert::passes {

class Builder;

// The graph of one sweep while it is written. Inputs are the body's; see ir::Input for where they come from.
class SweepBuilder {
 public:
  SweepBuilder(Builder& builder, std::size_t sweep) : builder_(builder), sweep_(sweep) {}
  // What it has the other way (ir::Back): stores go to the body above the one that is read, those at_reference() to itself.
  SweepBuilder back();
  SweepBuilder at_reference() const { return {builder_, sweep_, Part::at_reference}; }

  Sym constant(double value);
  Vec3 constant(const Eigen::Vector3d& v) { return {constant(v[0]), constant(v[1]), constant(v[2])}; }
  Mat3 constant(const Eigen::Matrix3d& m);
  Vec3 zero() { return constant(Eigen::Vector3d(Eigen::Vector3d::Zero())); }

  Sym parameter(int parameter) { return input(ir::InputKind::parameter, parameter); }
  Vec3 parameter3(int first) { return {parameter(first), parameter(first + 1), parameter(first + 2)}; }
  Mat3 parameter9(int first) { return {parameter3(first), parameter3(first + 3), parameter3(first + 6)}; }
  BodyConstants body(bool reference = false);  // `reference`: with the frames that poses are made of
  JointPosition position(bool reference = false);
  // Where joints have quaternions: the motion of the body against the one above it, along its own axes.
  Twist joint_twist();
  Sym coordinate();  // of the joint, rad or m
  Sym rate();
  Sym acceleration();  // of the joint, as inverse dynamics takes it
  Sym effort();        // on the joint, as forward dynamics takes it
  // Of moments: those of a branch's first body may count at its joint's axis (axis_inertia_p).
  void leave_first_to_its_joint() { sweep().first_at_its_joint = true; }

  // A role of the body.
  Sym own(int role, int component = 0) { return input(ir::InputKind::state, role, component); }
  Vec3 own3(int role, int from = 0) { return three(ir::InputKind::state, role, from, -1); }
  Mat3 own9(int role) { return {own3(role, 0), own3(role, 3), own3(role, 6)}; }
  // Of the parent (outwards), or what the children hand on, summed (inwards).
  Sym carried(int role, int component = 0) { return input(ir::InputKind::carried, role, component); }
  Vec3 carried3(int role, int from = 0) { return three(ir::InputKind::carried, role, from, -1); }
  // Of a given body (−1: the base).
  Sym of(int body, int role, int component = 0) { return input(ir::InputKind::of_body, role, component, body); }
  Vec3 of3(int body, int role, int from = 0) { return three(ir::InputKind::of_body, role, from, body); }

  Twist base_twist();                             // v's first six; of a base that does not move, and in statics: zero
  Twist base_acceleration();                      // the first six of dv/dt, or zero
  Twist base_effort();                            // the first six of tau, or zero
  Twist external(int wrench);                     // of the scene's wrenches: force and moment as they are given
  Sym constraint(int constraint, int component);  // what it is given at run time (ir/contact.hpp); loops behind contacts
  Sym element(int array, int element);            // of an array that a section before has filled
  Mat3 base_axes();                               // in the world; of a fixed base the world's
  Vec3 base_position();                           // in the world; of a fixed base zero
  Vec3 gravity_in_base();                         // along the base's axes: the world's on a fixed base
  Vec3 gravity_in_world();

  // `coordinate`: over the base, for a role of one of its coordinates.
  void store(int role, int component, Sym x, int coordinate = -1);
  void store(int role, Sym x) { store(role, 0, x); }
  void store(int role, const Vec3& x, int from = 0, int coordinate = -1);
  void store(int role, const Twist& x, int coordinate = -1);
  void hand_on(int role, int component, Sym x);
  void hand_on(int role, const Vec3& x, int from = 0);

 private:
  enum class Part { whole, back, at_reference };

  SweepBuilder(Builder& builder, std::size_t sweep, Part part) : builder_(builder), sweep_(sweep), part_(part) {}
  ir::Sweep& sweep();
  ir::Graph& graph();
  Sym input(ir::InputKind kind, int index, int component = 0, int body = -1);
  Vec3 three(ir::InputKind kind, int role, int from, int body);
  Twist first_six(ir::InputKind kind);

  Builder& builder_;
  std::size_t sweep_;
  Part part_ = Part::whole;
};

// What a description is for.
struct Purpose {
  bool in_one_section = false;  // nothing is to stand behind the first section that can do without, though it may take longer
  bool line = false;            // no loops are made of it: parameters that few bodies have cost nothing
};

class Builder {
 public:
  // References the trees and the scene.
  Builder(const ir::EmittedFunction& function, const ir::KinematicTree& tree, const ir::NormalTree& normal,
          const ir::Scene& scene, ir::Solver solver, const ir::Graph::Options& options, Purpose purpose = {})
      : tree_(tree), normal_(normal), scene_(scene), solver_(solver), options_(options), purpose_(purpose) {
    algorithm_.function = function;
    algorithm_.section = {0, function.name, function.type, function.inputs, function.quantities};
  }

  const ir::KinematicTree& tree() const { return tree_; }
  const ir::NormalTree& normal() const { return normal_; }
  const ir::Scene& scene() const { return scene_; }
  const ir::EmittedFunction& function() const { return algorithm_.function; }
  const ir::Section& section() const { return algorithm_.section; }
  bool computes(ir::Quantity quantity) const { return algorithm_.section.computes(quantity); }  // in this section
  // Of an array that is no output.
  std::string own_name(const std::string& name) const { return algorithm_.own_name(name); }
  // On a fixed base the first joints carry the frame of reference: what does not change with their angles is cheaper so.
  bool moves_reference() const { return base_coordinates() == 0; }
  // Whether D has the half traces of the paper's C; derivatives are made of the D of Christoffel symbols.
  bool half_traces() const { return scene_.coriolis == ir::Coriolis::balance && computes(ir::Quantity::coriolis_matrix); }
  int base_coordinates() const { return tree_.base_coordinates(); }

  // The role of that name; made from `role` where there is none yet.
  int role(const ir::Role& role);
  const ir::Role& role_of(int role) const { return algorithm_.roles[static_cast<std::size_t>(role)]; }
  // Whether there is a sweep of that name.
  bool has(const std::string& sweep) const;
  bool has_array(const std::string& name) const { return array_called(name) >= 0; }
  int array_called(const std::string& name) const;  // -1: there is none
  SweepBuilder sweep(const std::string& name, const std::string& equation, ir::Direction direction,
                     ir::BodySet over = ir::BodySet::all());
  SweepBuilder sweep_of_base(const std::string& name, const std::string& equation);  // over the base alone
  int array(const std::string& name, int rows, int columns);
  // Of a part of a result: with the maps of ir::OutputArray, empty where all are asked for.
  int array_of_part(const std::string& name, int rows, int columns, std::vector<int> row_map, std::vector<int> column_map);
  // One that is no output.
  int internal_array(const std::string& name, int rows, int columns);
  int internal_array_of_part(const std::string& name, int rows, int columns, std::vector<int> row_map,
                             std::vector<int> column_map);
  std::optional<ir::Guard>& guard() { return algorithm_.guard; }
  bool fills(int array) const;  // whether there are pairs for it
  void pairs(const ir::Pairs& pairs) { algorithm_.pairs.push_back(pairs); }
  void projection(const ir::Projection& projection) { algorithm_.projections.push_back(projection); }
  ir::Graph new_graph() const { return ir::Graph(options_); }
  // The first kernel of one of the kinds, in this section or one before.
  std::optional<ir::Kernel> made(std::initializer_list<ir::Kernel::Kind> kinds) const;
  // Whether equations with M are solved by M's factors: joints driven by others cannot be eliminated body by body, and where
  // the factors are asked for they serve all that is solved.
  bool factors() const;
  const Purpose& purpose() const { return purpose_; }
  // Whether a branch may have the frame of any of its bodies for its frame of reference (passes/reference.hpp).
  bool chooses_reference() const { return moves_reference() && purpose_.line; }
  int armature() const { return chooses_reference() ? axis_inertia_p : armature_p; }  // on M's diagonal
  // Where others than M and C ask for the moments of a branch's first body.
  void keep_moments_of_first() { keeps_moments_of_first_ = true; }
  void solve_by(int factor) { algorithm_.factor = factor; }
  // The array of a quantity that the function computes.
  int output(ir::Quantity quantity);
  void kernel(const ir::Kernel& kernel) { algorithm_.kernels.push_back(kernel); }
  void result(const ir::Result& result) { algorithm_.results.push_back(result); }

  // Of a quantity: that its sweeps wait for arrays that kernels of this section fill, and how it is described in a section
  // behind, which is called `name`. accelerations, forces: as in ir::Section.
  void behind(const std::string& name, const std::string& type, int accelerations, int forces, ir::Quantity quantity,
              const std::function<void(Builder&)>& describe);
  // All sections: the one described so far, and those behind it.
  std::vector<ir::Algorithm> take();

 private:
  friend class SweepBuilder;
  struct Behind {
    ir::Section section;
    ir::Quantity quantity;
    std::function<void(Builder&)> describe;
  };
  void end_section(ir::Algorithm next);

  const ir::KinematicTree& tree_;
  const ir::NormalTree& normal_;
  const ir::Scene& scene_;
  const ir::Solver solver_;
  const ir::Graph::Options options_;
  const Purpose purpose_;
  bool keeps_moments_of_first_ = false;  // in this section
  ir::Algorithm algorithm_;
  std::vector<ir::Algorithm> before_{};  // the sections before
  std::vector<Behind> behind_{};
};

}  // namespace dalembert::passes
