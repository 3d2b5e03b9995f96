// Loops of the rolled form that are written out, step after step with their constants in place: of a limb that stands alone,
// whose lanes would be one, and of limbs side by side that are alike, so that much folds. So zeros and ones of their tables
// fold, and what is carried is a variable.
#pragma once

#include "ir/plan.hpp"
#include "ir/rolled.hpp"

namespace dalembert::passes {

// Where plan.write_limbs allows it. Nothing may change the program behind this pass: paragraphs and their written steps say the
// same twice.
void write_limbs(const ir::Plan& plan, ir::RolledProgram& program);

}  // namespace dalembert::passes
