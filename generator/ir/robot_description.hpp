// A robot as its URDF says it, checked but not yet interpreted: every link and joint by name, nothing fused or reordered.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ir/joint_types.hpp"
#include "ir/loop.hpp"

namespace dalembert::ir {

// Mass (kg), centre of mass (m, link axes), rotational inertia about the centre of mass (kg m², link axes: a rotated
// <inertial><origin rpy> is already turned into link axes by the reader).
struct Inertia {
  double mass = 0;
  Eigen::Vector3d com = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
};

// What a joint is: its type, with what the type needs besides an axis.
struct JointKind {
  JointType type = JointType::fixed;
  double pitch = 0;                                   // helical: how far it slides per turn, m
  Eigen::Vector3d second = Eigen::Vector3d::UnitY();  // universal: the axis nearer the child, unit, in the child link's frame
  bool operator==(const JointKind&) const = default;
};

// q_joint = multiplier · q_of + offset (URDF <mimic>).
struct Mimic {
  std::string of;
  double multiplier = 1;
  double offset = 0;
};

struct Link {
  std::string name;
  std::optional<Inertia> inertia = {};  // absent: a frame without inertia
  int line = 0;                         // of the file
};

// <limit> as the URDF has it, rad or m, their rates, N m or N; infinite where it says nothing. No dynamics reads them.
struct Limits {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  double velocity = std::numeric_limits<double>::infinity();
  double effort = std::numeric_limits<double>::infinity();
};

struct Joint {
  std::string name;
  JointType type = JointType::fixed;
  int parent = -1;  // index into RobotDescription::links
  int child = -1;
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();  // child link's frame in the parent link's frame at q = 0
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();           // unit, in the child link's frame; planar: the plane's normal
  bool axis_is_known = true;                                 // not where a floating joint of the file has none
  double pitch = 0;                                          // as in JointKind
  Eigen::Vector3d second = Eigen::Vector3d::UnitY();         // likewise
  double damping = 0;                                        // <dynamics damping>, N m s/rad or N s/m; NaN: no number
  double friction = 0;                                       // <dynamics friction>, N m or N; NaN: no number
  std::optional<Mimic> mimic;
  Limits limits;
  int line = 0;  // of the file
};

struct RobotDescription {
  std::string file;                // in diagnostics
  std::vector<std::string> files;  // read: the user's own as he named it, then those it includes; of a .xacro its own alone
  std::string text;                // of them all; of a .xacro as xacro expands it
  std::string name;
  std::vector<Link> links;
  std::vector<Joint> joints;  // in urdfdom's order: alphabetical by name
  int root = -1;              // index into links
  // Per link: the joints whose parent it is, in urdfdom's order.
  std::vector<std::vector<int>> children;
  std::vector<Loop> loops;    // joints of the file that close loops, its own parent link first
  std::string floating_root;  // the floating joint that the file hangs the root on
  // Of the root link in the frame that a fixed base stands in; where the base floats, q says where it is.
  Eigen::Isometry3d root_pose = Eigen::Isometry3d::Identity();
};

}  // namespace dalembert::ir
