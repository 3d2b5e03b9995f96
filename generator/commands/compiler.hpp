// The system's C++ compiler, as eval and check use it: generated files in, a loaded shared object out.
#pragma once

#include <string>
#include <vector>

#include "backend/output_files.hpp"

namespace dalembert {

// Generated code compiled and loaded into this process. The files live in a temporary folder until the end of the constructor.
class LoadedCode {
 public:
  // `name`: the folder under which the files include each other. `flags`: such as "-O1". The compiler is $CXX, or c++; the
  // folders of headers are those in $DALEMBERT_INCLUDE (separated by ':'), or those dalembert was built or installed with.
  // Throws InputError when there is no compiler or it refuses the code.
  LoadedCode(const std::string& name, const std::vector<backend::OutputFile>& files, const std::vector<std::string>& flags);
  ~LoadedCode();
  LoadedCode(const LoadedCode&) = delete;
  LoadedCode& operator=(const LoadedCode&) = delete;

  // The address of a C function; throws std::runtime_error when there is none such.
  template <class Function>
  Function* function(const std::string& name) const {
    return reinterpret_cast<Function*>(address(name));
  }

 private:
  void* address(const std::string& name) const;

  void* library_ = nullptr;
};

}  // namespace dalembert
