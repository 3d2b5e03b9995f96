// <link> and <joint>, read number by number.
#pragma once

#include "frontend/element_reader.hpp"
#include "frontend/urdf_outline.hpp"

namespace dalembert::frontend {

// What the element says about its link or joint; complaints go to the reader, whose owner it is. What is missing of an
// <inertial> is zero, with a warning: what is malformed is an error. Attributes that the dynamics does not read (limits,
// calibration, safety) never are.
LinkOutline read_link(ElementReader& read, const TiXmlElement& element, const std::string& name);
JointOutline read_joint(ElementReader& read, const TiXmlElement& element, const std::string& name);

}  // namespace dalembert::frontend
