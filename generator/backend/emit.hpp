// From lowered code to the text of the emitted files.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "backend/output_files.hpp"
#include "ir/algorithm.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/normal_tree.hpp"
#include "ir/plan.hpp"
#include "ir/program.hpp"
#include "ir/rolled.hpp"
#include "ir/scene.hpp"
#include "ir/self_test.hpp"

namespace dalembert::backend {

// One section of a function of a robot's code.
struct CodeInput {
  const ir::KinematicTree& tree;  // the bodies that the function needs
  const ir::NormalTree& normal;
  const ir::Scene& scene;
  const ir::Algorithm& algorithm;
  const ir::Program& program;  // unrolled
  const ir::Plan& plan;
  const ir::RolledProgram& rolled;  // empty for the straight form
  std::string name;                 // namespace, folder and prefix; an identifier
  const ir::KinematicTree* robot;   // of which the function's tree may be a part
  // The same function in the other form, for registers of some widths; null: this form is for all.
  const CodeInput* elsewhere = nullptr;
  std::vector<int> elsewhere_lanes{};
  // For batches: the whole function as a straight line; null where there is none.
  const CodeInput* batch = nullptr;
  // For linearly implicit rollouts: likewise, of v̇ as such a step has it (LoweredFunction::implicit).
  const CodeInput* implicit = nullptr;
  const CodeInput* next = nullptr;    // the section behind; null: there is none
  const CodeInput* opened = nullptr;  // what a function with embedded loops calls; null where it has none

  bool is_rolled() const { return plan.form == ir::Form::rolled; }
  // Of the two, the one that is rolled, or null.
  const CodeInput* rolled_form() const {
    return is_rolled() ? this : elsewhere && elsewhere->is_rolled() ? elsewhere : nullptr;
  }
};

// A robot's folder.
struct Folder {
  std::vector<CodeInput> functions;  // at least one; of one robot, scene and name; the first section of each
  std::deque<CodeInput> others;      // what they point to
  std::string source;                // the URDF's file name, without folders
  std::string source_hash;
  std::string command_line;         // that remakes the files
  std::vector<std::string> report;  // lines about operations and what was left out
  std::optional<ir::SelfTest> self_test;

  const CodeInput& common() const { return functions.front(); }
  // The outputs of all functions, one after another.
  std::vector<ir::OutputArray> arrays() const;
  bool tasks() const;                              // whether any function has a task graph
  std::vector<const CodeInput*> sections() const;  // of all functions, one after another
};

// The function's sections in order, behind them what it calls for embedded loops.
std::vector<const CodeInput*> sections_of(const CodeInput& function);

// Every file of the robot's folder; without a self-test its files are left out. Needs no input but its argument: the same code
// gives the same bytes anywhere.
std::vector<OutputFile> emit(const Folder& folder);

}  // namespace dalembert::backend
