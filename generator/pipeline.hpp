// The compiler from top to bottom: a URDF and a scene become a Model, a Model becomes files.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "backend/output_files.hpp"
#include "diagnostics.hpp"
#include "frontend/scene_reader.hpp"
#include "ir/compile_options.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/robot_description.hpp"
#include "ir/scene.hpp"

namespace dalembert {

// What the user asks for.
struct Request {
  std::string robot;                                // URDF file
  std::string scene_file;                           // empty: none
  std::vector<frontend::Setting> settings;          // scene keys given on the command line; they override the file's
  std::string form;                                 // auto, straight or rolled; empty: auto
  std::vector<std::string> without;                 // passes to leave out
  std::string name;                                 // of the generated code; empty: the robot's, as an identifier
  std::shared_ptr<const ir::MachineCosts> costs{};  // measured ones that choices go by; null: the committed constants
  bool for_one_output = false;                      // who asks computes one output, and passes over the scene's
};

// What the compiler works on.
struct Model {
  ir::RobotDescription description;
  ir::Scene scene;
  ir::KinematicTree tree;
  ir::CompileOptions options;
  std::string name;          // namespace and folder of the generated code; an identifier
  std::string command_line;  // the command that remakes the generated code, with file names but without folders
};

// Two thousand take M and C ten seconds and 0.26 GB in one chain, whose M is full, and two seconds in branches of twenty; v̇
// some forty, for the self-test's results come of M's factors.
inline constexpr int most_moving_joints = 2000;

// Reads and checks the URDF and the scene, and builds the tree. Throws InputError, also when the scene's outputs need a mass
// and the robot has none; appends to `warnings`.
Model read_model(const Request& request, Diagnostics& warnings);

// The part of it that knows the scene: from the model's description as the URDF has it to its scene and tree. Inertias of the
// tree's bodies are what the scene makes of them.
void apply_scene(Model& model, const frontend::SceneDocument& document, Diagnostics& warnings);

// The model's generated code. Throws InputError when the model cannot be compiled.
std::vector<backend::OutputFile> compile(const Model& model);

// The same without self_test.hpp and self_test.cpp: for a use of the code that compares more itself.
std::vector<backend::OutputFile> compile_without_self_test(const Model& model);

}  // namespace dalembert
