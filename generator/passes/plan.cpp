#include "passes/plan.hpp"

namespace dalembert::passes {

ir::Plan plan(const ir::KinematicTree&, const ir::Scene&, const ir::Operations&, ir::Form) { return {}; }

}  // namespace dalembert::passes
