// A library's sources become shared objects.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "commands/build/library.hpp"
#include "commands/compiler.hpp"

namespace dalembert {

// The code does not compute on this machine what it should.
class SelfTestFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Throws InputError where the file cannot be written whole.
void write_text(const std::filesystem::path& file, const std::string& text);

// A file to compile. What runs once need not be fast.
struct Unit {
  std::filesystem::path source;
  bool for_speed;
};

// The compiler's own files, too, go to a folder that is cleared: who kills it leaves them there. Of the whole process.
void keep_temporary_files_in(const std::filesystem::path& folder);

// How units become an object: compiler and flags, the folder that holds the parts' folders, what the object is linked with.
struct Compiling {
  std::vector<std::string> compiler_and_flags;
  std::filesystem::path sources;
  std::vector<std::string> libraries = {};
};

// `object` of the units, the longest first. What is written between goes into the folder `objects`. Throws InputError.
void compile_units(const std::vector<Unit>& units, const Compiling& how, const std::filesystem::path& objects,
                   const std::filesystem::path& object);

// Loaded while it is alive.
class SharedObject {
 public:
  // Throws std::runtime_error where it cannot be loaded.
  explicit SharedObject(const std::filesystem::path& file);
  ~SharedObject();
  SharedObject(const SharedObject&) = delete;
  SharedObject& operator=(const SharedObject&) = delete;
  void* symbol(const char* name) const;

 private:
  void* handle_;
};

// The self-tests of the object's table. Throws SelfTestFailure.
void run_self_tests(const std::filesystem::path& object);

}  // namespace dalembert
