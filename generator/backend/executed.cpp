#include "backend/executed.hpp"

#include <algorithm>
#include <vector>

#include "backend/emit_prepare.hpp"
#include "backend/emit_projections.hpp"
#include "backend/emit_rolled.hpp"
#include "backend/emit_straight.hpp"
#include "ir/embedding_cost.hpp"

namespace dalembert::backend {
namespace {

ir::Operations of(const ir::Graph& graph, const std::vector<ir::NodeId>& roots, long times = 1) {
  ir::Operations o = ir::count(graph, ir::uses(graph, roots));
  o.add *= times, o.multiply *= times, o.divide *= times;
  o.sincos = 0;
  return o;
}

ir::Operations paragraph(const ir::Paragraph& p) {
  ir::Operations sum;
  if (p.written.empty()) sum = of(p.graph, p.roots(), p.loop.computed(counted_lanes));
  for (const ir::LimbStep& step : p.written) sum += of(step.graph, step.roots(), p.loop.computed(counted_lanes) / p.loop.steps);
  // Sums over lanes, and what they are added to.
  for (const ir::HandedOn& h : p.handed) sum.add += static_cast<long>(h.lanes.size()) - (h.first ? 1 : 0);
  return sum;
}

ir::Operations base(const ir::BaseStage& stage) { return of(stage.graph, stage.roots()); }

void add_elements(const CodeInput& code, ir::Operations& sum) {
  for (const ir::PairBlocks& matrices : code.rolled.blocks)
    for (size_t segment = 0; segment < code.plan.segments.size(); ++segment)
      for (const ir::ElementSums& sums : matrices.sums) {
        const ir::ElementCounts computed = ir::element_counts(code.tree, code.plan.segments[segment], matrices,
                                                              matrices.segments[segment], sums.symmetric, counted_lanes);
        const auto add = [&](const std::vector<ir::FactorTerm>& terms, long elements) {
          const long products = 3 * static_cast<long>(terms.size());
          if (products == 0) return;
          sum.multiply += products * elements;
          sum.add += (products - 1) * elements;
        };
        add(sums.above, computed.above);
        add(sums.symmetric ? sums.above : sums.below, computed.below);
        sum.add += computed.added_to_zero;
      }
}

void add_projections(const CodeInput& code, ir::Operations& sum) {
  for (size_t number = 0; number < code.algorithm.projections.size(); ++number) {
    const ir::Projection& p = code.algorithm.projections[number];
    const std::vector<ir::ProjectedBody>& bodies = projected_bodies(code, number);
    const ir::RowCounts computed = ir::row_counts(bodies, counted_lanes);
    sum += of(p.graph, p.columns, computed.rows);
    sum.add += computed.added * static_cast<long>(p.columns.size());
    if (!code.is_rolled()) continue;
    const ir::RolledProjection& rolled = code.rolled.projections[number];
    sum += of(rolled.graph, rolled.roots(), static_cast<long>(bodies.size()));
  }
}

// Of joints' results: driven joints' are added to their drivers', and those of a loop's second link to its first's.
long added_results(const CodeInput& code) {
  long additions = static_cast<long>(code.rolled.added.size());
  for (const ir::PairBlocks& matrices : code.rolled.blocks)
    additions += static_cast<long>(matrices.sums.size() * matrices.following.to.size()) -
                 static_cast<long>(matrices.sums.size()) * matrices.following.set;
  for (const ir::JointResult& joints : code.rolled.results)
    if (joints.copied)
      additions += std::count_if(joints.elements.begin(), joints.elements.end(), [](const auto& e) { return !e.first; });
  return additions;
}

// Of the check whether M can be solved with: a product per pivot.
long guard_products(const CodeInput& code) {
  const std::optional<ir::Guard>& guard = code.algorithm.guard;
  if (!guard || guard->pivots < 0) return 0;
  return code.is_rolled() ? checked_pivots(code) : code.algorithm.arrays[static_cast<size_t>(guard->pivots)].rows;
}

}  // namespace

ir::Operations executed_operations(const CodeInput& code) {
  ir::Operations sum;
  sum.multiply = guard_products(code);
  for (const ir::Kernel& kernel : code.algorithm.kernels) sum += ir::operations_of(kernel, code.tree, true, code.is_rolled());
  add_projections(code, sum);
  if (const std::optional<ir::Embedding>& embedding = code.algorithm.embedding) {
    sum += ir::operations_of_linkages(code.tree, embedding->rates >= 0);
    for (const ir::Projected& p : embedding->projected) sum += ir::operations_of(p, code.tree);
  }
  if (!code.is_rolled()) return sum += straight_operations(code);
  sum += prepare_operations(code);
  for (const ir::BaseStage& stage : code.rolled.base) sum += base(stage);
  for (const ir::SegmentCode& segment : code.rolled.segments)
    for (const ir::SegmentStage& stage : segment.stages)
      for (const ir::Paragraph& p : stage.paragraphs) sum += paragraph(p);
  add_elements(code, sum);
  sum.add += added_results(code);
  return sum;
}

}  // namespace dalembert::backend
