// Loops of the rolled form that are written out: of a limb that stands alone, whose lanes would be one, body after body with
// the body's constants in place. So zeros and ones of its tables fold, and what is carried is a variable.
#pragma once

#include "ir/plan.hpp"
#include "ir/rolled.hpp"

namespace dalembert::passes {

// Where plan.write_limbs allows it. Nothing may change the program behind this pass: paragraphs and their written steps say the
// same twice.
void write_limbs(const ir::Plan& plan, ir::RolledProgram& program);

}  // namespace dalembert::passes
