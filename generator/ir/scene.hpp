// How a robot is used. The compiler keeps only what this use can reach.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ir/compile_options.hpp"
#include "ir/contact.hpp"
#include "ir/frame.hpp"
#include "ir/identifier.hpp"
#include "ir/link_quantity.hpp"
#include "ir/loop.hpp"
#include "ir/part.hpp"
#include "ir/quantity.hpp"
#include "ir/robot_description.hpp"

namespace dalembert::ir {

enum class Base { fixed, floating };
enum class GravityKind { constant, none, run_time };
enum class ScalarType { float64, float32 };
enum class Parallel { serial, tasks, automatic };
enum class Coriolis { balance, christoffel };             // which C with dM/dt = C + C' and the same C v
enum class Solver { articulated_bodies, factorization };  // how equations with M are solved
enum class InertiaPolicy { refuse, accept, repair };      // what becomes of an inertia that no body has

struct Spring {
  double k = 0;     // N m/rad or N/m
  double rest = 0;  // where it is at rest, rad or m
};

// Of a joint that its motor turns through a spring.
struct Elasticity {
  double k = 0;        // of the spring, N m/rad or N/m
  double damping = 0;  // of the spring, N m s/rad or N s/m
  double inertia = 0;  // of the motor, reflected to the joint, kg m² or kg
};

// One more function of the generated code, and what it computes.
struct NamedFunction {
  std::string name;
  std::vector<Quantity> quantities;
  std::vector<LinkOutput> of_links{};
  std::map<Quantity, Part> parts{};  // of quantities that are not wanted whole
};

// How a function is to be computed: what is said of it; the rest is estimated.
struct FunctionPlan {
  std::optional<Form> form;
  std::optional<Solver> solver;
  std::optional<Order> order;
};

// What pushes a link from outside, given at run time: force and moment on it at its origin, along its axes or the world's.
struct ExternalWrench {
  std::string link;
  bool in_world = false;
  bool operator==(const ExternalWrench&) const = default;
};

// Rows of constraints that belong together: a contact's, or a loop's.
struct Constraint {
  std::string member;  // of the workspace: contact_NAME, loop_NAME
  std::string of;      // "link left_foot", "link crank and link rod"
  bool loop = false;
  int rows = 0, linear_rows = 0;
};

struct Scene {
  Base base = Base::floating;
  GravityKind gravity_kind = GravityKind::constant;
  Eigen::Vector3d gravity{0, 0, -9.81};  // m/s², world axes; when given at run time: the value a new workspace starts with
  std::vector<Quantity> outputs = default_quantities();
  std::map<Quantity, Part> parts{};  // of outputs that are not wanted whole
  std::vector<NamedFunction> functions;
  Coriolis coriolis = Coriolis::balance;
  std::optional<Solver> forward_dynamics;   // unless asked for: articulated bodies, where they will do
  std::map<std::string, double> locked;     // joint name → value (rad or m)
  std::set<std::string> cut;                // link names: each and everything beyond it is removed
  std::map<std::string, JointKind> joints;  // joint → what it is instead of what the URDF says
  std::map<std::string, Mimic> mimic;       // driven joint → relation (no coordinate of its own)
  std::vector<std::string> jacobians;       // links whose body Jacobian (6 × nv) is asked for
  std::vector<LinkOutput> frames;           // what else is asked of links
  std::vector<Frame> placed;                // frames of the user's own, which count as links
  std::vector<std::string> payloads;        // links that carry a payload given at run time
  std::vector<ExternalWrench> wrenches;     // what inverse and forward dynamics reckon with, in the order of a state file
  std::vector<Contact> contacts;            // constraints, in the order of their rows
  std::vector<Loop> loops;                  // behind them
  std::vector<Loop> embedded;               // loops with independent joints, which have no rows
  std::vector<std::string> passive;         // joints without a motor, for inverse dynamics with constraints
  ScalarType scalar = ScalarType::float64;
  Parallel parallel = Parallel::automatic;
  bool batch = false;                      // functions take many states at once, too
  bool linearly_implicit = false;          // … and roll out by linearly implicit steps, too
  bool impacts = false;                    // … with contacts and loops that come on and go
  bool rates_zero = false;                 // statics: v = 0, no velocity terms
  std::map<std::string, double> armature;  // joint → rotor inertia reflected to the joint, kg m² or kg
  std::map<std::string, double> damping;   // joint → viscous damping
  std::map<std::string, double> friction;  // joint → Coulomb friction
  std::map<std::string, Spring> stiffness;
  std::map<std::string, Elasticity> elastic;  // joint → the spring between its motor and its link
  bool urdf_damping = false;                  // take <dynamics damping> from the URDF
  bool urdf_friction = false;                 // take <dynamics friction> from the URDF
  bool lock_massless = false;                 // lock every joint that moves no mass
  InertiaPolicy inertia = InertiaPolicy::refuse;
  std::map<std::string, FunctionPlan> plan;  // function → how it is to be computed

  // What is asked of the whole robot, by any function, each once.
  std::vector<Quantity> quantities() const {
    std::vector<Quantity> all = outputs;
    for (const NamedFunction& function : functions)
      for (const Quantity quantity : function.quantities)
        if (std::find(all.begin(), all.end(), quantity) == all.end()) all.push_back(quantity);
    return all;
  }

  bool has_payload(const std::string& link) const {
    return std::find(payloads.begin(), payloads.end(), link) != payloads.end();
  }

  // "link left_foot", or "frame sole" of a frame of the scene's own.
  std::string called(const std::string& link) const {
    const bool own = std::any_of(placed.begin(), placed.end(), [&](const Frame& frame) { return frame.name == link; });
    return (own ? "frame " : "link ") + link;
  }

  int constraint_rows() const {
    int rows = 0;
    for (const Contact& contact : contacts) rows += contact.rows();
    for (const Loop& loop : loops) rows += loop.rows();
    return rows;
  }
  // Contacts, then loops, in the order of their rows.
  std::vector<Constraint> constraints() const {
    std::vector<Constraint> all;
    for (const Contact& c : contacts) all.push_back({"contact_" + identifier(c.name), called(c.link), false, c.rows(), 3});
    for (const Loop& l : loops)
      all.push_back(
          {"loop_" + identifier(l.name), called(l.links[0]) + " and " + called(l.links[1]), true, l.rows(), l.linear_rows()});
    return all;
  }
  bool any_constraint() const { return !contacts.empty() || !loops.empty(); }

  // What evaluate() is asked of links, by either key, each once.
  std::vector<LinkOutput> link_outputs() const {
    std::vector<LinkOutput> all;
    for (const std::string& link : jacobians) all.push_back({LinkQuantity::jacobian, link});
    for (const LinkOutput& output : frames)
      if (std::find(all.begin(), all.end(), output) == all.end()) all.push_back(output);
    return all;
  }
};

}  // namespace dalembert::ir
