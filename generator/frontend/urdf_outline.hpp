// The URDF as text with places: what can be checked before a model exists, said with line numbers.
//
// urdfdom reports most defects on its console without a place, drops some without a word (unknown tags, a child of two
// joints, a cycle beside the tree) and insists on things the dynamics never reads (limits, geometry). So the XML is checked
// here first, element by element, and handed on without the parts that are not ours.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "diagnostics.hpp"

namespace dalembert::frontend {

struct LinkOutline {
  std::string name;
  int line = 0;
  Eigen::Vector3d inertial_rpy = Eigen::Vector3d::Zero();  // <inertial><origin rpy>, rad
};

struct JointOutline {
  std::string name;
  int line = 0;
  std::string type;
  std::string parent;  // link names
  std::string child;
  Eigen::Vector3d origin_rpy = Eigen::Vector3d::Zero();  // rad
};

struct UrdfOutline {
  std::string robot;
  std::vector<LinkOutline> links;    // in the file's order
  std::vector<JointOutline> joints;  // in the file's order
  std::string reduced;               // the same URDF without geometry, limits and other parts the dynamics does not read
};

// Reads the text of a URDF. `file` is for the diagnostics. Throws InputError with every defect of the XML itself: syntax,
// missing elements, attributes and names, malformed or non-finite numbers, joint types, zero axes.
UrdfOutline read_outline(const std::string& file, const std::string& text, Diagnostics& warnings);

// "link 'pelvis' (line 12)", the way elements are named in diagnostics.
std::string place(const LinkOutline& link);
std::string place(const JointOutline& joint);

}  // namespace dalembert::frontend
