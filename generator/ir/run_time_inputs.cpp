#include "ir/run_time_inputs.hpp"

#include <stdexcept>

#include "ir/identifier.hpp"

namespace dalembert::ir {

namespace {

RunTimeInput gravity(const Scene& scene) {
  RunTimeInput input{InputKind::gravity, 0, "gravity_vector", "", "gravity_vectors"};
  input.meaning = "acceleration of free fall, m/s^2, world axes";
  input.unit = "m/s^2", input.help = "gravity along the world's axes";
  input.members = {{input.name, 3}};
  input.start = {scene.gravity[0], scene.gravity[1], scene.gravity[2]};
  return input;
}

RunTimeInput payload(const Scene& scene, int index) {
  const std::string& link = scene.payloads.at(static_cast<size_t>(index));
  RunTimeInput input{InputKind::payload, index, "payload_" + identifier(link), "Payload", "payloads_" + identifier(link)};
  input.meaning = "carried by " + scene.called(link);
  input.unit = "kg, m, kg m^2";
  input.help = "what " + scene.called(link) + " carries: mass, centre of mass, inertia xx xy xz yy yz zz about it; its axes";
  input.members = {{input.name + ".mass"}, {input.name + ".com", 3}, {input.name + ".inertia", 6}};
  input.start.assign(10, 0.0);
  return input;
}

RunTimeInput wrench(const Scene& scene, int index) {
  const ExternalWrench& wrench = scene.wrenches.at(static_cast<size_t>(index));
  const std::string id = identifier(wrench.link), on = scene.called(wrench.link),
                    axes = wrench.in_world ? "the world's" : "its";
  RunTimeInput input{InputKind::wrench, index, "wrench_" + id, "", "wrenches_" + id};
  input.meaning = "external force, N, and moment, N m, on " + on + " at its origin, along " + axes + " axes";
  input.unit = "N, N m", input.help = "force and moment on " + on + " at its origin, along " + axes + " axes";
  input.members = {{input.name, 6}};
  input.start.assign(6, 0.0);
  return input;
}

RunTimeInput constraint(const Constraint& c, int index) {
  RunTimeInput input{InputKind::constraint, index, c.member, c.loop ? "Loop" : "Contact"};
  const std::string word = c.loop ? "loop" : "contact";
  input.each = word + "s" + c.member.substr(word.size());
  const std::string rows = std::to_string(c.rows);
  input.meaning = "of " + c.of;
  input.unit = c.loop ? "1, 1/s^2, 1/s, 1, 1/kg" : "1, 1/s^2, 1/s, 1, m, 1/kg";
  input.help = "how " + c.of + (c.loop ? " hold each other" : " is held") + ": active (1 or 0), kp, kd, restitution, " +
               (c.loop ? "" : "anchor (3, quaternion x y z w), ") + "regularization (" + rows + "), weight (" + rows + ")";
  input.members = {{c.member + ".active", 0, true}, {c.member + ".kp"}, {c.member + ".kd"}, {c.member + ".restitution"}};
  input.start = {1, 0, 0, 0};
  const auto array = [&](const char* name, const std::vector<double>& start) {
    input.members.push_back({c.member + name, static_cast<int>(start.size())});
    input.start.insert(input.start.end(), start.begin(), start.end());
  };
  if (!c.loop) array(".anchor", {0, 0, 0, 0, 0, 0, 1});
  array(".regularization", std::vector<double>(static_cast<size_t>(c.rows), 0.0));
  array(".weight", std::vector<double>(static_cast<size_t>(c.rows), 1.0));
  return input;
}

}  // namespace

std::string RunTimeInput::number(int i) const {
  for (const Member& member : members) {
    if (i < member.count()) return member.size > 0 ? member.name + "[" + std::to_string(i) + "]" : member.name;
    i -= member.count();
  }
  return "";
}

std::vector<RunTimeInput> run_time_inputs(const Scene& scene) {
  std::vector<RunTimeInput> all;
  if (scene.gravity_kind == GravityKind::run_time) all.push_back(gravity(scene));
  for (size_t i = 0; i < scene.payloads.size(); ++i) all.push_back(payload(scene, static_cast<int>(i)));
  for (size_t i = 0; i < scene.wrenches.size(); ++i) all.push_back(wrench(scene, static_cast<int>(i)));
  const std::vector<Constraint> constraints = scene.constraints();
  for (size_t i = 0; i < constraints.size(); ++i) all.push_back(constraint(constraints[i], static_cast<int>(i)));
  return all;
}

RunTimeInput run_time_input(const Scene& scene, const Input& input) {
  switch (input.kind) {
    case InputKind::gravity: return gravity(scene);
    case InputKind::payload: return payload(scene, input.index);
    case InputKind::wrench: return wrench(scene, input.index);
    case InputKind::constraint: return constraint(scene.constraints().at(static_cast<size_t>(input.index)), input.index);
    default: throw std::logic_error("no run-time input of the scene");
  }
}

}  // namespace dalembert::ir
