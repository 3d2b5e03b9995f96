// Which lanes of the rolled form's loops anybody reads: where contacts on two of four branches are all that poses are for, they
// are computed of these two.
#pragma once

#include "ir/algorithm.hpp"
#include "ir/plan.hpp"
#include "ir/rolled.hpp"

namespace dalembert::passes {

// Says each paragraph's live lanes, leaves lanes behind the last of them out of loops that go step by step, and drops
// paragraphs that have none, and constants of the base that nobody else read. `program` has its places.
void find_live_lanes(const ir::Algorithm& algorithm, const ir::Plan& plan, ir::RolledProgram& program);

}  // namespace dalembert::passes
