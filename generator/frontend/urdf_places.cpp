#include <fmt/format.h>

#include "frontend/urdf_outline.hpp"

namespace dalembert::frontend {

std::string place(const LinkOutline& link) { return fmt::format("link '{}' (line {})", link.name, link.line); }
std::string place(const JointOutline& joint) { return fmt::format("joint '{}' (line {})", joint.name, joint.line); }

}  // namespace dalembert::frontend
