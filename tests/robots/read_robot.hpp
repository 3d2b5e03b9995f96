// A test robot by its name, read as a command would.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pipeline.hpp"
#include "robots.hpp"

namespace dalembert {

using Settings = std::vector<frontend::Setting>;

inline Model read_robot(const std::string& name, Settings settings, const std::string& form = "") {
  Request request;
  for (const TestRobot& known : test_robots)
    if (known.name == name) request.robot = known.urdf;
  request.settings = std::move(settings);
  request.form = form;
  Diagnostics warnings;
  return read_model(request, warnings);
}

}  // namespace dalembert
