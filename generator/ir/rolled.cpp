#include "ir/rolled.hpp"

namespace dalembert::ir {
namespace {

template <class... Lists>
std::vector<NodeId> nodes_of(const Lists&... lists) {
  std::vector<NodeId> nodes;
  const auto add = [&](const auto& list) {
    for (const auto& item : list) nodes.push_back(item.node);
  };
  (add(lists), ...);
  return nodes;
}

}  // namespace

std::vector<NodeId> LimbStep::roots() const { return nodes_of(stores, carried); }
std::vector<NodeId> Paragraph::roots() const { return nodes_of(stores, carried); }
std::vector<NodeId> BaseStage::roots() const { return nodes_of(stores, elements); }

int RolledProgram::levels() const {
  int highest = 0;
  for (const BaseStage& stage : base) highest = std::max(highest, stage.level);
  for (const SegmentCode& segment : segments)
    for (const SegmentStage& stage : segment.stages) highest = std::max(highest, stage.level);
  return highest + 1;
}

}  // namespace dalembert::ir
