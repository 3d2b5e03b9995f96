// The options all commands share: the robot, the scene file and the scene's keys.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "pipeline.hpp"

namespace dalembert {

// Collects the shared options of one command. Lives as long as the parse.
class SharedOptions {
 public:
  explicit SharedOptions(CLI::App& command);

  // What the user asked for, once the command line is parsed.
  Request request() const;
  bool verbose() const { return verbose_; }

 private:
  Request request_;
  bool verbose_ = false, calibrated_ = false;
  std::map<std::string, std::string> texts_;  // per scene key
  std::map<std::string, CLI::Option*> options_;
};

}  // namespace dalembert
