#include "commands/build/robot_json.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstring>

#include "commands/json.hpp"
#include "commands/labels.hpp"
#include "ir/moved_links.hpp"
#include "ir/run_time_inputs.hpp"

namespace dalembert {

namespace {

std::string number(double x) {
  if (std::isnan(x)) return "NaN";
  if (std::isinf(x)) return x > 0 ? "Infinity" : "-Infinity";  // as Python's json reads and writes them
  return fmt::format("{:.17g}", x);
}

std::string array(const std::vector<std::string>& items) { return fmt::format("[{}]", fmt::join(items, ", ")); }

// The registry's row of an output: its axes without those of extent one, symbol, unit and help.
std::string output_json(const Output& output, const std::string& of_function, const Model& model) {
  const auto [rows, columns] = output.axes();
  std::vector<std::string> shape;
  if (rows != ir::Extent::one) shape.push_back(std::to_string(output.rows));
  if (columns != ir::Extent::one) shape.push_back(std::to_string(output.columns));
  const Words words = words_of(output);
  std::string help = words.help;
  if (output.part) help += fmt::format(". Here {}", ir::in_words(*output.part, rows, columns, model.tree));
  std::string field = output.name;  // "mass_matrix" of the scene's "balance_mass_matrix"
  if (!of_function.empty() && field.starts_with(of_function + "_")) field = field.substr(of_function.size() + 1);
  // Of a part, what its rows and columns are.
  std::string names;
  if (output.part) {
    const Labels labels = labels_of(model, output);
    names = fmt::format(", \"rows\": {}, \"columns\": {}", json_array(labels.rows), json_array(labels.columns));
  }
  return fmt::format(
      "{{\"name\": {}, \"field\": {}, \"quantity\": {}, \"link\": {}, \"shape\": {}, \"symbol\": {}, \"unit\": {}, \"help\": "
      "{}{}}}",
      json_string(output.name), json_string(field), json_string(output.registered()), json_string(output.link), array(shape),
      json_string(words.symbol), json_string(words.unit), json_string(help), names);
}

std::string functions_json(const Library& library) {
  std::vector<std::string> all;
  for (size_t i = 0; i < library.functions.size(); ++i) {
    const TableFunction& f = library.functions[i];
    std::vector<std::string> results;
    for (const Output& output : f.results)
      results.push_back(output_json(output, f.function.named ? f.function.name : "", library.parts[f.part].model));
    all.push_back(fmt::format(
        "\n    {{\"name\": {}, \"function\": {}, \"entry\": {}, \"takes\": {}, \"meaning\": {}, \"reads_velocities\": {}, "
        "\"named\": {}, \"alone\": {}, \"part\": {}, \"folder\": {}, \"batch_entry\": {}, \"acceleration\": {}, "
        "\"linearly_implicit\": {}, \"results\": {}}}",
        json_string(table_name(f)), json_string(f.function.named ? f.function.name : ir::row_of(f.function.inputs).name), i,
        json_string(f.function.input()), json_string(f.function.meaning()), f.reads_velocities, f.function.named, f.of_one,
        f.part, json_string(library.parts[f.part].model.name), f.batch_entry, acceleration_of(f),
        f.batch_entry >= 0 && acceleration_of(f) >= 0 && library.parts[f.part].model.scene.linearly_implicit, array(results)));
  }
  return array(all);
}

std::string run_time_json(const Model& model) {
  std::vector<std::string> all;
  for (const ir::RunTimeInput& input : ir::run_time_inputs(model.scene)) {
    std::vector<std::string> start;
    for (const double x : input.start) start.push_back(number(x));
    all.push_back(fmt::format("{{\"name\": {}, \"unit\": {}, \"help\": {}, \"start\": {}}}", json_string(input.name),
                              json_string(input.unit), json_string(input.help), array(start)));
  }
  return array(all);
}

}  // namespace

std::string robot_json(const Library& library, const Request& request, const CompilerOptions& options,
                       std::uintmax_t code_bytes, const Diagnostics& warnings) {
  const Model& model = library.parts.front().model;
  const ir::KinematicTree& tree = model.tree;
  std::vector<std::string> joints, types, links, said, lower, upper, velocity, effort;
  for (const ir::Body& body : tree.bodies) {
    if (!body.independent()) continue;
    joints.push_back(body.joint);
    types.push_back(ir::row_of(body.type).word);
    ir::Limits limits;
    for (const ir::Joint& joint : model.description.joints)
      if (joint.name == body.joint) limits = joint.limits;
    lower.push_back(number(limits.lower));
    upper.push_back(number(limits.upper));
    velocity.push_back(number(limits.velocity));
    effort.push_back(number(limits.effort));
  }
  std::vector<std::string> quaternions, turning;
  for (const auto& [q, v, slides] : tree.quaternion_joints())
    quaternions.push_back(fmt::format("[{}, {}, {}]", q, v, slides ? 1 : 0));
  for (const ir::Body& body : tree.bodies)
    if (body.has_quaternion()) turning.push_back(body.of);
  for (const ir::LinkPlacement& link : tree.links) links.push_back(link.link);
  const std::vector<int> such = alike(warnings);
  for (size_t i = 0; i < warnings.size(); ++i)
    if (warnings[i].severity != Severity::error)
      said.push_back(fmt::format("[{}, {}, {}]", json_string(warnings[i].severity == Severity::warning ? "warning" : "notice"),
                                 json_string(to_string(warnings[i])), such[i]));
  std::string command = model.command_line;
  for (const char* words : {"dalembert ", "generate "})
    if (command.starts_with(words)) command = command.substr(std::strlen(words));
  return fmt::format(
      "{{\n  \"command_line\": {},\n  \"robot\": {},\n  \"name\": {},\n  \"file\": {},\n  \"base\": \"{}\",\n  \"base_link\": "
      "{},\n  \"nq\": {},\n"
      "  \"nv\": {},\n  \"scalar\": \"{}\",\n  \"quaternions\": {},\n  \"quaternion_joints\": {},\n  \"joints\": {},\n  "
      "\"joint_types\": {},\n  \"bodies\": "
      "{},\n  \"links\": {},\n"
      "  \"lower\": {},\n  \"upper\": {},\n  \"velocity\": {},\n  \"effort\": {},\n  \"functions\": {},\n  \"run_time\": {},\n"
      "  \"compiled_by\": {},\n  \"code_bytes\": {},\n  \"said\": {}\n}}\n",
      json_string(command), json_string(tree.robot), json_string(model.name), json_string(request.robot),
      ir::row_of(tree.base_joint).word, json_string(tree.base_link), tree.nq(), tree.nv(),
      model.scene.scalar == ir::ScalarType::float32 ? "float32" : "float64", array(quaternions), json_array(turning),
      json_array(joints), json_array(types), json_array(ir::names_of_links(tree)), json_array(links), array(lower),
      array(upper), array(velocity), array(effort), functions_json(library), run_time_json(model),
      json_string(fmt::format("{}", fmt::join(compiler_and_flags(options), " "))), code_bytes, array(said));
}

}  // namespace dalembert
