// What is generated for programs that load a robot: folders of code, and which function comes from which.
//
// Several quantities in one call are the whole scene's folder, the one that `dalembert generate` writes. Each quantity by
// itself is a folder of its own, as `generate --outputs QUANTITY` writes it and `eval` computes it: who asks for M alone does
// not pay for C, and has the same bits whatever else the scene asks for.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "backend/output_files.hpp"
#include "commands/output.hpp"
#include "diagnostics.hpp"
#include "ir/emitted_function.hpp"
#include "pipeline.hpp"

namespace dalembert {

// A folder of generated code.
struct Part {
  Model model;
  std::vector<backend::OutputFile> files;
};

// One function of a part, as the table has it.
struct TableFunction {
  size_t part;
  ir::EmittedFunction function;
  std::vector<Output> results;
  bool of_one = false;  // one of a function's several outputs, whose name it bears in the table
  bool reads_velocities = true;
  int batch_entry = -1;  // in the table of its part's batches; −1: there is none
};

struct Library {
  std::vector<Part> parts;  // the whole scene first
  std::vector<TableFunction> functions;
};

// Appends to `warnings` what of the scene is not for programs that load it. Nothing is generated yet.
Library library_of(const Model& model, Diagnostics& warnings);

// Which functions read v, in whichever of their sections.
void find_what_is_read(Library& library);

std::string table_name(const TableFunction& function);

// Which of the function's results is v̇, so that motions can be computed with it; −1: none.
int acceleration_of(const TableFunction& function);

}  // namespace dalembert
