// The types of joints, a file and a row each (ir/joints): what the compiler and its commands know of one stands there. All else
// asks for what it needs of it: how many numbers, whether it turns or slides, its word.
//
// A body of the tree has one coordinate (ir/kinematic_tree.hpp): its joint turns about an axis, slides along it, or both at a
// fixed rate. A joint of several coordinates is a row of such bodies, all but the last without mass (passes/build_tree), which
// keep the joint's name.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

namespace dalembert::ir {

// URDF's, and those that a scene makes of them.
enum class JointType { revolute, continuous, prismatic, helical, universal, planar, spherical, floating, fixed };

struct Joint;

// One of a joint's coordinates.
struct JointPart {
  std::string suffix;    // of its name, behind the joint's: "x"; empty where the joint has no other
  JointType type;        // of one coordinate
  Eigen::Vector3d axis;  // unit, in the frame of the child link
};
JointPart turning(const char* suffix, const Eigen::Vector3d& axis);
JointPart sliding(const char* suffix, const Eigen::Vector3d& axis);

struct JointTypeRow {
  const char* word;         // as URDF and scenes have it
  const char* coordinates;  // what they are, for the reader
  int nq, nv;               // numbers of q and of v
  int quaternion;           // where in those of q a unit quaternion x y z w begins; −1: there is none
  bool turns, slides;       // any of its coordinates, or that which is both
  bool has_axis;            // and so an <axis> in the file
  bool in_urdf, in_scenes;  // who can say it
  // From the parent to the child: each moves all behind it.
  std::vector<JointPart> (*parts)(const Joint& joint);

  bool has_quaternion() const { return quaternion >= 0; }
};

namespace joints {
JointTypeRow revolute();
JointTypeRow continuous();
JointTypeRow prismatic();
JointTypeRow helical();
JointTypeRow universal();
JointTypeRow planar();
JointTypeRow spherical();
JointTypeRow free_flyer();
}  // namespace joints

const JointTypeRow& row_of(JointType type);

inline int coordinates_of(JointType type) { return row_of(type).nv; }
inline int positions_of(JointType type) { return row_of(type).nq; }
inline bool turns(JointType type) { return row_of(type).turns; }
inline bool slides(JointType type) { return row_of(type).slides; }

// Of a joint of one coordinate: how far it slides per rad or m.
double slide_per_unit(JointType type, double pitch);

// What a joint of one coordinate is called that moves so.
const char* word_of(bool turns, bool slides);

// By the words of URDF's files, and of what a scene may make of a joint.
using JointWords = std::vector<std::pair<std::string, JointType>>;
JointWords urdf_joint_words();
JointWords joint_words();

}  // namespace dalembert::ir
