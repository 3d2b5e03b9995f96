// Pieces of text that more than one emitted file needs: inputs, results, indices.
#pragma once

#include <string>
#include <vector>

#include "backend/emit.hpp"

namespace dalembert::backend {

const ir::EmittedFunction& function_of(const CodeInput& code);
// What a form of it is called in dynamics.cpp, and the words before its type.
struct Symbol {
  std::string name, linkage;
};
// The names of what is one function's own: a member or namespace, "scratch" or "inverse_dynamics_scratch", and a type,
// "Scratch" or "InverseDynamicsScratch".
std::string own_name(const CodeInput& code, const std::string& name);
std::string own_type(const CodeInput& code, const std::string& type);
// What it takes: q, v and what its row says. As parameters, each after `pointer`; and as arguments.
std::vector<std::string> vectors_of(const CodeInput& code);
std::string parameters_of(const CodeInput& code, const std::string& pointer = "const Scalar* ");
std::string arguments_of(const CodeInput& code);
// The same as vectors of Eigen, which dalembert/arguments.hpp checks: template parameters, their names, the types that they
// stand for, and parameters.
struct EigenVectors {
  std::string templates, types, vectors, parameters;
};
EigenVectors eigen_vectors_of(const CodeInput& code);

// The text of an input on the evaluation path: q[7], v[6], workspace.gravity_vector[2], workspace.payload_hand.mass …
std::string input_text(const CodeInput& code, const ir::Input& input);

// Statements behind the results: whether they mean something, and that they are zero if not.
std::string guard_statements(const CodeInput& code);
// The first of them: `check` is the runtime's function that says so, and its first arguments.
std::string status_statement(const CodeInput& code, const std::string& check);
// The others.
std::string clear_statements(const CodeInput& code);

// Of a section that another calls (ir/algorithm.hpp), and the statement that this ends by; empty where none is behind it.
std::string section_declaration(const CodeInput& section);
std::string next_section_call(const CodeInput& section);

// What a function computes: the names of its results.
std::string quantities(const CodeInput& code);
// What stands at a result: symbol, shape, unit, meaning; the shape alone of what no registry knows.
std::string result_words(const Folder& folder, const ir::OutputArray& array);

// `row + nv * column` worked out.
int element_index(const ir::OutputArray& array, int row, int column);

}  // namespace dalembert::backend
