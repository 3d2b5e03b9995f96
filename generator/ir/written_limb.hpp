// Loops of the rolled form that are written out: of a limb that stands alone, whose lanes would be one, body after body with
// the body's constants in place. So zeros and ones of its tables fold, and what is carried is a variable.
#pragma once

#include <cstddef>
#include <vector>

#include "ir/plan.hpp"
#include "ir/rolled.hpp"

namespace dalembert::ir {

// What one body of the limb does. Inputs: `carried` from the step before, `of_body` what is kept of a body, its own included,
// `received` what limbs hand on to it.
struct LimbStep {
  int body = 0;
  Graph graph;
  std::vector<Value> stores;     // to the body's slot
  std::vector<Carried> carried;  // to the next step, which reads it, or, of the last inwards, to whoever it hangs on

  std::vector<NodeId> roots() const;  // all of them
};

// The steps of a segment's paragraph in the order in which they run, or none where it stays a loop.
std::vector<LimbStep> written_limb(const Plan& plan, const RolledProgram& program, std::size_t segment,
                                   const Paragraph& paragraph);

}  // namespace dalembert::ir
