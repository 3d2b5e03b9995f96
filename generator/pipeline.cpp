#include "pipeline.hpp"

#include <filesystem>

#include "frontend/scene_check.hpp"
#include "frontend/urdf_reader.hpp"
#include "ir/identifier.hpp"
#include "passes/build_tree.hpp"

namespace dalembert {

Model read_model(const Request& request, Diagnostics& warnings) {
  Model model;
  model.description = frontend::read_urdf(request.robot, warnings);
  model.scene.base = frontend::default_base(model.description);
  model.tree = passes::build_tree(model.description, model.scene, warnings);
  model.name = request.name.empty() ? ir::identifier(model.description.name) : request.name;
  model.command_line =
      "dalembert generate " + std::filesystem::path(request.robot).filename().string() + " --name " + model.name;
  return model;
}

}  // namespace dalembert
