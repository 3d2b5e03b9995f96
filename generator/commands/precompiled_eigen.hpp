// Eigen, read by the compiler once for all that a command compiles: it is most of the time of compiling small code.
#pragma once

#include "commands/compiler.hpp"
#include "commands/temporary_folder.hpp"

namespace dalembert {

class PrecompiledEigen {
 public:
  // Where the compiler makes no such header, there is none, and nothing is missing but time.
  explicit PrecompiledEigen(const CompilerOptions& options);

  // The options, with the header; as they were where there is none.
  const CompilerOptions& options() const { return options_; }

 private:
  TemporaryFolder folder_;
  CompilerOptions options_;
};

}  // namespace dalembert
