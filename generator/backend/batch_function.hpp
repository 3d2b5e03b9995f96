// The text of one function's batches: what batch.hpp declares (batch_function.cpp) and the C interface (batch_function_c.cpp),
// and what both define, rollouts among it (batch_rollout.cpp).
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "backend/batch_program.hpp"
#include "backend/code_text.hpp"
#include "backend/emit.hpp"

namespace dalembert::backend {

// Whether anything of a workspace acts on a batch: run-time inputs, and how contacts and loops hold.
bool reads_workspace(const CodeInput& code);

class BatchFunction {
 public:
  // impact: of the folder, the function that tells what an impact does; null: rollouts know none.
  explicit BatchFunction(const CodeInput& code, const CodeInput* impact = nullptr);

  std::string header() const;
  std::string source() const;
  // For threads: states that are handed out together, some 20 us of them.
  std::string tasks() const;
  std::string c_declarations() const;
  std::string c_definitions() const;

  // Whether it tells how a robot moves, so that motions can be computed in one call.
  bool rolls_out() const { return moved_by(program_) != nullptr; }
  // Whether contacts and loops come on and go in its rollouts, with impacts.
  bool has_impacts() const { return impact_ && rolls_out() && function_of(code_).moves_as_held(); }
  // Whether by linearly implicit steps, too.
  bool has_implicit_steps() const { return implicit_.has_value(); }
  // Whether it calls the function itself.
  bool has_workspace() const { return program_.by_calls() || program_.checked().size() == 2; }
  // Whether a table of places can hold them, and a stack the registers.
  static constexpr int most_elements = 20000;
  int elements() const { return program_.elements(); }
  // Of a call.
  std::size_t bytes() const;

 private:
  std::size_t bytes(const BatchProgram& program) const;
  static std::string shape(const BatchArray& a);

  // Parts of the sources, by what they are in the templates.
  void write_program(std::string& run, std::string& definitions) const;
  static void straight(const BatchProgram& program, std::string& run, std::string& definitions);
  // The function itself at the state `state` of a block, into a `workspace`: this one, or another that takes the same, or less.
  std::string call(const CodeInput& called) const;
  // The same at each state of a block.
  std::string calls() const;
  // Near a singular M, by the function itself: states are few, and the bounds that tell are as much work as the rest.
  std::string status() const;
  std::string fill() const;
  std::string with_given(const BatchProgram& program) const;
  std::string checks() const;
  int widest() const;
  std::string tables() const;
  std::string finish() const;  // behind the program, for each state
  std::string write() const;
  std::string block() const;

  // v̇ among the values; null: it tells none.
  const BatchArray* moved_by(const BatchProgram& program) const;
  std::string joints_that_turn() const { return code_.robot->any_quaternion() ? ", quaternion_joints" : ""; }
  int implicit_numbers() const;
  int constraint_count() const { return has_impacts() ? static_cast<int>(code_.scene.constraints().size()) : 0; }
  std::string rollout() const;
  std::string contact_program() const;
  std::string implicit_program() const;
  // The motions by such steps: as semi-implicit Euler's, but for v̇.
  std::string implicit_steps() const;
  std::string rollout_declaration() const;
  std::string rollout_definition(const std::string& given) const;

  const CodeInput& code_;
  const CodeInput* const impact_;
  const BatchProgram program_;
  std::optional<BatchProgram> implicit_;  // of linearly implicit steps
};

}  // namespace dalembert::backend
