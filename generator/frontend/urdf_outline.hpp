// The URDF as text with places: everything the robot is made from, each number read once and here.
//
// urdfdom reports most defects on its console without a place, drops some without a word (a mass with a blank behind it,
// unknown tags, a child of two joints, a cycle beside the tree) and insists on things the dynamics never reads (limits,
// geometry). So the XML is read here, element by element; urdfdom is handed the bare tree only.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "diagnostics.hpp"
#include "ir/robot_description.hpp"

namespace dalembert::frontend {

struct Frame {
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d rpy = Eigen::Vector3d::Zero();  // rad
  // Instead of rpy, where the rotation is computed (an SDF's resolved poses): near a pitch of 90° angles have half its digits.
  std::optional<Eigen::Matrix3d> rotation = {};
};

// <inertial> as written: what is missing is zero. The inertia's axes are those of `origin`.
struct InertialOutline {
  Frame origin;
  double mass = 0;                                    // kg
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // kg m², about the centre of mass
};

struct LinkOutline {
  std::string name;
  int line = 0;
  std::optional<InertialOutline> inertial;
};

struct JointOutline {
  std::string name;
  int line = 0;
  ir::JointType type = ir::JointType::fixed;
  std::string parent;  // link names
  std::string child;
  Frame origin;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  // of any length but zero
  bool axis_is_known = true;  // not where a floating joint has none: a scene may make it one that needs it
  Eigen::Vector3d second = Eigen::Vector3d::UnitY();  // likewise: universal
  double pitch = 0;                                   // helical: m per turn
  double damping = 0, friction = 0;                   // NaN where the text is no number: refused by those who read it
  std::optional<ir::Mimic> mimic;                     // likewise; `of` may be empty
  ir::Limits limits;
};

struct UrdfOutline {
  std::string robot;
  std::vector<LinkOutline> links;          // in the file's order
  std::vector<JointOutline> joints;        // in the file's order
  std::vector<ir::Loop> loops;             // of an SDF: joints to links that have a parent already
  std::string floating_root;               // the floating joint that the root hung on
  Frame root_pose = {};                    // of an SDF: where the root link stands in the model
  std::vector<std::string> included = {};  // files, of an SDF
  std::string text = {};                   // of the file, and of those that it includes
};

// Reads the text of a URDF. `file` is for the diagnostics, and for the name of a robot without one. Throws InputError with
// every defect of the XML itself: syntax, missing elements, attributes and names, malformed or non-finite numbers, joint types,
// zero axes; or with one that says how to go on when the file is an unexpanded xacro.
UrdfOutline read_outline(const std::string& file, const std::string& text, Diagnostics& warnings);

// "link 'pelvis' (line 12)", the way elements are named in diagnostics.
std::string place(const LinkOutline& link);
std::string place(const JointOutline& joint);

}  // namespace dalembert::frontend
