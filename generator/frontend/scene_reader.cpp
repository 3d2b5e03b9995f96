#include "frontend/scene_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "frontend/function_names.hpp"
#include "frontend/nearest.hpp"
#include "frontend/numbers.hpp"
#include "frontend/setting_text.hpp"
#include "frontend/text_encoding.hpp"
#include "frontend/text_file.hpp"
#include "frontend/yaml_text.hpp"
#include "ir/aliases.hpp"
#include "ir/constraint_words.hpp"
#include "ir/magnitudes.hpp"
#include "ir/plan_words.hpp"
#include "ir/rotation.hpp"

namespace dalembert::frontend {

namespace {

// Reads one key after another into the document. `file` is empty on the command line.
class SceneReader {
 public:
  using Handler = void (SceneReader::*)(const YamlNode&);
  struct Key {
    const char* name;
    Handler read;
  };
  static const std::vector<Key>& keys() {
    static const std::vector<Key> keys = {{"base", &SceneReader::base},
                                          {"gravity", &SceneReader::gravity},
                                          {"outputs", &SceneReader::outputs},
                                          {"functions", &SceneReader::functions},
                                          {"coriolis", &SceneReader::coriolis},
                                          {"forward_dynamics", &SceneReader::forward_dynamics},
                                          {"locked", &SceneReader::locked},
                                          {"cut", &SceneReader::cut},
                                          {"joints", &SceneReader::joints},
                                          {"mimic", &SceneReader::mimic},
                                          {"jacobians", &SceneReader::jacobians},
                                          {"frames", &SceneReader::frames},
                                          {"payloads", &SceneReader::payloads},
                                          {"wrenches", &SceneReader::wrenches},
                                          {"contacts", &SceneReader::contacts},
                                          {"loops", &SceneReader::loops},
                                          {"passive", &SceneReader::passive},
                                          {"armature", &SceneReader::armature},
                                          {"damping", &SceneReader::damping},
                                          {"friction", &SceneReader::friction},
                                          {"stiffness", &SceneReader::stiffness},
                                          {"elastic", &SceneReader::elastic},
                                          {"massless", &SceneReader::massless},
                                          {"inertia", &SceneReader::inertia},
                                          {"rates_zero", &SceneReader::rates_zero},
                                          {"scalar", &SceneReader::scalar},
                                          {"parallel", &SceneReader::parallel},
                                          {"plan", &SceneReader::plan},
                                          {"batch", &SceneReader::batch},
                                          {"rollouts", &SceneReader::rollouts}};
    return keys;
  }

  SceneReader(SceneDocument& document, std::string file)
      : document_(document), scene_(document.scene), file_(std::move(file)) {}

  void read(const std::string& key, const YamlNode& name, const YamlNode& value) {
    key_ = key;
    entry_.clear();
    document_.largest.erase(key);
    for (const Key& known : keys()) {
      if (key != known.name) continue;
      document_.given.insert(key);
      document_.places[key] = place(name);
      (this->*known.read)(value);
      return;
    }
    refuse(name, fmt::format("the key '{}' is unknown", key), suggestion(key, scene_keys()));
  }

  Place place(const YamlNode& node) const {
    if (file_.empty()) return {"", "option --" + std::string(key_)};
    return {file_, fmt::format("line {}, column {}: key '{}'", node.line, node.column, key_)};
  }

  [[noreturn]] void refuse(const YamlNode& node, std::string message, std::string remedy) const {
    const Place at = place(node);
    throw InputError({Severity::error, at.file, at.element, std::move(message), std::move(remedy)});
  }

 private:
  void base(const YamlNode& node) {
    scene_.base = choice<ir::Base>(node, {{"fixed", ir::Base::fixed}, {"floating", ir::Base::floating}});
  }
  void scalar(const YamlNode& node) {
    scene_.scalar = choice<ir::ScalarType>(node, {{"double", ir::ScalarType::float64}, {"float", ir::ScalarType::float32}});
  }
  void parallel(const YamlNode& node) {
    scene_.parallel = choice<ir::Parallel>(
        node, {{"serial", ir::Parallel::serial}, {"tasks", ir::Parallel::tasks}, {"auto", ir::Parallel::automatic}});
  }
  // {function: {form: straight, solver: factorization, order: as_written}, ...}
  void plan(const YamlNode& node) {
    scene_.plan.clear();
    forget_entries();
    const std::string remedy = "write plan: {evaluate: {form: straight}}, or let 'dalembert generate --plan measure' find it";
    if (node.is_scalar() && node.scalar == "measure")
      refuse(node, "'measure' is for the command line of generate and info", "write what was measured: " + remedy.substr(6));
    if (!node.is_map()) refuse(node, "the value is no map from functions to how they are computed", remedy);
    for (const auto& entry : node.entries) {
      const std::string function = entry_name(entry.key);
      if (!entry.value.is_map()) refuse(entry.value, fmt::format("how '{}' is computed is no map", function), remedy);
      ir::FunctionPlan& how = scene_.plan[function];
      for (const auto& part : entry.value.entries) {
        const std::string name = entry_name(part.key, function);
        if (name == "form") how.form = word(part.value, ir::form_words());
        else if (name == "solver") how.solver = word(part.value, ir::solver_words());
        else if (name == "order") how.order = word(part.value, ir::order_words());
        else
          refuse(part.key, fmt::format("'{}' is no part of a function's plan", name),
                 suggestion(name, {"form", "solver", "order"}));
      }
      if (how.form == ir::Form::rolled && how.order)
        refuse(entry.value, fmt::format("'{}' is rolled, and loops have no order of statements", function),
               "leave the order out, or write form: straight");
    }
  }
  template <class T>
  T word(const YamlNode& node, const std::vector<std::pair<std::string, T>>& words) const {
    std::vector<std::string> names;
    for (const auto& [name, value] : words) {
      if (node.is_scalar() && node.scalar == name) return value;
      names.push_back(name);
    }
    refuse(node, node.is_scalar() ? fmt::format("'{}' is unknown", node.scalar) : "the value is unknown",
           suggestion(node.is_scalar() ? node.scalar : "", names));
  }
  void coriolis(const YamlNode& node) {
    scene_.coriolis =
        choice<ir::Coriolis>(node, {{"balance", ir::Coriolis::balance}, {"christoffel", ir::Coriolis::christoffel}});
  }

  void forward_dynamics(const YamlNode& node) {
    scene_.forward_dynamics = choice<ir::Solver>(
        node, {{"articulated_bodies", ir::Solver::articulated_bodies}, {"factorization", ir::Solver::factorization}});
  }
  void massless(const YamlNode& node) { scene_.lock_massless = choice<bool>(node, {{"keep", false}, {"lock", true}}); }
  void inertia(const YamlNode& node) {
    scene_.inertia = choice<ir::InertiaPolicy>(
        node,
        {{"refuse", ir::InertiaPolicy::refuse}, {"accept", ir::InertiaPolicy::accept}, {"repair", ir::InertiaPolicy::repair}});
  }
  void rates_zero(const YamlNode& node) { scene_.rates_zero = choice<bool>(node, {{"true", true}, {"false", false}}); }

  void batch(const YamlNode& node) { scene_.batch = choice<bool>(node, {{"true", true}, {"false", false}}); }

  // [linearly_implicit], [impacts]
  void rollouts(const YamlNode& node) {
    scene_.linearly_implicit = scene_.impacts = false;
    for (const YamlNode& item : list(node, "a list of what rollouts shall know, such as [linearly_implicit]")) {
      if (item.scalar == "semi_implicit_euler" || item.scalar == "rk4")
        refuse(item, fmt::format("every rollout has '{}'", item.scalar), "leave it out");
      if (item.scalar == "linearly_implicit") scene_.linearly_implicit = true;
      else if (item.scalar == "impacts") scene_.impacts = true;
      else
        refuse(item, fmt::format("rollouts know no '{}'", item.scalar),
               suggestion(item.scalar, {"linearly_implicit", "impacts"}));
    }
  }

  // [x, y, z], none, run_time, or {run_time: [x, y, z]}
  void gravity(const YamlNode& node) {
    const std::string remedy = "write [0, 0, -9.81], none, run_time, or {run_time: [0, 0, -9.81]}";
    scene_.gravity = ir::Scene{}.gravity;
    scene_.gravity_kind = ir::GravityKind::constant;
    if (node.is_sequence()) {
      scene_.gravity = vector(node, remedy);
    } else if (node.is_scalar() && node.scalar == "none") {
      scene_.gravity_kind = ir::GravityKind::none;
      scene_.gravity.setZero();
    } else if (node.is_scalar() && node.scalar == "run_time") {
      scene_.gravity_kind = ir::GravityKind::run_time;
    } else if (node.is_map() && node.entries.size() == 1 && node.entries[0].key.is_scalar() &&
               node.entries[0].key.scalar == "run_time") {
      scene_.gravity_kind = ir::GravityKind::run_time;
      scene_.gravity = vector(node.entries[0].value, remedy);
    } else {
      refuse(node, "the value is no gravity", remedy);
    }
  }

  // [quantity, {quantity: part}, ...]
  void outputs(const YamlNode& node) {
    std::vector<std::string> known;
    for (const ir::QuantityRow& row : ir::quantities()) known.emplace_back(row.name);
    scene_.outputs.clear();
    scene_.parts.clear();
    std::map<std::string, const YamlNode*> parts;
    for (const YamlNode& item : list(in_our_names(named_alone(node, parts), ir::quantity_aliases()), "a list of quantities")) {
      const std::optional<ir::Quantity> quantity = ir::quantity_named(item.scalar);
      if (!quantity) {
        const std::string of_link = ir::named_by_us(item.scalar, ir::link_quantity_aliases());
        refuse(item, fmt::format("the quantity '{}' is unknown", item.scalar),
               ir::link_quantity_named(of_link) ? fmt::format("it is asked of a link: frames: {{left_foot: [{}]}}", of_link)
                                                : suggestion(item.scalar, known, ir::names_of(ir::quantity_aliases())));
      }
      scene_.outputs.push_back(*quantity);
    }
    for (const auto& [name, part] : parts)
      if (const auto quantity = ir::quantity_named(ir::named_by_us(name, ir::quantity_aliases())))
        scene_.parts[*quantity] = part_of(std::string(ir::name_of(*quantity)), ir::parts_of(*quantity), *part);
  }

  // The list, each {quantity: part} being its quantity alone; what is asked of it goes to `parts`.
  static YamlNode named_alone(const YamlNode& node, std::map<std::string, const YamlNode*>& parts) {
    YamlNode names = node;
    const auto add = [&](const YamlNode& map) {
      for (const auto& entry : map.entries) {
        names.items.push_back(entry.key);
        if (entry.key.is_scalar()) parts.emplace(entry.key.scalar, &entry.value);
      }
    };
    names.items.clear();
    if (node.is_map()) {
      names.kind = YamlNode::Kind::sequence;
      names.entries.clear();
      add(node);
    }
    for (const YamlNode& item : node.items)
      if (item.is_map()) add(item);
      else names.items.push_back(item);
    return names;
  }

  // {joints: [name or pattern, ...], subtree: link, base: true, links: [link, ...]}, of the result `name`.
  ir::Part part_of(const std::string& name, const ir::Parts& has, const YamlNode& node) const {
    const std::string remedy =
        has.of_links ? "write {regressor: {links: [left_hand]}}" : fmt::format("write {{{}: {{joints: [left_*]}}}}", name);
    if (!has.of_joints && !has.of_links)
      refuse(node, fmt::format("parts of {} cannot be asked for", name),
             fmt::format("ask for all of it: write {} alone, and take from it what you need", name));
    if (!node.is_map()) refuse(node, fmt::format("which part of {} is asked for is no map", name), remedy);
    ir::Part part;
    const auto names = [&](const YamlEntry& entry) {
      std::vector<YamlNode> items = entry.value.items;
      if (entry.value.is_scalar()) items = {entry.value};
      std::vector<std::string> list;
      for (const YamlNode& item : items) {
        if (!item.is_scalar() || item.scalar.empty()) refuse(item, "an item of the list is not a name", remedy);
        list.push_back(item.scalar);
      }
      if (list.empty())
        refuse(entry.value, fmt::format("no {} of {} are named", entry.key.scalar == "links" ? "links" : "joints", name),
               remedy);
      return list;
    };
    for (const auto& entry : node.entries) {
      const std::string key = entry.key.is_scalar() ? entry.key.scalar : "";
      if (key == "joints") part.joints = names(entry);
      else if (key == "subtree") part.subtrees = names(entry);
      else if (key == "base") part.base = choice<bool>(entry.value, {{"true", true}, {"false", false}});
      else if (key == "links" && has.of_links) part.links = names(entry);
      else if (key == "links")
        refuse(entry.key, fmt::format("{} has no columns of links", name), fmt::format("name joints: {}", remedy));
      else
        refuse(entry.key, fmt::format("'{}' is no part of {}", key, name),
               suggestion(key, has.of_links ? std::vector<std::string>{"joints", "subtree", "base", "links"}
                                            : std::vector<std::string>{"joints", "subtree", "base"}));
    }
    if (!part.names_joints() && part.links.empty())
      refuse(node, fmt::format("which part of {} is asked for is not said", name), remedy);
    return part;
  }

  // {name: [quantity, ..., frame, {what `frames` takes}], ...}
  void functions(const YamlNode& node) {
    scene_.functions.clear();
    document_.of_frames.clear();
    document_.placed_by_functions.clear();
    forget_entries();
    if (node.is_sequence() && node.items.empty()) return;
    const std::string remedy = "write functions: {balance: [mass_matrix, momentum_matrix]}";
    if (!node.is_map()) refuse(node, "the value is no map of functions", remedy);
    for (const auto& entry : node.entries) {
      ir::NamedFunction function{entry_name(entry.key), {}};
      if (const std::string fault = fault_of_function_name(function.name); !fault.empty())
        refuse(entry.key, fault, "give another name: letters, digits, and '_' between them, not starting with a digit");
      const YamlNode value = in_our_names(entry.value, ir::quantity_aliases());
      std::vector<YamlNode> items = value.items;
      if (!value.is_sequence()) items = {value};
      std::vector<AskedOfFrame>& of_frames = document_.of_frames[function.name];
      for (const YamlNode& item : items) {
        if (item.is_map() && takes_parts(item, function)) continue;
        if (item.is_map()) {
          std::vector<ir::LinkOutput> outputs;
          frame_map(item, function.name, outputs, document_.placed_by_functions);
          for (const ir::LinkOutput& output : outputs) of_frames.push_back({"", output});
          continue;
        }
        if (!item.is_scalar()) refuse(item, "an item of the list is neither a name nor a map of frames", remedy);
        entry_name(item, function.name);
        if (const std::optional<ir::Quantity> quantity = ir::quantity_named(item.scalar)) {
          function.quantities.push_back(*quantity);
          takes_one_input(item, function);
        } else {
          of_frames.push_back({item.scalar, std::nullopt});
        }
      }
      if (items.empty())
        refuse(entry.key, fmt::format("function '{}' computes nothing", function.name),
               "name at least one quantity, such as mass_matrix");
      scene_.functions.push_back(std::move(function));
    }
  }

  // Whether an item of a function is {quantity: part}, and not of frames.
  bool takes_parts(const YamlNode& item, ir::NamedFunction& function) {
    for (const auto& entry : item.entries) {
      const std::string name = entry.key.is_scalar() ? ir::named_by_us(entry.key.scalar, ir::quantity_aliases()) : "";
      const std::optional<ir::Quantity> quantity = ir::quantity_named(name);
      if (!quantity) return false;
      entry_name(entry.key, function.name);
      function.quantities.push_back(*quantity);
      function.parts[*quantity] = part_of(name, ir::parts_of(*quantity), entry.value);
      takes_one_input(entry.key, function);
    }
    return !item.entries.empty();
  }

  // What the last quantity takes besides q and v is what those before it take, if anything.
  void takes_one_input(const YamlNode& item, const ir::NamedFunction& function) const {
    const auto input = [](ir::Quantity quantity) { return std::string(ir::row_of(ir::row_of(quantity).function).input); };
    const ir::Quantity last = function.quantities.back();
    for (const ir::Quantity other : function.quantities)
      if (!input(other).empty() && !input(last).empty() && input(other) != input(last))
        refuse(item,
               fmt::format("'{}' takes {}, and '{}' takes {}: a function takes one of them", ir::name_of(last), input(last),
                           ir::name_of(other), input(other)),
               "make two functions of it");
  }

  // {joint: value, ...}, or [joint, ...] for zero
  void locked(const YamlNode& node) {
    scene_.locked.clear();
    if (node.is_map()) scene_.locked = values(node, "");
    else
      for (const YamlNode& item : list(node, "a map from joints to values, or a list of joints to lock at zero"))
        scene_.locked[item.scalar] = 0;
  }
  void cut(const YamlNode& node) {
    scene_.cut.clear();
    for (const YamlNode& item : list(node, "a list of links")) scene_.cut.insert(item.scalar);
  }
  void jacobians(const YamlNode& node) { scene_.jacobians = names(node, "a list of links"); }
  // [link, ...] for what is given by default, or a map
  void frames(const YamlNode& node) {
    scene_.frames.clear();
    scene_.placed.clear();
    if (!node.is_map()) {
      for (const std::string& link : names(node, what_frames_take))
        for (const ir::LinkQuantityRow& row : ir::link_quantities())
          if (row.by_default) scene_.frames.push_back({row.quantity, link});
      return;
    }
    forget_entries();
    frame_map(node, "", scene_.frames, scene_.placed);
  }
  static constexpr const char* what_frames_take =
      "a list of links, a map from links to lists of quantities, or {sole: {link: left_foot, at: [x, y, z, roll, pitch, yaw], "
      "outputs: [pose]}}";

  // {link: [quantity, ...], name: {link: link, at: [x, y, z, roll, pitch, yaw], outputs: [quantity, ...]}, ...}; `function`: in
  // which it stands, if any.
  void frame_map(const YamlNode& node, const std::string& function, std::vector<ir::LinkOutput>& outputs,
                 std::vector<ir::Frame>& placed) {
    for (const auto& entry : node.entries) {
      ir::Frame frame;
      frame.name = frame.link = entry_name(entry.key, function);
      const std::string inside = function.empty() ? frame.name : function + part_of_entry + frame.name;
      if (!entry.value.is_map()) {
        of_frame(frame.name, entry, entry.value, inside, outputs);
        continue;
      }
      const YamlNode* asked = nullptr;
      bool has_place = false;
      for (const auto& part : entry.value.entries) {
        const std::string name = entry_name(part.key, inside);
        if (name == "link") frame.link = link_of("frame", frame.name, part.value);
        else if (name == "at") place_on_link(part.value, frame.xyz, &frame.rpy), has_place = true;
        else if (name == "outputs") asked = &part.value;
        else refuse(part.key, fmt::format("'{}' is no part of a frame", name), suggestion(name, {"link", "at", "outputs"}));
      }
      if (has_place || frame.link != frame.name) placed.push_back(frame);
      // A frame may be there for others to name: for a wrench, a contact, a function.
      const bool nothing = asked && asked->is_sequence() && asked->items.empty() && (has_place || frame.link != frame.name);
      if (asked && !nothing) of_frame(frame.name, entry, *asked, inside, outputs);
      else if (!asked)
        for (const ir::LinkQuantityRow& row : ir::link_quantities())
          if (row.by_default) outputs.push_back({row.quantity, frame.name});
    }
  }
  void of_frame(const std::string& frame, const YamlEntry& entry, const YamlNode& asked, const std::string& inside,
                std::vector<ir::LinkOutput>& outputs) {
    const std::string remedy = fmt::format("write {}", what_frames_take);
    const YamlNode value = in_our_names(asked, ir::link_quantity_aliases());
    std::vector<YamlNode> items = value.items;
    if (value.is_scalar()) items = {value};
    else if (!value.is_sequence()) refuse(value, "the value is not a list", remedy);
    for (const YamlNode& listed : items) {
      const bool has_part = listed.is_map() && listed.entries.size() == 1 && listed.entries.front().key.is_scalar();
      YamlNode item = has_part ? listed.entries.front().key : listed;
      if (!item.is_scalar()) refuse(item, "an item of the list is not a name", remedy);
      item.scalar = ir::named_by_us(item.scalar, ir::link_quantity_aliases());
      const std::optional<ir::LinkQuantity> quantity = ir::link_quantity_named(item.scalar);
      if (!quantity) {
        std::vector<std::string> known;
        for (const ir::LinkQuantityRow& row : ir::link_quantities()) known.emplace_back(row.name);
        const std::string of_robot = ir::named_by_us(item.scalar, ir::quantity_aliases());
        refuse(item, fmt::format("the quantity '{}' of a link is unknown", item.scalar),
               ir::quantity_named(of_robot) ? fmt::format("it is the whole robot's: outputs: [{}]", of_robot)
                                            : suggestion(item.scalar, known, ir::names_of(ir::link_quantity_aliases())));
      }
      entry_name(item, inside);
      outputs.push_back({*quantity, frame});
      const ir::LinkQuantityRow& row = ir::row_of(*quantity);
      if (has_part)
        outputs.back().part = part_of(row.name, {ir::has_parts(row.rows, row.columns), false}, listed.entries.front().value);
    }
    if (items.empty())
      refuse(entry.key, fmt::format("nothing is asked for of link '{}'", frame), "name at least one quantity, such as pose");
  }
  // The link that a frame or a contact is on.
  std::string link_of(const char* kind, const std::string& name, const YamlNode& node) const {
    if (!node.is_scalar() || node.scalar.empty())
      refuse(node, fmt::format("what {} '{}' is on is not the name of a link", kind, name), "write link: left_foot");
    return node.scalar;
  }
  // [x, y, z], or, where it turns, [x, y, z, roll, pitch, yaw].
  void place_on_link(const YamlNode& node, Eigen::Vector3d& xyz, Eigen::Vector3d* rpy) const {
    const std::string remedy =
        rpy ? "write at: [0.1, 0, -0.02] or at: [0.1, 0, -0.02, 0, 0, 1.57], m and rad in the link's frame"
            : "write at: [0.1, 0, -0.02], m in the link's frame";
    if (!rpy || !node.is_sequence() || node.items.size() == 3) {
      xyz = vector(node, remedy);
      return;
    }
    if (node.items.size() != 6) refuse(node, "the place has neither three numbers nor six", remedy);
    for (int i = 0; i < 3; ++i) {
      xyz[i] = number(node.items[static_cast<size_t>(i)]);
      (*rpy)[i] = number(node.items[static_cast<size_t>(i) + 3]);
    }
  }
  // [link, …], or {link: link | world, …}
  void wrenches(const YamlNode& node) {
    scene_.wrenches.clear();
    if (!node.is_map()) {
      for (std::string& link : names(node, "a list of links, or {link: world}"))
        scene_.wrenches.push_back({std::move(link), false});
      return;
    }
    forget_entries();
    for (const auto& entry : node.entries) {
      const std::string link = entry_name(entry.key);
      scene_.wrenches.push_back({link, choice<bool>(entry.value, {{"link", false}, {"world", true}})});
    }
  }
  // {link: weld | point, ...}, or {name: {link: link, type: weld, at: [x, y, z], axes: world | link}, ...}
  void contacts(const YamlNode& node) {
    scene_.contacts.clear();
    forget_entries();
    if (node.is_sequence() && node.items.empty()) return;
    const std::string remedy =
        "write contacts: {left_foot: weld, toe: {link: right_foot, type: point, at: [0.1, 0, -0.02], axes: world}}";
    if (!node.is_map()) refuse(node, "the value is no map of contacts", remedy);
    for (const auto& entry : node.entries) {
      ir::Contact contact;
      contact.name = contact.link = entry_name(entry.key);
      if (entry.value.is_scalar()) {
        contact.type = contact_type(entry.value);
      } else if (entry.value.is_map()) {
        for (const auto& part : entry.value.entries) part_of_contact(contact, part);
      } else {
        refuse(entry.value, fmt::format("contact '{}' is neither a type nor a map", contact.name), remedy);
      }
      scene_.contacts.push_back(std::move(contact));
    }
  }
  ir::ContactType contact_type(const YamlNode& node) const { return type_of("contact", node, ir::contact_words()); }
  void part_of_contact(ir::Contact& contact, const YamlEntry& part) {
    const std::string name = entry_name(part.key, contact.name);
    if (name == "link") {
      contact.link = link_of("contact", contact.name, part.value);
    } else if (name == "type") {
      contact.type = contact_type(part.value);
    } else if (name == "at") {
      place_on_link(part.value, contact.at, nullptr);
    } else if (name == "axes") {
      contact.along_link = choice<bool>(part.value, {{"world", false}, {"link", true}});
    } else {
      refuse(part.key, fmt::format("'{}' is no part of a contact", name), suggestion(name, {"link", "type", "at", "axes"}));
    }
  }
  // {name: {links: [a, b], at: [pose, pose], type: hinge}, ...}
  void loops(const YamlNode& node) {
    scene_.loops.clear();
    scene_.embedded.clear();
    forget_entries();
    if (node.is_sequence() && node.items.empty()) return;
    const std::string remedy =
        "write loops: {rod: {links: [crank, rod], at: [[0.1, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]], type: hinge}}";
    if (!node.is_map()) refuse(node, "the value is no map of loops", remedy);
    for (const auto& entry : node.entries) {
      ir::Loop loop;
      loop.name = entry_name(entry.key);
      if (!entry.value.is_map()) refuse(entry.value, fmt::format("loop '{}' is no map", loop.name), remedy);
      bool typed = false;
      for (const auto& part : entry.value.entries) {
        part_of_loop(loop, part);
        typed = typed || part.key.scalar == "type";
      }
      if (loop.links[0].empty())
        refuse(entry.key, fmt::format("loop '{}' does not say which links it holds together", loop.name), remedy);
      if (!typed) refuse(entry.key, fmt::format("loop '{}' does not say of which type it is", loop.name), remedy);
      if (loop.length && loop.type != ir::LoopType::distance)
        refuse(entry.key, fmt::format("loop '{}' has a length and is no distance", loop.name),
               "remove length, or write type: distance");
      (loop.independent.empty() ? scene_.loops : scene_.embedded).push_back(std::move(loop));
    }
  }
  void part_of_loop(ir::Loop& loop, const YamlEntry& part) {
    const std::string name = entry_name(part.key, loop.name);
    if (name == "links") {
      const std::string remedy = "write links: [crank, rod]";
      if (!part.value.is_sequence() || part.value.items.size() != 2)
        refuse(part.value, fmt::format("what loop '{}' holds together is not two links", loop.name), remedy);
      for (std::size_t i = 0; i < 2; ++i) {
        const YamlNode& link = part.value.items[i];
        if (!link.is_scalar() || link.scalar.empty())
          refuse(link, fmt::format("a link of loop '{}' is no name", loop.name), remedy);
        loop.links[i] = link.scalar;
      }
    } else if (name == "at") {
      if (!part.value.is_sequence() || part.value.items.size() != 2)
        refuse(part.value, fmt::format("where loop '{}' holds is not two poses", loop.name), pose_remedy);
      for (std::size_t i = 0; i < 2; ++i) loop.at[i] = pose(part.value.items[i]);
    } else if (name == "type") {
      loop.type = loop_type(part.value);
    } else if (name == "length") {
      loop.length = number(part.value);
      if (!(*loop.length > 0))
        refuse(part.value, fmt::format("the length of loop '{}' is not positive", loop.name),
               "give a value above zero; points that coincide are type: point");
    } else if (name == "independent") {
      const std::string remedy = "write independent: [motor], or leave it out: the loop has rows then";
      if (!part.value.is_sequence() || part.value.items.empty())
        refuse(part.value, fmt::format("the independent joints of loop '{}' are no list of names", loop.name), remedy);
      for (const YamlNode& joint : part.value.items) {
        if (!joint.is_scalar() || joint.scalar.empty())
          refuse(joint, fmt::format("an independent joint of loop '{}' is no name", loop.name), remedy);
        if (std::find(loop.independent.begin(), loop.independent.end(), joint.scalar) != loop.independent.end())
          refuse(joint, fmt::format("loop '{}' names the independent joint '{}' twice", loop.name, joint.scalar),
                 "name it once");
        loop.independent.push_back(joint.scalar);
      }
    } else {
      refuse(part.key, fmt::format("'{}' is no part of a loop", name),
             suggestion(name, {"links", "at", "type", "length", "independent"}));
    }
  }
  ir::LoopType loop_type(const YamlNode& node) const { return type_of("loop", node, ir::loop_words()); }
  template <class T>
  T type_of(const char* kind, const YamlNode& node, const std::vector<std::pair<std::string, T>>& types) const {
    std::vector<std::string> names;
    for (const auto& [name, type] : types) {
      if (node.is_scalar() && node.scalar == name) return type;
      names.push_back(name);
    }
    const std::string given = node.is_scalar() ? node.scalar : "";
    refuse(node,
           given.empty() ? fmt::format("the type of a {} is no word", kind) : fmt::format("'{}' is no type of {}", given, kind),
           suggestion(given, names));
  }
  static constexpr const char* pose_remedy =
      "write at: [[0.1, 0, 0, 0, 0, 0], [0, 0, 0.2, 0, 0, 1.57]], on each link x y z (m) "
      "and roll pitch yaw (rad), or x y z alone";
  Eigen::Isometry3d pose(const YamlNode& node) const {
    if (!node.is_sequence() || (node.items.size() != 3 && node.items.size() != 6))
      refuse(node, "a pose does not have six numbers, or three", pose_remedy);
    Eigen::Vector3d parts[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    for (std::size_t i = 0; i < node.items.size(); ++i) parts[i / 3][static_cast<Eigen::Index>(i % 3)] = number(node.items[i]);
    Eigen::Isometry3d made = Eigen::Isometry3d::Identity();
    made.linear() = ir::without_rounding_dust(ir::rotation_from_rpy(parts[1]));
    made.translation() = parts[0];
    return made;
  }
  void passive(const YamlNode& node) { scene_.passive = names(node, "a list of joints"); }
  void payloads(const YamlNode& node) { scene_.payloads = names(node, "a list of links"); }

  void armature(const YamlNode& node) { scene_.armature = positive_values(node, false); }
  void damping(const YamlNode& node) {
    scene_.urdf_damping = says_urdf(node);
    scene_.damping = scene_.urdf_damping ? std::map<std::string, double>{} : positive_values(node, true);
  }
  void friction(const YamlNode& node) {
    scene_.urdf_friction = says_urdf(node);
    scene_.friction = scene_.urdf_friction ? std::map<std::string, double>{} : positive_values(node, true);
  }

  // {joint: {k: value, rest: 0}, ...}, or k alone
  void stiffness(const YamlNode& node) {
    scene_.stiffness.clear();
    forget_entries();
    const std::string remedy = "write stiffness: {joint: {k: 100, rest: 0}}, or {joint: 100} for a spring at rest at zero";
    if (!node.is_map()) refuse(node, "the value is not a map", remedy);
    for (const auto& entry : node.entries) {
      const std::string joint = entry_name(entry.key);
      std::map<std::string, const YamlNode*> parts{{"k", &entry.value}};
      if (!entry.value.is_scalar()) parts = parts_of_spring(joint, entry, {"k", "rest"}, {"k"}, remedy);
      ir::Spring& spring = scene_.stiffness[joint];
      spring.k = number(*parts.at("k"));
      if (spring.k < 0)
        refuse(*parts.at("k"), fmt::format("the stiffness of joint '{}' is negative", joint), "give a value of zero or more");
      if (parts.contains("rest")) spring.rest = number(*parts.at("rest"));
    }
  }

  // {joint: {k: value, inertia: value, damping: 0}, ...}
  void elastic(const YamlNode& node) {
    scene_.elastic.clear();
    forget_entries();
    const std::string remedy = "write elastic: {joint: {k: 1000, inertia: 0.3, damping: 1}}";
    if (!node.is_map()) refuse(node, "the value is not a map", remedy);
    for (const auto& entry : node.entries) {
      const std::string joint = entry_name(entry.key);
      const auto parts = parts_of_spring(joint, entry, {"k", "inertia", "damping"}, {"k", "inertia"}, remedy);
      const auto positive = [&](const char* part) {
        const double value = number(*parts.at(part));
        if (value <= 0)
          refuse(*parts.at(part), fmt::format("the {} of elastic joint '{}' is not positive", part, joint),
                 "give a value above zero; a joint left out is rigid");
        return value;
      };
      ir::Elasticity& made = scene_.elastic[joint];
      made.k = positive("k");
      made.inertia = positive("inertia");
      if (!parts.contains("damping")) continue;
      made.damping = number(*parts.at("damping"));
      if (made.damping < 0)
        refuse(*parts.at("damping"), fmt::format("the damping of elastic joint '{}' is negative", joint),
               "give a value of zero or more");
    }
  }

  std::map<std::string, const YamlNode*> parts_of_spring(const std::string& joint, const YamlEntry& entry,
                                                         const std::vector<std::string>& known,
                                                         const std::vector<std::string>& needed, const std::string& remedy) {
    if (!entry.value.is_map()) refuse(entry.value, fmt::format("the spring of '{}' is no map", joint), remedy);
    std::map<std::string, const YamlNode*> parts;
    for (const auto& part : entry.value.entries) {
      const std::string name = entry_name(part.key, joint);
      if (std::find(known.begin(), known.end(), name) == known.end())
        refuse(part.key, fmt::format("'{}' is no part of a spring", name), suggestion(name, known));
      parts[name] = &part.value;
    }
    for (const std::string& name : needed)
      if (!parts.contains(name)) refuse(entry.key, fmt::format("the spring of '{}' has no {}", joint, name), remedy);
    return parts;
  }

  // {joint: planar | {helical: pitch} | {universal: [x, y, z]}, ...}
  void joints(const YamlNode& node) {
    scene_.joints.clear();
    forget_entries();
    const std::string remedy = "write joints: {lead: {helical: 0.005}, wrist: {universal: [0, 1, 0]}, plate: planar}";
    if (node.is_sequence() && node.items.empty()) return;
    if (!node.is_map()) refuse(node, "the value is no map from joints to what they are", remedy);
    for (const auto& entry : node.entries) {
      const std::string joint = entry_name(entry.key);
      if (!entry.value.is_scalar() && !(entry.value.is_map() && entry.value.entries.size() == 1))
        refuse(entry.value, fmt::format("what is said of joint '{}' is neither a word nor a map of one", joint), remedy);
      const bool alone = entry.value.is_scalar();
      const YamlNode& word = alone ? entry.value : entry.value.entries.front().key;
      ir::JointKind& kind = scene_.joints[joint];
      kind.type = this->word(word, ir::joint_words());
      const bool takes = kind.type == ir::JointType::helical || kind.type == ir::JointType::universal;
      if (alone == takes)
        refuse(word,
               alone ? fmt::format("joint '{}' is {}, which needs {}", joint, word.scalar,
                                   kind.type == ir::JointType::helical ? "a pitch in m per turn" : "a second axis")
                     : fmt::format("'{}' takes no value", word.scalar),
               remedy);
      if (kind.type == ir::JointType::helical) kind.pitch = number(entry.value.entries.front().value);
      if (kind.type == ir::JointType::universal) {
        kind.second = vector(entry.value.entries.front().value, "write three numbers, in the child link's frame: " + remedy);
        if (!(kind.second.norm() > 0)) refuse(word, fmt::format("the second axis of joint '{}' is zero", joint), remedy);
        kind.second = kind.second.stableNormalized();
      }
    }
  }

  // {joint: {of: joint, multiplier: 1, offset: 0}, ...} or urdf
  void mimic(const YamlNode& node) {
    scene_.mimic.clear();
    forget_entries();
    document_.urdf_mimic = says_urdf(node);
    if (document_.urdf_mimic) return;
    const std::string remedy =
        "write {joint: {of: other_joint, multiplier: 1, offset: 0}}, or urdf to take the URDF's relations";
    if (!node.is_map()) refuse(node, "the value is no map of mimic relations", remedy);
    for (const auto& entry : node.entries) {
      const std::string joint = entry_name(entry.key);
      if (!entry.value.is_map()) refuse(entry.value, fmt::format("the relation of '{}' is not a map", joint), remedy);
      ir::Mimic relation;
      for (const auto& part : entry.value.entries) {
        const std::string name = entry_name(part.key, joint);
        if (name == "of") relation.of = driver(joint, part.value);
        else if (name == "multiplier") relation.multiplier = number(part.value);
        else if (name == "offset") relation.offset = number(part.value);
        else
          refuse(part.key, fmt::format("'{}' is no part of a mimic relation", name),
                 suggestion(name, {"of", "multiplier", "offset"}));
      }
      if (relation.of.empty())
        refuse(entry.key, fmt::format("the relation of '{}' does not say which joint drives it", joint), remedy);
      scene_.mimic[joint] = relation;
    }
  }

  std::string driver(const std::string& joint, const YamlNode& node) const {
    if (!node.is_scalar())
      refuse(node, fmt::format("what drives '{}' is not the name of a joint", joint), "write of: other_joint");
    return node.scalar;
  }

  template <class T>
  T choice(const YamlNode& node, const std::vector<std::pair<std::string, T>>& choices) const {
    std::vector<std::string> names;
    for (const auto& [name, value] : choices) {
      if (node.is_scalar() && node.scalar == name) return value;
      names.push_back(name);
    }
    const std::string given = node.is_scalar() ? fmt::format("'{}'", node.scalar) : "the value";
    refuse(node, fmt::format("{} is unknown", given), fmt::format("choose from {}", fmt::join(names, ", ")));
  }

  double number(const YamlNode& node) const {
    if (!node.is_scalar()) refuse(node, "the value is not a number", "write a finite decimal number");
    const std::optional<double> value = parse_number(node.scalar);
    if (!value || !std::isfinite(*value))
      refuse(node, fmt::format("'{}' is not a finite number", node.scalar), "write a finite decimal number");
    if (SceneDocument::Number& largest = document_.largest[key_]; std::abs(*value) > largest.size)
      largest = {std::abs(*value), node.scalar, entry_, place(node)};
    return *value;
  }

  Eigen::Vector3d vector(const YamlNode& node, const std::string& remedy) const {
    if (!node.is_sequence() || node.items.size() != 3) refuse(node, "the vector does not have three numbers", remedy);
    return {number(node.items[0]), number(node.items[1]), number(node.items[2])};
  }

  // A list of scalars without repetition; one scalar alone is a list of one. Records each item's place.
  std::vector<YamlNode> list(const YamlNode& node, const std::string& expected) {
    std::vector<YamlNode> items;
    if (node.is_scalar()) items.push_back(node);
    else if (node.is_sequence()) items = node.items;
    else refuse(node, "the value is not a list", "write " + expected);
    forget_entries();
    for (const YamlNode& item : items) {
      if (!item.is_scalar() || item.scalar.empty()) refuse(item, "an item of the list is not a name", "write " + expected);
      entry_name(item);
    }
    return items;
  }
  std::vector<std::string> names(const YamlNode& node, const std::string& expected) {
    std::vector<std::string> names;
    for (const YamlNode& item : list(node, expected)) names.push_back(item.scalar);
    return names;
  }

  // `otherwise`: what else the remedy offers.
  std::map<std::string, double> values(const YamlNode& node, const std::string& otherwise) {
    if (!node.is_map()) refuse(node, "the value is not a map", fmt::format("write {}: {{joint: value}}{}", key_, otherwise));
    forget_entries();
    std::map<std::string, double> values;
    for (const auto& entry : node.entries) {
      const std::string joint = entry_name(entry.key);
      values[joint] = number(entry.value);
    }
    return values;
  }
  std::map<std::string, double> positive_values(const YamlNode& node, bool in_urdf) {
    std::map<std::string, double> values = this->values(node, in_urdf ? ", or urdf to take the URDF's values" : "");
    for (const auto& entry : node.entries)
      if (const std::string& joint = entry.key.scalar; values.at(joint) < 0)
        refuse(entry.value, fmt::format("the {} of joint '{}' is negative", key_, joint), "give a value of zero or more");
    return values;
  }

  // A name, or a list of names, with ours for the field's.
  static YamlNode in_our_names(YamlNode node, const std::vector<ir::Alias>& aliases) {
    if (node.is_scalar()) node.scalar = ir::named_by_us(node.scalar, aliases);
    for (YamlNode& item : node.items)
      if (item.is_scalar()) item.scalar = ir::named_by_us(item.scalar, aliases);
    return node;
  }

  static bool says_urdf(const YamlNode& node) { return node.is_scalar() && node.scalar == "urdf"; }

  // The name of an entry; notes its place, and refuses one that is given twice.
  std::string entry_name(const YamlNode& node, const std::string& inside = "") {
    if (!node.is_scalar()) refuse(node, "a name was expected", "write the name of a joint or link");
    std::string entry = key_ + "/";
    if (!inside.empty()) entry += inside + part_of_entry;
    entry += node.scalar;
    entry_ = inside.empty() ? node.scalar : inside;
    if (!document_.places.emplace(entry, place(node)).second)
      refuse(node, fmt::format("'{}' is given twice", node.scalar), "keep one of them");
    return node.scalar;
  }
  void forget_entries() {
    std::erase_if(document_.places, [&](const auto& p) { return p.first.starts_with(key_ + "/"); });
  }

  SceneDocument& document_;
  ir::Scene& scene_;
  std::string file_;
  std::string key_, entry_;  // entry: the last that was named
};

// Which number type there is to be is known behind the last key.
void check_magnitudes(const SceneDocument& document) {
  Diagnostics errors;
  for (const std::string& key : scene_keys()) {
    const auto found = document.largest.find(key);
    if (found == document.largest.end() || found->second.size <= ir::largest_of(document.scene.scalar)) continue;
    const auto& [size, text, entry, place] = found->second;
    add_error(errors,
              {Severity::error, place.file, place.element,
               fmt::format("the number {}{} is larger in size than {}", text,
                           entry.empty() ? "" : fmt::format(" of '{}'", entry), ir::largest_in_words(document.scene.scalar)),
               "correct the number: lengths are m, masses kg, angles rad"});
  }
  if (!errors.empty()) throw InputError(errors);
}

void read_file(SceneDocument& document, const std::string& file, const std::string& text) {
  std::optional<YamlNode> root;
  try {
    root = read_yaml(as_utf8(text));
  } catch (const YamlError& error) {
    const bool is_yaml = !error.remedy.empty();
    throw InputError({Severity::error, file, fmt::format("line {}, column {}", error.line, error.column),
                      (is_yaml ? "" : "this is not YAML: ") + std::string(error.what()),
                      is_yaml ? error.remedy : "share/doc/dalembert/docs/scene.md shows how a scene is written"});
  }
  if (!root) return;
  SceneReader reader(document, file);
  if (!root->is_map())
    throw InputError({Severity::error, file, fmt::format("line {}, column {}", root->line, root->column),
                      "a scene is a map of keys to values", "write lines such as 'base: fixed'"});
  for (const auto& entry : root->entries) {
    const std::string key = entry.key.is_scalar() ? entry.key.scalar : "";
    const bool twice = document.given.count(key) > 0;
    reader.read(key, entry.key, entry.value);
    if (twice) reader.refuse(entry.key, "the key is given twice", "keep one of them");
  }
}

}  // namespace

const std::vector<std::string>& scene_keys() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> names;
    for (const SceneReader::Key& key : SceneReader::keys()) names.emplace_back(key.name);
    return names;
  }();
  return names;
}

SceneDocument read_scene(const std::string& file, const std::vector<Setting>& settings) {
  return read_scene_text(file, file.empty() ? "" : read_text_file(file, "scene", yaml_bytes), settings);
}

SceneDocument read_scene_text(const std::string& file, const std::string& text, const std::vector<Setting>& settings) {
  SceneDocument document;
  if (!file.empty()) read_file(document, file, text);
  for (const Setting& setting : settings) {
    YamlNode value;
    try {
      value = node_of(setting.text);
    } catch (const YamlError& error) {
      const bool is_yaml = !error.remedy.empty();
      throw InputError({Severity::error, "", "option --" + setting.key,
                        (is_yaml ? "" : "the value is not YAML: ") + std::string(error.what()),
                        is_yaml ? error.remedy : "share/doc/dalembert/docs/scene.md shows how it is written"});
    }
    SceneReader(document, "").read(setting.key, scalar_node(setting.key), value);
  }
  check_magnitudes(document);
  return document;
}

}  // namespace dalembert::frontend
