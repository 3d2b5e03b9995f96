// Whether a link's inertia is one a body can have.
#pragma once

#include <string>

#include "diagnostics.hpp"
#include "ir/robot_description.hpp"

namespace dalembert::frontend {

// A negative principal moment is an error. Warnings: principal moments a, b, c with a + b < c (with the amount), and a mass
// without any rotational inertia, as point masses have.
void check_inertia(const std::string& file, const std::string& element, const ir::Inertia& inertia, Diagnostics& errors,
                   Diagnostics& warnings);

}  // namespace dalembert::frontend
