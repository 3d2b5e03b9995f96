// Rows of constraints, J v̇ + J̇ v = b, whatever holds: a contact or a loop. Everything is along the base's axes and about its
// origin, where the point x of a body of twist [u; w] and acceleration [a; α] has the velocity u + w × x and the acceleration
// a + α × x + w × (u + w × x); rows are these turned to the axes asked for.
//
// Derivatives are of what the world sees, its axes and points told by the base's as they stand now. For a joint of twist S
// above a body, with Ψ̇, Ψ̈ and Ṡ as in derivatives of inverse dynamics and A the body's acceleration less gravity,
//
//   ∂V/∂q = Ψ̇ − V × S     ∂A/∂q = Ψ̈ − A × S − V × Ψ̇     ∂V/∂v = S     ∂A/∂v = Ψ̇ + Ṡ − V × S.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

// Forces along rows that a function has found before, as a wrench on their body about the base's origin, and the moment about
// the point where they act; roles of the base.
struct HeldRoles {
  int wrench, moment, point;
  bool in_world;  // it keeps to the world's axes; else it turns with the body
};

// Of loops: what ∂(−Jᵀ f)/∂q is more than if forces turned and moved with the body that they act on, as a product of two
// matrices of so many rows each.
inline constexpr int turning_rows = 9;

// Roles of the base, a row each: role and component.
using RowRoles = std::vector<std::pair<int, int>>;

class ConstraintRows {
 public:
  // index: among all constraints; first: its first row.
  ConstraintRows(const ir::Constraint& constraint, int index, int first)
      : constraint_(constraint), index_(index), first_(first) {}
  virtual ~ConstraintRows() = default;

  const ir::Constraint& constraint() const { return constraint_; }
  const std::string& name() const { return constraint_.member; }
  int index() const { return index_; }
  int first() const { return first_; }

  // J, to the array's rows from the first on.
  virtual void columns(Builder& b, int array) const = 0;
  virtual RowRoles velocities(Builder& b) const = 0;  // J v
  virtual RowRoles biases(Builder& b) const = 0;      // J̇ v
  virtual RowRoles errors(Builder& b) const = 0;      // how far from where it shall be; to first order J v is its rate

  // Where a contact acts, from the base's origin along the world's axes, if its rows are along these: a role of the base; else
  // −1.
  virtual int point_in_world(Builder&) const { return -1; }

  // How J v̇ + J̇ v + kd J v + kp e changes with q, or v, at v̇ held; to the array's rows from the first on.
  virtual void changes(Builder& b, bool by_q, int array) const = 0;
  virtual HeldRoles wrench(Builder& b) const = 0;
  // Of loops: to the arrays' rows from `row` on.
  virtual void turning(Builder&, int /*left*/, int /*right*/, int /*row*/) const {}

 private:
  ir::Constraint constraint_;
  int index_, first_;
};

// Contacts, then loops.
std::vector<std::unique_ptr<ConstraintRows>> constraint_rows(const Builder& b);
std::unique_ptr<ConstraintRows> contact_rows(const Builder& b, const ir::Contact& contact, const ir::Constraint& constraint,
                                             int index, int first);
std::unique_ptr<ConstraintRows> loop_rows(const Builder& b, const ir::Loop& loop, const ir::Constraint& constraint, int index,
                                          int first);

}  // namespace dalembert::passes
