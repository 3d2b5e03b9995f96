// Edits a URDF so that a program with no meshes and no notion of a floating base can read it.
//
// Only what has no bearing on dynamics is removed, and nothing is computed: poses, axes and inertias reach the oracle as the
// characters of the file.
#pragma once

#include <string>

namespace dalembert::oracle {

struct UrdfEdit {
  bool floating_joint = false;       // insert a link and a joint of type "floating" above the root
  bool placeholder_inertia = false;  // every link: 1 kg at its origin, unit inertia (to be overwritten after loading)
};

// The name of a link after the edit. Every link is renamed because "world" has a special meaning to MuJoCo and DART.
inline std::string link_name_in_oracle(const std::string& link) { return "link_" + link; }
inline constexpr const char* floating_joint_name = "oracle_base";

// Reads `path`; removes <visual>, <collision>, <transmission> and <gazebo>. Throws std::runtime_error naming the file.
std::string edited_urdf(const std::string& path, const UrdfEdit& edit);

}  // namespace dalembert::oracle
