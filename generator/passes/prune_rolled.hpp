// Drops from the rolled form whatever the wanted quantities do not read.
#pragma once

#include "ir/rolled.hpp"

namespace dalembert::passes {

// Values stored or carried, paragraphs left without any, and the names of roles nobody keeps.
void prune_rolled(ir::RolledProgram& program, bool floating_base);

}  // namespace dalembert::passes
