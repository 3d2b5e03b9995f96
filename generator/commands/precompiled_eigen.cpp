#include "commands/precompiled_eigen.hpp"

#include <fstream>
#include <string>
#include <vector>

#include "diagnostics.hpp"

namespace dalembert {

PrecompiledEigen::PrecompiledEigen(const CompilerOptions& options) : options_(options) {
  if (options.flags.find("-include") != std::string::npos) return;  // a compiler reads one such header
  const std::string header = (folder_.path() / "eigen.hpp").string();
  std::ofstream(header) << "#include <Eigen/Core>\n";
  std::vector<std::string> command = compiler_and_flags(options);
  for (const std::string& word : include_words()) command.push_back(word);
  command.insert(command.end(), {"-fPIC", "-x", "c++-header", header, "-o", header + ".gch"});
  try {
    run_compiler(command, folder_.path() / "log");
    options_.precompiled = header;
  } catch (const InputError&) {
    // What is wrong with the compiler, or the code, is said where the code is compiled.
  }
}

}  // namespace dalembert
