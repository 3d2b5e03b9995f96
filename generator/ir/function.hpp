// The standard functions of the emitted code: one per set of inputs. What a scene's outputs ask of a function is computed by
// it, and by it alone. Functions that a scene names itself (ir/emitted_function.hpp) take what one of these takes.
#pragma once

#include <array>
#include <string>

namespace dalembert::ir {

enum class Function { evaluate, inverse_dynamics, forward_dynamics };

struct FunctionRow {
  Function function;
  const char* name;   // of the C++ function; begins the names of what is its own
  const char* type;   // the same, where types are named
  const char* input;  // what it takes after q and v: an argument's name, nv numbers; empty: nothing
  const char* meaning;
};

inline constexpr std::array<FunctionRow, 3> functions{
    {{Function::evaluate, "evaluate", "", "", ""},
     {Function::inverse_dynamics, "inverse_dynamics", "InverseDynamics", "a",
      "accelerations dv/dt, laid out as v (a floating base's: the rates of its twist's coordinates in base axes)"},
     {Function::forward_dynamics, "forward_dynamics", "ForwardDynamics", "tau",
      "forces on the coordinates, laid out as v (a floating base's first: force and moment in base axes), N and N m"}}};

inline constexpr const FunctionRow& row_of(Function function) { return functions[static_cast<std::size_t>(function)]; }

// What the C function that gives a result is called, after the robot's name: C has no overloading, and a result may be called
// like the function that computes it.
inline std::string c_accessor(const std::string& result) {
  for (const FunctionRow& row : functions)
    if (result == row.name) return result + "_result";
  return result;
}

}  // namespace dalembert::ir
