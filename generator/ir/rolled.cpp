#include "ir/rolled.hpp"

#include <bit>

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
std::vector<NodeId> RolledProjection::roots() const { return nodes_of(base); }

int SlotLoop::computed(int register_lanes) const {
  if (!by_steps()) return register_lanes * trips(register_lanes);
  const int left = limbs % register_lanes;
  return steps * (limbs - left + (left > 0 ? static_cast<int>(std::bit_ceil(static_cast<unsigned>(left))) : 0));
}

int RolledProgram::levels() const {
  int highest = 0;
  for (const BaseStage& stage : base) highest = std::max(highest, stage.level);
  for (const SegmentCode& segment : segments)
    for (const SegmentStage& stage : segment.stages) highest = std::max(highest, stage.level);
  return highest + 1;
}

}  // namespace dalembert::ir
