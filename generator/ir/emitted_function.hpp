// A function of a robot's code: one of the standard ones (ir/function.hpp), or one that a scene names.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "ir/function.hpp"
#include "ir/link_quantity.hpp"
#include "ir/quantity.hpp"

namespace dalembert::ir {

struct Scene;

struct EmittedFunction {
  std::string name;                      // of the C++ function
  std::string type;                      // the same, where types are named
  Function inputs = Function::evaluate;  // the standard function that takes the same
  bool named = false;                    // by the scene: its results bear its name too
  std::vector<Quantity> quantities{};    // of the whole robot, in the order of their results
  std::vector<LinkOutput> of_links{};    // of links, behind them
  std::map<Quantity, Part> parts{};      // of quantities that are not wanted whole

  // What it takes after q and v, as in FunctionRow.
  const char* input() const { return row_of(inputs).input; }
  const char* meaning() const { return row_of(inputs).meaning; }
  // Whether it is evaluate(q, v), the one whose own names begin with nothing.
  bool is_evaluate() const { return !named && inputs == Function::evaluate; }
  // The name of what is its own in a robot's workspace or namespace: "scratch", "inverse_dynamics_scratch", "balance_scratch".
  std::string own_name(const std::string& what) const { return is_evaluate() ? what : name + "_" + what; }
  // What its result is called: "mass_matrix", "balance_mass_matrix".
  std::string result(Quantity quantity) const {
    const std::string quantity_name(name_of(quantity));
    return named ? own_name(quantity_name) : quantity_name;
  }
  std::string result(const LinkOutput& output) const { return named ? own_name(name_of(output)) : name_of(output); }
  bool computes(Quantity quantity) const;
  // Null: it is wanted whole.
  const Part* part(Quantity quantity) const;
  bool any_part() const;
  // Of its results, v̇ for the forces given, that which contacts allow first; empty: none is.
  std::string acceleration_result() const;
  bool moves_as_held() const;  // whether that is what contacts allow
  // Of its results, v behind an impact; empty: none is.
  std::string impact_result() const;
};

// The standard function, with nothing to compute.
EmittedFunction standard_function(Function function);

// A function of these quantities and those of links, in the order of quantities.def: what others are made of stands before
// them. The name as a type has letters behind '_' in capitals: "plan_step", "PlanStep". Takes what its quantities take.
EmittedFunction named_function(const std::string& name, const std::vector<Quantity>& quantities,
                               const std::vector<LinkOutput>& of_links = {}, const std::map<Quantity, Part>& parts = {});

// Those of which the scene asks something: the standard ones, then those it names, in its order.
std::vector<EmittedFunction> functions_of(const Scene& scene);

}  // namespace dalembert::ir
