// Loops that are written out: what bodies' constants leave of them. That the numbers are the same, tests of both forms say,
// which run either.
#include "passes/write_limbs.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <string>

#include "both_forms.hpp"
#include "compile.hpp"
#include "lower.hpp"

namespace dalembert {
namespace {

Lowered rolled(const char* name, bool write_limbs) {
  ir::Scene scene;
  scene.outputs = {ir::Quantity::mass_matrix, ir::Quantity::coriolis_matrix, ir::Quantity::bias};
  Model model = model_of(robot(name), scene);
  model.options.form = ir::Form::rolled;
  model.options.write_limbs = write_limbs;
  return lower(model);
}

using Visit =
    std::function<void(const LoweredSection&, size_t segment, const ir::Paragraph&, const std::vector<ir::LimbStep>&)>;
void each_paragraph(const Lowered& lowered, const Visit& visit) {
  for (const LoweredFunction& f : lowered.functions)
    for (const LoweredSection& section : f.sections)
      for (size_t s = 0; s < section.plan.segments.size(); ++s)
        for (const ir::SegmentStage& stage : section.rolled.segments[s].stages)
          for (const ir::Paragraph& p : stage.paragraphs) visit(section, s, p, p.written);
}

long operations(const ir::Graph& graph, const std::vector<ir::NodeId>& roots) {
  return ir::count(graph, ir::uses(graph, roots)).total();
}

TEST(WriteLimbs, IsShorterThanTheLoopAndReadsNoTable) {
  long in_loops = 0, written_out = 0;
  each_paragraph(rolled("chain_7", true), [&](const LoweredSection& section, size_t segment, const ir::Paragraph& p,
                                              const auto& steps) {
    if (!p.loop.by_steps()) {
      EXPECT_TRUE(steps.empty()) << "lanes along the limb are better";
      return;
    }
    ASSERT_EQ(steps.size(), static_cast<size_t>(section.plan.segments[segment].steps));
    in_loops += static_cast<long>(steps.size()) * operations(p.graph, p.roots());
    for (const ir::LimbStep& step : steps) {
      written_out += operations(step.graph, step.roots());
      EXPECT_EQ(step.stores.size(), p.stores.size());
      for (ir::NodeId id = 0; id < step.graph.size(); ++id) {
        const ir::Node& n = step.graph[id];
        EXPECT_FALSE(n.op == ir::Op::input && n.input.kind == ir::InputKind::table);
      }
    }
    EXPECT_TRUE(p.loop.direction == ir::Direction::inwards || steps.back().carried.empty()) << "nobody is behind the last body";
  });
  EXPECT_GT(written_out, 0);
  EXPECT_LT(written_out, in_loops);
}

// Of limbs side by side that are alike: what differs among them stays in tables, and a step is all of them.
TEST(WriteLimbs, OfLimbsSideBySideFoldsWhatAllHave) {
  long loops = 0, in_loops = 0, written_out = 0, tables = 0;
  each_paragraph(rolled("mahru", true),
                 [&](const LoweredSection& section, size_t segment, const ir::Paragraph& p, const auto& steps) {
                   if (steps.empty() || p.loop.width == 1) return;
                   ++loops;
                   ASSERT_EQ(steps.size(), static_cast<size_t>(section.plan.segments[segment].steps));
                   in_loops += static_cast<long>(steps.size()) * operations(p.graph, p.roots());
                   for (const ir::LimbStep& step : steps) {
                     written_out += operations(step.graph, step.roots());
                     EXPECT_EQ(step.place, p.loop.step(static_cast<int>(&step - steps.data())));
                     for (const ir::Store& store : step.stores) EXPECT_EQ(store.to.body, ir::Address::own);
                     ir::each_input(step.graph, step.roots(), [&](const ir::Input& in) {
                       if (in.kind != ir::InputKind::table) return;
                       ++tables;
                       std::set<double> values;
                       const ir::Column& column = section.rolled.segments[segment].columns[static_cast<size_t>(in.index)];
                       for (const int lane : p.live_lanes)
                         values.insert(column.values[static_cast<size_t>(step.place * p.loop.width + lane)]);
                       EXPECT_GT(values.size(), 1u) << column.names.front() << " is the same in all lanes";
                     });
                   }
                 });
  EXPECT_GT(loops, 0);
  EXPECT_GT(tables, 0) << "its left limbs mirror the right ones";
  EXPECT_LT(4 * written_out, 3 * in_loops);
}

TEST(WriteLimbs, IsOfLimbsThatAreShortAndFoldAndWhereItIsNotLeftOut) {
  const auto any = [](const Lowered& lowered) {
    bool found = false;
    each_paragraph(lowered, [&](const auto&, size_t, const auto&, const auto& steps) { found = found || !steps.empty(); });
    return found;
  };
  EXPECT_TRUE(any(rolled("chain_7", true)));
  EXPECT_FALSE(any(rolled("chain_7", false)));
  EXPECT_FALSE(any(rolled("chain_50", true))) << "its text would be fetched anew in every call";
  EXPECT_TRUE(any(rolled("mahru", true)));
  EXPECT_FALSE(any(rolled("mahru", false)));
  bool all = true;
  each_paragraph(rolled("mahru", true), [&](const auto&, size_t, const ir::Paragraph& p, const auto& steps) {
    all = all && (!p.loop.by_steps() || !steps.empty());
  });
  EXPECT_FALSE(all) << "of what hardly folds the text is longer than it is worth";
}

}  // namespace
}  // namespace dalembert
