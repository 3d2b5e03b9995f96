// Rollouts: many motions, step by step.
#include <fmt/format.h>

#include <algorithm>

#include "backend/batch_function.hpp"
#include "backend/code_text.hpp"
#include "backend/literals.hpp"
#include "backend/templates.hpp"
#include "ir/implicit_joints.hpp"

namespace dalembert::backend {

const BatchArray* BatchFunction::moved_by(const BatchProgram& program) const {
  const std::string name = function_of(code_).acceleration_result();
  const auto& all = program.results();
  const auto found = std::find_if(all.begin(), all.end(), [&](const BatchArray& a) { return a.array.name == name; });
  return name.empty() || found == all.end() ? nullptr : &*found;
}

std::string BatchFunction::rollout() const {
  const ir::EmittedFunction& f = function_of(code_);
  if (!rolls_out()) return "";
  return render("rollout.cpp", {{"function", f.name},
                                {"type", f.type},
                                {"more_members", program_.by_calls() || has_impacts() ? ", {}" : ""},
                                {"moved_by", std::to_string(moved_by(program_)->first)},
                                {"joints", joints_that_turn()},
                                {"finish", finish()},
                                {"generated", implicit_       ? "<true>"
                                              : has_impacts() ? "<false, true>"
                                                              : ""},
                                {"program", has_impacts() ? "ContactProgram" : "BatchProgram"},
                                {"other_program", has_impacts() ? contact_program() : implicit_program()},
                                {"implicit_steps", implicit_steps()}});
}

int BatchFunction::implicit_numbers() const {
  return ir::implicit_numbers * static_cast<int>(ir::implicit_joints(code_.implicit->tree).size());
}

std::string BatchFunction::contact_program() const {
  const int first = program_.given_count();
  std::string as_set, as_in_step, run, definitions, strike = call(*impact_);
  for (size_t line = 0; line < strike.size(); line = strike.find('\n', line) + 1) strike.erase(line, 2);  // in no loop
  write_program(run, definitions);
  int at = first, index = 0;
  for (; index < constraint_count(); ++index, ++at) {
    const int given = program_.given_place({ir::InputKind::constraint, index, ir::contact_active});
    as_set += fmt::format("    block.given[{}] = block.given[{}];\n", at, given);
    as_in_step += fmt::format("    block.given[{}] = block.given[{}];\n", given, at);
  }
  return render("rollout_contacts.cpp", {{"function", function_of(code_).name},
                                         {"type", function_of(code_).type},
                                         {"struck_by", function_of(*impact_).name},
                                         {"result", function_of(*impact_).impact_result()},
                                         {"status", own_name(*impact_, "status")},
                                         {"how", program_.by_calls() ? ", called for one after another" : ""},
                                         {"given", std::to_string(at)},
                                         {"angles", std::to_string(program_.angles())},
                                         {"kept", std::to_string(program_.kept())},
                                         {"elements", std::to_string(program_.elements())},
                                         {"parts", std::to_string(program_.parts())},
                                         {"first_active", std::to_string(first)},
                                         {"constraints", std::to_string(constraint_count())},
                                         {"with_given", with_given(program_)},
                                         {"as_set", as_set},
                                         {"as_in_step", as_in_step},
                                         {"strike", strike},
                                         {"run", run},
                                         {"definitions", definitions}});
}

std::string BatchFunction::implicit_program() const {
  if (!implicit_) return "";
  std::string run, definitions, constants;
  straight(*implicit_, run, definitions);
  int at = implicit_->given_count();
  for (const ir::ImplicitJoint& joint : ir::implicit_joints(code_.implicit->tree)) {
    const std::string damping = literal(joint.damping, code_.scene.scalar),
                      stiffness = literal(joint.stiffness, code_.scene.scalar);
    const auto put = [&](int component, const std::string& value) {
      constants += fmt::format("    block.given[{}] = dalembert::broadcast<width, Scalar>({});\n", at + component, value);
    };
    constants += fmt::format("    // {}: h (D + h K){}\n",
                             comment_text(code_.implicit->tree.bodies[static_cast<size_t>(joint.body)].joint),
                             joint.stiffness == 0 ? "" : ", h K");
    put(ir::implicit_inertia,
        joint.stiffness == 0 ? fmt::format("h * {}", damping) : fmt::format("h * ({} + h * {})", damping, stiffness));
    if (joint.stiffness != 0) put(ir::implicit_force, fmt::format("h * {}", stiffness));
    at += ir::implicit_numbers;
  }
  if (constants.empty()) constants = "    (void)h;\n";
  return render("rollout_implicit.cpp", {{"function", function_of(code_).name},
                                         {"type", function_of(code_).type},
                                         {"operations", std::to_string(implicit_->operations())},
                                         {"given", std::to_string(at)},
                                         {"angles", std::to_string(implicit_->angles())},
                                         {"kept", std::to_string(implicit_->kept())},
                                         {"elements", std::to_string(implicit_->elements())},
                                         {"parts", std::to_string(implicit_->parts())},
                                         {"with_given", with_given(*implicit_)},
                                         {"constants", constants},
                                         {"run", run},
                                         {"definitions", definitions}});
}

std::string BatchFunction::implicit_steps() const {
  if (!implicit_) return "";
  const auto& checked = implicit_->checked();
  std::string finish = fmt::format(
      "          if (!dalembert::batch_holds<nv, Scalar>(block.values + {0}, block.values + {1}, block.status)) {{\n"
      "            dalembert::batch_pivots_hold<nv, Scalar>(block.values + {0}, block.values + {1}, block.status);\n",
      checked.at(0).first, checked.at(1).first);
  for (const BatchArray& a : implicit_->results())
    finish += fmt::format("            dalembert::batch_clear<Scalar>(block.status, block.values + {}, {});\n", a.first,
                          a.packed.size());
  return fmt::format(
      "  if (rollout.method == dalembert::RolloutMethod::linearly_implicit) {{\n"
      "    using Program = {}ImplicitProgram;\n"
      "    dalembert::roll_out<nq, nv, Scalar>(\n"
      "        Program{{batch, rollout.time_step}}, rollout, batch.q, batch.v, batch.input, batch.states, batch.results, "
      "first,\n"
      "        first + count, {}, [](Program::Block& block) {{\n{}          }}\n        }}{});\n"
      "    return dalembert::BatchError::none;\n  }}\n",
      function_of(code_).type, moved_by(*implicit_)->first, finish, joints_that_turn());
}

}  // namespace dalembert::backend
