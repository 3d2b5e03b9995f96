// The system's C++ compiler, as eval and check use it: generated files in, a loaded shared object out.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "backend/output_files.hpp"

namespace dalembert {

// How generated code is compiled: by default as the documentation tells users to.
struct CompilerOptions {
  std::string compiler;  // words of a command line; empty: $CXX, or c++
  std::string flags = "-O3 -march=native -std=c++17";
  int lanes = 0;               // numbers side by side, 1, 2, 4 or 8; 0: as many as the target's registers hold
  std::string libraries = {};  // what the code is linked with: "-ltbb"
  // A header, precompiled with these very flags and -fPIC, that is read in front of the code; empty: none.
  std::string precompiled = {};
};

// The words of the command that options, environment or system name: {"ccache", "g++"}.
std::vector<std::string> compiler_words(const CompilerOptions& options);

// Compiler and flags, without files: {"c++", "-O3", "-march=native", "-std=c++17"}.
std::vector<std::string> compiler_and_flags(const CompilerOptions& options);

// The folders of the runtime's headers and of Eigen's: those in $DALEMBERT_INCLUDE (separated by ':'), or those dalembert was
// built or installed with.
std::vector<std::string> include_folders();

// As words for a compiler: {"-isystem", "/opt/include"}. Not those where it looks anyhow, whose order is its own affair.
std::vector<std::string> include_words();

// Runs a compiler's command; what it says goes to the file `log`. Throws InputError when it cannot be run or does not compile.
void run_compiler(const std::vector<std::string>& command, const std::filesystem::path& log);

// What the compiler, the linker or the loader said first, without where, of what the constructor below throws.
std::string complaint(const std::runtime_error& error);

// Generated code compiled and loaded into this process. The files live in a temporary folder until the end of the constructor.
class LoadedCode {
 public:
  // `name`: the folder under which the files include each other. The C interface is compiled with the code in one:
  // position-independent code stays the same, and Eigen, which is most of a small robot's time, is read once. Throws InputError
  // when there is no compiler or it refuses the code.
  LoadedCode(const std::string& name, const std::vector<backend::OutputFile>& files, const CompilerOptions& options);
  ~LoadedCode();
  LoadedCode(const LoadedCode&) = delete;
  LoadedCode& operator=(const LoadedCode&) = delete;

  // The command that compiled, up to the flags: "c++ -O3 -march=native -std=c++17".
  const std::string& command() const { return command_; }

  // Whether there is such a C function.
  bool has(const std::string& name) const;

  // The address of a C function; throws std::runtime_error when there is none such.
  template <class Function>
  Function* function(const std::string& name) const {
    return reinterpret_cast<Function*>(address(name));
  }

 private:
  void* address(const std::string& name) const;

  std::string command_;
  void* library_ = nullptr;
};

}  // namespace dalembert
