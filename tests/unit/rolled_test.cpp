// What the rolled form says of its loops: text, counts and the interpreter read it, and decide nothing of it again.
#include "ir/rolled.hpp"

#include <gtest/gtest.h>

#include <set>

#include "both_forms.hpp"
#include "lower.hpp"

namespace dalembert {
namespace {

Lowered rolled(const char* name, bool write_limbs, ir::Scene scene = {}) {
  scene.outputs = {ir::Quantity::mass_matrix, ir::Quantity::coriolis_matrix, ir::Quantity::forward_dynamics,
                   ir::Quantity::forward_dynamics_dq};
  const ir::RobotDescription description = robot(name);
  scene.payloads = {description.links[static_cast<size_t>(description.joints.back().child)].name};
  Model model = model_of(description, scene);
  model.options.form = ir::Form::rolled;
  model.options.write_limbs = write_limbs;
  return lower(model);
}

// Whether a number stands in an array of the scratch, at a slot that there is.
class Addresses {
 public:
  explicit Addresses(const LoweredSection& section) : section_(section), program_(section.rolled) {}

  // own: whether there is a slot that a loop is at.
  void expect(const ir::Address& a, bool own) const {
    ASSERT_GE(a.role, 0);
    const auto role = static_cast<size_t>(a.role);
    ASSERT_LT(role, program_.roles.size());
    const ir::Place& place = program_.places[role];
    ASSERT_GE(place.array, 0) << program_.roles[role].name;
    EXPECT_GE(a.component, 0);
    EXPECT_LT(a.component, program_.roles[role].components());
    EXPECT_LT(place.from + a.component, program_.arrays[static_cast<size_t>(place.array)].components);
    if (a.body == ir::Address::own) EXPECT_TRUE(own) << program_.roles[role].name;
    else EXPECT_LT(section_.plan.slot(a.body), section_.plan.slots + 1);
  }
  void expect(const ir::Graph& graph, const std::vector<ir::NodeId>& roots, bool own) const {
    const std::set<ir::InputKind> without_addresses{ir::InputKind::state, ir::InputKind::of_body, ir::InputKind::received};
    ir::each_input(graph, roots, [&](const ir::Input& in) {
      EXPECT_FALSE(without_addresses.contains(in.kind));
      if (in.kind == ir::InputKind::kept) expect(ir::address(in), own);
    });
  }
  void expect(const ir::Segment& segment, const ir::Paragraph& p) const {
    expect(p.graph, p.roots(), true);
    for (const ir::Store& s : p.stores) expect(s.to, true);
    for (const ir::HandedOn& h : p.handed) expect(h.to, false);
    for (const ir::Carried& c : p.carried) {
      EXPECT_EQ(c.from.empty(), c.known());
      EXPECT_TRUE(c.from.size() <= 1 || c.from.size() == static_cast<size_t>(segment.width));
      for (const ir::Address& from : c.from) expect(from, false);
    }
    const bool side_by_side = segment.width > 1;  // a step is then at slots of its own, as a loop is
    for (const ir::LimbStep& step : p.written) {
      expect(step.graph, step.roots(), side_by_side);
      for (const ir::Store& s : step.stores) {
        expect(s.to, side_by_side);
        EXPECT_EQ(s.to.body, side_by_side ? ir::Address::own : step.body);
      }
    }
  }

 private:
  const LoweredSection& section_;
  const ir::RolledProgram& program_;
};

TEST(Rolled, SaysWhereAllStandsThatIsReadAndStored) {
  for (const char* name : {"chain_7", "hexapod", "two_levels_of_branching", "unequal_limbs"})
    for (const bool write_limbs : {false, true}) {
      SCOPED_TRACE(name);
      const Lowered lowered = rolled(name, write_limbs);
      for (const LoweredSection* section : lowered.all_sections()) {
        const Addresses addresses(*section);
        for (const ir::BaseStage& b : section->rolled.base) {
          addresses.expect(b.graph, b.roots(), false);
          for (const ir::Store& s : b.stores) addresses.expect(s.to, false);
        }
        for (size_t s = 0; s < section->plan.segments.size(); ++s)
          for (const ir::SegmentStage& stage : section->rolled.segments[s].stages)
            for (const ir::Paragraph& p : stage.paragraphs) addresses.expect(section->plan.segments[s], p);
      }
    }
}

TEST(Rolled, SaysWhichElementsAreWhichJoints) {
  ir::Scene follows;
  follows.mimic["link_03_joint"] = {"link_05_joint", 2, 0};
  for (const bool mimic : {false, true}) {
    const Lowered lowered = rolled("chain_7", true, mimic ? follows : ir::Scene{});
    size_t results = 0;
    for (const LoweredSection* section : lowered.all_sections())
      for (const ir::JointResult& joints : section->rolled.results) {
        const ir::Result& r = section->algorithm.results[static_cast<size_t>(joints.result)];
        const ir::OutputArray& array = section->algorithm.arrays[static_cast<size_t>(r.array)];
        const size_t components = static_cast<size_t>(section->rolled.roles[static_cast<size_t>(r.role)].components());
        EXPECT_EQ(joints.elements.size(), 7 * components) << array.name;
        EXPECT_EQ(joints.whole, !mimic) << array.name;
        std::set<int> set;
        for (const auto& [at, from, first] : joints.elements) {
          EXPECT_LT(at, array.rows * array.columns);
          EXPECT_EQ(set.insert(at).second, first) << "what comes behind the first is added to it";
          Addresses(*section).expect(from, false);
        }
        EXPECT_EQ(set.size(), (mimic ? 6 : 7) * components);
        ++results;
      }
    EXPECT_GT(results, 0u);
  }
}

using Lanes = ir::SlotLoop::Lanes;

TEST(Rolled, SaysHowLoopsGo) {
  for (const char* name : {"chain_7", "hexapod", "two_levels_of_branching", "unequal_limbs"}) {
    SCOPED_TRACE(name);
    const Lowered lowered = rolled(name, false);
    for (const LoweredSection* section : lowered.all_sections())
      for (size_t s = 0; s < section->plan.segments.size(); ++s)
        for (const ir::SegmentStage& stage : section->rolled.segments[s].stages)
          for (const ir::Paragraph& p : stage.paragraphs) {
            const ir::Segment& segment = section->plan.segments[s];
            EXPECT_EQ(p.loop.slots(), segment.slots());
            EXPECT_EQ(p.loop.limbs, segment.limbs());
            EXPECT_EQ(p.loop.by_steps(), p.loop.direction != ir::Direction::anywhere);
            EXPECT_EQ(p.loop.in_parts(), p.loop.by_steps() && segment.limbs() > 2) << "two share any register";
            EXPECT_EQ(p.loop.step(0), p.loop.direction == ir::Direction::inwards ? segment.steps - 1 : 0);
          }
  }
}

TEST(Rolled, ComputesNoMoreLanesThanLimbsNeed) {
  const ir::SlotLoop five{ir::Direction::outwards, Lanes::in_parts, 0, 2, 8, 5};
  EXPECT_EQ(five.computed(8), 2 * 8);
  EXPECT_EQ(five.computed(4), 2 * 5);
  EXPECT_EQ(five.computed(2), 2 * 5);
  EXPECT_EQ(five.trips(4), 2);
  EXPECT_EQ(five.side_by_side(4), 2);
  const ir::SlotLoop along{ir::Direction::anywhere, Lanes::along, 0, 9, 1, 1};
  EXPECT_EQ(along.computed(4), 12);
  EXPECT_EQ(along.trips(4), 3);
  EXPECT_EQ(along.side_by_side(4), 1);
}

}  // namespace
}  // namespace dalembert
