// What is computed.
#include <fmt/format.h>

#include <map>
#include <optional>
#include <set>

#include "frontend/function_names.hpp"
#include "frontend/nearest.hpp"
#include "frontend/scene_keys.hpp"
#include "ir/aliases.hpp"

namespace dalembert::frontend {

namespace {

// The list, each {quantity: part} being its quantity alone; what is asked of it goes to `parts`.
YamlNode named_alone(const YamlNode& node, std::map<std::string, const YamlNode*>& parts) {
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

// A name, or a list of names, with ours for the field's.
YamlNode in_our_names(YamlNode node, const std::vector<ir::Alias>& aliases) {
  if (node.is_scalar()) node.scalar = ir::named_by_us(node.scalar, aliases);
  for (YamlNode& item : node.items)
    if (item.is_scalar()) item.scalar = ir::named_by_us(item.scalar, aliases);
  return node;
}

constexpr const char* what_frames_take =
    "a list of links, a map from links to lists of quantities, or {sole: {link: left_foot, at: [x, y, z, roll, pitch, yaw], "
    "outputs: [pose]}}";

}  // namespace

void SceneKeys::outputs(const YamlNode& node) {
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

ir::Part SceneKeys::part_of(const std::string& name, const ir::Parts& has, const YamlNode& node) const {
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
      refuse(entry.value, fmt::format("no {} of {} are named", entry.key.scalar == "links" ? "links" : "joints", name), remedy);
    return list;
  };
  std::set<std::string> given;
  for (const auto& entry : node.entries) {
    const std::string key = entry.key.is_scalar() ? entry.key.scalar : "";
    if (!given.insert(key).second) refuse(entry.key, fmt::format("'{}' is given twice", key), "keep one of them");
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

void SceneKeys::functions(const YamlNode& node) {
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

bool SceneKeys::takes_parts(const YamlNode& item, ir::NamedFunction& function) {
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

void SceneKeys::takes_one_input(const YamlNode& item, const ir::NamedFunction& function) const {
  const auto input = [](ir::Quantity quantity) { return std::string(ir::row_of(ir::row_of(quantity).function).input); };
  const ir::Quantity last = function.quantities.back();
  for (const ir::Quantity other : function.quantities)
    if (!input(other).empty() && !input(last).empty() && input(other) != input(last))
      refuse(item,
             fmt::format("'{}' takes {}, and '{}' takes {}: a function takes one of them", ir::name_of(last), input(last),
                         ir::name_of(other), input(other)),
             "make two functions of it");
}

void SceneKeys::jacobians(const YamlNode& node) { scene_.jacobians = names(node, "a list of links"); }

void SceneKeys::frames(const YamlNode& node) {
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

void SceneKeys::frame_map(const YamlNode& node, const std::string& function, std::vector<ir::LinkOutput>& outputs,
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

void SceneKeys::of_frame(const std::string& frame, const YamlEntry& entry, const YamlNode& asked, const std::string& inside,
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

}  // namespace dalembert::frontend
