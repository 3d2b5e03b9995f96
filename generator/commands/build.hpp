// `dalembert build`: a robot's functions compiled into a shared object that programs load, kept in the cache.
//
// An entry of the cache holds
//   code.so        exports dalembert_function_table() of dalembert/function_table.hpp: functions of one state
//   robot.json     what the functions take and give, joints, limits, what was said about the input
//   source/        NAME/: the generated code of the whole scene, as `dalembert generate` writes it, with batches;
//   QUANTITY_of_NAME/:
//                  that of one quantity alone; tables of both
//   batches_P.so   the batches of part P of these, compiled when they are asked for first: exports a table of its functions
//   that
//                  compute states in the lanes of registers
//   batches_P.json its size; written last
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "commands/build/compile_library.hpp"
#include "commands/compiler.hpp"
#include "pipeline.hpp"

namespace dalembert {

// The folder of the entry, made where the cache has none of these inputs, this generator, compiler and processor: generated,
// compiled, each part's self-test run. Inputs are known by their bytes and file names, so that a hit reads no robot. Throws
// InputError as read_model() does, where the code cannot be compiled or the cache not be written; SelfTestFailure.
std::string build(const Request& request, const CompilerOptions& options, Diagnostics& warnings);

// Compiles batches of an entry that has none yet, and runs their self-tests; parts as robot.json numbers them. Throws as
// build() does, and InputError where there is no such entry, or one of another generator.
void build_batches(const std::filesystem::path& entry, const std::vector<size_t>& parts);

// What an entry was made of, for people: "mahru.urdf --base fixed".
std::string command_line_of(const std::filesystem::path& entry);

}  // namespace dalembert
