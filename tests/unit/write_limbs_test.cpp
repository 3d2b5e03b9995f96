// Loops over a limb that stands alone, written out: what its bodies' constants leave of them. That the numbers are the same,
// tests of both forms say, which run either.
#include "passes/write_limbs.hpp"

#include <gtest/gtest.h>

#include <functional>
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

TEST(WriteLimbs, IsOfALimbAloneThatIsShortAndWhereItIsNotLeftOut) {
  const auto any = [](const Lowered& lowered) {
    bool found = false;
    each_paragraph(lowered, [&](const auto&, size_t, const auto&, const auto& steps) { found = found || !steps.empty(); });
    return found;
  };
  EXPECT_TRUE(any(rolled("chain_7", true)));
  EXPECT_FALSE(any(rolled("chain_7", false)));
  EXPECT_FALSE(any(rolled("chain_50", true))) << "its text would be fetched anew in every call";
  EXPECT_FALSE(any(rolled("hexapod", true))) << "its limbs stand side by side";
}

}  // namespace
}  // namespace dalembert
