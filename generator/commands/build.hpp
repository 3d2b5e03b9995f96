// `dalembert build`: a robot's functions compiled into a shared object that programs load, kept in the cache.
//
// An entry of the cache holds
//   code.so      exports dalembert_function_table() of dalembert/function_table.hpp
//   robot.json   what the functions take and give, joints, limits, what was said about the input
//   source/      NAME/: the generated code of the whole scene, as `dalembert generate` writes it; OUTPUT_of_NAME/: that of one
//   output
//                alone, where a function has several
// Where a function has several outputs, each also has a function of its own: who asks for M alone does not pay for C.
#pragma once

#include <string>

#include "commands/compiler.hpp"
#include "pipeline.hpp"

namespace dalembert {

// The code computes on this machine something else than it should.
class SelfTestFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The folder of the entry, made where the cache has none of these inputs, this generator, compiler and processor: generated,
// compiled, each part's self-test run. Inputs are known by their bytes and file names, so that a hit reads no robot. Throws
// InputError as read_model() does, where the code cannot be compiled or the cache not be written; SelfTestFailure.
std::string build(const Request& request, const CompilerOptions& options, Diagnostics& warnings);

// What an entry was made of, for people: "mahru.urdf --base fixed".
std::string command_line_of(const std::filesystem::path& entry);

// The quantities and those of links, a line each; and with the scene's keys as one JSON object.
std::string registry_text();
std::string registry_json();

}  // namespace dalembert
