// The text of an SDF, freed from what no dynamics is made of.
//
// libsdformat checks everything in a file, and for a material without a script, or a camera without an angle, it leaves no
// model. So it is not given such elements. Lines stay where they are: messages name them.
#pragma once

#include <functional>
#include <string>

namespace dalembert::frontend {

struct SdfText {
  std::string text;  // without visuals, collisions, sensors, lights and the like; plugins of a model are <dalembert:plugin/>
  std::string root;  // the name of the outermost element; empty where there is none
};

// `found`: what is to be written in place of an <include>'s <uri>. Text that is not well-formed is returned as it is.
SdfText without_idle_elements(const std::string& text, const std::function<std::string(const std::string& uri)>& found);

}  // namespace dalembert::frontend
