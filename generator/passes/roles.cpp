#include "passes/roles.hpp"

namespace dalembert::passes {

std::vector<ir::Role> make_roles() {
  std::vector<ir::Role> r(role_count);
  r[sine] = {"sine", "sin q", 1};
  r[cosine] = {"cosine", "cos q", 1};
  r[slide] = {"slide", "q of prismatic joints, m", 1};
  r[rate] = {"rate", "dq", 1};
  r[pose_sine] = {"pose_sine", "sin q, 0 where the joint carries the reference frame", 1};
  r[pose_cosine] = {"pose_cosine", "cos q, 1 where the joint carries the reference frame", 1};
  r[pose_slide] = {"pose_slide", "q of prismatic joints, 0 where the joint carries the reference frame", 1};
  r[rotation] = {"rotation", "R, column by column", 9};
  r[position] = {"position", "p", 3};
  r[joint_linear] = {"joint_linear", "J, linear part", 3};
  r[joint_angular] = {"joint_angular", "J, angular part", 3};
  r[joint_rate] = {"joint_rate", "dJ", 6};
  r[velocity] = {"velocity", "u, w", 6};
  r[first] = {"first", "h, of the body and of the limbs attached to it", 3};
  r[second] = {"second", "S: xx xy xz yy yz zz", 6};
  r[momentum] = {"momentum", "P", 3};
  r[bias_block] = {"bias_block", "D, row by row", 9};
  r[inertia_force] = {"inertia_force", "F = A* J", 6};
  r[bias_force] = {"bias_force", "G = A* dJ + B* J", 6};
  r[transposed] = {"transposed", "H", 3};
  r[below_force] = {"below_force", "ad(V)' F + H, for the base's columns", 6};
  r[down] = {"down", "gravity along the body's axes", 3};
  r[gravity_first] = {"gravity_first", "h of the subtree in the body's axes", 3};
  r[gravity_torque] = {"gravity_torque", "g", 1};
  r[motion] = {"motion", "w, dw, a in the body's axes", 9};
  r[force] = {"force", "f, n of the subtree in the body's axes", 6};
  r[bias_torque] = {"bias_torque", "C v + g", 1};
  return r;
}

bool is_sum(int role) {
  switch (role) {
    case first:
    case second:
    case momentum:
    case bias_block:
    case gravity_first:
    case force: return true;
    default: return false;
  }
}

void share_places(ir::RolledProgram& program) {
  // Without C all of it fits in the cache anyway, and stores to what was just read cost more than they save.
  if (!program.coriolis || program.wrench) return;
  const auto share = [&](int role, int place) {  // a place that nobody needs is none: joints that move no mass
    if (!program.roles[static_cast<size_t>(place)].name.empty()) program.roles[static_cast<size_t>(role)].place = place;
  };
  share(inertia_force, rotation);  // the axis, columns 6 to 8, stays
  share(bias_force, velocity);
  share(transposed, position);
}

}  // namespace dalembert::passes
