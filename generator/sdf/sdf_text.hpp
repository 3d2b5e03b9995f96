// The text of an SDF, freed from what no dynamics is made of.
//
// libsdformat checks everything in a file, and for a material without a script, or a camera without an angle, it leaves no
// model. So it is not given such elements. Of numbers it reads what comes before a comma or a letter, and takes quaternions of
// any length for turns: numbers are judged here, and quaternions have the length 1. Lines stay where they are: messages name
// them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "diagnostics.hpp"

namespace dalembert::frontend {

struct SdfText {
  std::string text;  // without visuals, collisions, sensors, lights and the like; plugins of a model are <dalembert:plugin/>
  std::string root;  // the name of the outermost element; empty where there is none
  // What is said of numbers that dynamics is made of; the file is its reader's to name.
  Diagnostics errors = {}, warnings = {};
};

// `found`: what is to be written in place of an <include>'s <uri>. Text that is not well-formed is returned as it is.
SdfText without_idle_elements(const std::string& text, const std::function<std::string(const std::string& uri)>& found);

}  // namespace dalembert::frontend
