#include "lower.hpp"

#include <algorithm>

#include "backend/estimate.hpp"
#include "ir/coordinate_tree.hpp"
#include "passes/embedding.hpp"
#include "passes/normalise.hpp"
#include "passes/part_of_tree.hpp"
#include "passes/plan.hpp"
#include "passes/project_by_rows.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/reference.hpp"
#include "passes/roll.hpp"
#include "passes/schedule.hpp"
#include "passes/unroll.hpp"
#include "passes/write_out.hpp"
#include "passes/write_out_constraints.hpp"

namespace dalembert {
namespace {

// A function in one of its ways: its sections have one form.
struct Way {
  std::vector<LoweredSection> sections;
  Candidate candidate;
};

class Lowering {
 public:
  Lowering(const Model& model, const ir::NormalTree& normal, const ir::EmittedFunction& function, ir::Elements elements)
      : model_(model),
        part_(part_of(model, function)),
        tree_(part_ ? part_->tree : model.tree),
        normal_(part_ ? part_->normal : normal),
        function_(function),
        planned_(planned(model, function)),
        options_{model.options.fold, model.options.share},
        elements_(elements) {}

  // As far as the unrolled program.
  LoweredFunction program() const {
    const ir::Solver solver = passes::solvers(function_, tree_, model_.scene).front();
    LoweredFunction lowered;
    lowered.part = part_;
    lowered.sections = described(solver);
    for (LoweredSection& section : lowered.sections) section.program = unrolled(section.algorithm, elements_).take_program();
    return lowered;
  }

  // The cheapest way of all that the scene's plan leaves.
  LoweredFunction form() const {
    std::vector<Way> ways;
    // A plan of more outputs than are asked for here may say how to solve what is not.
    std::vector<ir::Solver> solvers = passes::solvers(function_, tree_, model_.scene);
    if (planned_.solver && std::find(solvers.begin(), solvers.end(), *planned_.solver) != solvers.end())
      solvers = {*planned_.solver};
    for (const ir::Solver solver : solvers) add_ways(solver, ways);
    const auto cheapest = std::min_element(ways.begin(), ways.end(), [](const Way& a, const Way& b) {
      return a.candidate.nanoseconds[backend::usual_width] < b.candidate.nanoseconds[backend::usual_width];
    });
    std::rotate(ways.begin(), cheapest, cheapest + 1);
    LoweredFunction chosen;
    chosen.part = part_;
    chosen.sections = std::move(ways.front().sections);
    for (const Way& way : ways) chosen.candidates.push_back(way.candidate);
    if (model_.scene.linearly_implicit) add_implicit(chosen);
    const bool one_section = chosen.sections.size() == 1;
    if (one_section && !chosen.first().plan.tasks && !planned_.form) add_other_form(ways, chosen);
    if (model_.scene.batch) add_batch(chosen);
    return chosen;
  }

 private:
  static std::shared_ptr<const PartOfRobot> part_of(const Model& model, const ir::EmittedFunction& function) {
    const std::optional<ir::KinematicTree> tree = passes::part_of_tree(function, model.tree, model.scene);
    if (!tree) return nullptr;
    const auto options = passes::normalise_options(model.scene, model.options.move_parameters);
    return std::make_shared<const PartOfRobot>(PartOfRobot{*tree, passes::normalise(*tree, options)});
  }

  static ir::FunctionPlan planned(const Model& model, const ir::EmittedFunction& function) {
    const auto found = model.scene.plan.find(function.name);
    return found == model.scene.plan.end() ? ir::FunctionPlan() : found->second;
  }

  // The other form, where registers of some width gain more by it than estimates err.
  static void add_other_form(std::vector<Way>& ways, LoweredFunction& chosen) {
    constexpr double worth_its_text = 1.06;
    const Candidate& first = ways.front().candidate;
    Way* other = nullptr;
    double most = worth_its_text;
    for (Way& way : ways)
      for (size_t width = 0; width < backend::register_widths.size(); ++width)
        if (const double gain = first.nanoseconds[width] / way.candidate.nanoseconds[width];
            way.sections.size() == 1 && way.candidate.form != first.form && gain > most)
          other = &way, most = gain;
    if (!other) return;
    for (size_t width = 0; width < backend::register_widths.size(); ++width)
      if (other->candidate.nanoseconds[width] < first.nanoseconds[width])
        chosen.elsewhere_lanes.push_back(backend::register_widths[width]);
    chosen.elsewhere = std::move(other->sections.front());
  }

  // Of lines for batches. Longer ones take a compiler minutes, and kernels take a loop's time from there on.
  static constexpr long most_operations = 150000;
  static bool is_whole_line(const LoweredSection& line) {
    return line.algorithm.kernels.empty() && ir::operations(line.program).total() <= most_operations;
  }

  void add_batch(LoweredFunction& chosen) const {
    long operations = 0;
    for (const LoweredSection& section : chosen.sections) operations += ir::operations(section.program).total();
    if (operations > most_operations) return;
    std::optional<LoweredSection> line = straight_line(function_, false);
    if (line && is_whole_line(*line)) chosen.batch = std::move(line);
  }

  void add_implicit(LoweredFunction& chosen) const {
    if (!function_.computes(ir::Quantity::forward_dynamics)) return;
    ir::EmittedFunction alone = function_;
    alone.quantities = {ir::Quantity::forward_dynamics};
    alone.of_links.clear(), alone.parts.clear();
    std::optional<LoweredSection> line = straight_line(alone, true);
    if (line && is_whole_line(*line)) chosen.implicit = std::move(line);
  }

  // For batches: the way of the fewest operations, a division being several. Of sections joined only where each way has more
  // than one: what the first leaves for the next is then kept for long, and the line takes up to 1.17 times as long as one of
  // more operations. None with kernels that there are no nodes for.
  std::optional<LoweredSection> straight_line(const ir::EmittedFunction& function, bool implicit) const {
    std::optional<LoweredSection> cheapest;
    long least = 0;
    for (const ir::Solver solver : passes::solvers(function, tree_, model_.scene)) {
      const std::vector<LoweredSection> sections = described(function, solver, {true, model_.options.refer});
      if (std::any_of(sections.begin(), sections.end(), is_called)) continue;
      for (const Frames& frames : choices_of_frames(sections)) {
        std::optional<LoweredSection> line = line_of(sections, frames, implicit, least);
        const long cost = line ? cost_of(line->program) : 0;
        if (!line || (least > 0 && cost >= least)) continue;
        least = cost;
        cheapest = std::move(line);
      }
    }
    return cheapest;
  }

  static bool is_called(const LoweredSection& section) {
    const std::vector<ir::Kernel>& kernels = section.algorithm.kernels;
    return std::any_of(kernels.begin(), kernels.end(),
                       [](const ir::Kernel& kernel) { return kernel.of_constraints() && !passes::can_be_written_out(kernel); });
  }

  // Of each section, by the frames of which bodies it goes. Each by its own; or all by the last one's, the longest: then they
  // have more in common.
  using Frames = std::vector<std::vector<int>>;
  std::vector<Frames> choices_of_frames(const std::vector<LoweredSection>& sections) const {
    Frames own;
    for (const LoweredSection& section : sections) own.push_back(references(section));
    const Frames common(sections.size(), own.back());
    return own == common ? std::vector<Frames>{own} : std::vector<Frames>{own, common};
  }

  static constexpr long division = 6;  // operations
  static long cost_of(const ir::Program& program) {
    const ir::Operations o = ir::operations(program);
    return o.add + o.multiply + division * o.divide;
  }

  // One straight line of all sections, kernels too. None where there is no such line, or none that costs less than `least` (0:
  // any).
  std::optional<LoweredSection> line_of(std::vector<LoweredSection> sections, const Frames& frames, bool implicit,
                                        long least) const {
    const auto unrolled = [&](size_t i, ir::Elements elements) {
      const passes::UnrollOptions options{options_, tree_.joints() < 200, implicit, elements, frames[i]};
      return passes::Unroll(sections[i].algorithm, tree_, normal_, model_.scene, options).take_program();
    };
    // Kernels written out add to it: of a long chain's M the cube of its joints.
    long without_kernels = 0;
    for (size_t i = 0; i < sections.size(); ++i) without_kernels += cost_of(unrolled(i, ir::Elements::counted));
    for (const LoweredSection& section : sections)
      for (const ir::Kernel& kernel : section.algorithm.kernels)
        if (kernel.of_constraints() && ir::operations_of(kernel, tree_, false).total() > most_operations) return {};
    const bool alone = sections.size() == 1;
    if (without_kernels > division * most_operations || (least > 0 && alone && without_kernels >= least)) return {};
    for (size_t i = 0; i < sections.size(); ++i) {
      sections[i].program = unrolled(i, ir::Elements::kept);
      sections[i].plan.form = ir::Form::straight;
    }
    if (!write_out_kernels(sections, true) && !alone) return {};
    return std::move(sections.front());
  }

  // Of a straight line; sections become one. False: they are as they were (passes/write_out.hpp).
  bool write_out_kernels(std::vector<LoweredSection>& sections, bool whole) const {
    std::vector<passes::SectionBehind> behind;
    for (auto section = sections.begin() + 1; section != sections.end(); ++section)
      behind.push_back({section->algorithm, section->program});
    LoweredSection& first = sections.front();
    if (!passes::write_out_kernels(first.algorithm, first.program, ir::coordinate_tree(tree_), whole, behind)) return false;
    sections.resize(1);
    return true;
  }

  std::vector<LoweredSection> described(ir::Solver solver, bool line = false) const {
    return described(function_, solver, {false, line});
  }
  std::vector<LoweredSection> described(const ir::EmittedFunction& function, ir::Solver solver, passes::Purpose purpose) const {
    std::vector<LoweredSection> sections;
    for (ir::Algorithm& section : passes::describe(function, tree_, normal_, model_.scene, solver, options_, purpose))
      sections.push_back({std::move(section), {}, {}, {}});
    return sections;
  }

  passes::Unroll unrolled(const ir::Algorithm& algorithm, ir::Elements elements, bool names = false) const {
    return {algorithm, tree_, normal_, model_.scene, passes::UnrollOptions{options_, names, false, elements}};
  }
  // Makes a section a straight line, but for its kernels.
  void unroll(LoweredSection& f, const std::vector<int>& references, bool names) const {
    passes::Unroll whole(f.algorithm, tree_, normal_, model_.scene, {options_, names, false, ir::Elements::kept, references});
    f.program = whole.take_program();
    passes::project_by_rows(f.algorithm, f.program, whole, tree_);
  }
  // The frames by which that is the fastest; for batches too, so that these round as single calls do.
  std::vector<int> references(const LoweredSection& f) const {
    if (!model_.options.refer) return {};
    return passes::reference_bodies(f.algorithm, tree_, normal_, [&](const std::vector<int>& bodies) {
      LoweredSection tried = f;
      tried.plan.form = ir::Form::straight;
      unroll(tried, bodies, false);
      return estimated(tried, backend::usual_width);
    });
  }

  // `width`: of registers, by its place in backend::register_widths.
  double estimated(const LoweredSection& f, size_t width) const {
    return backend::estimate(
        {tree_, normal_, model_.scene, f.algorithm, f.program, f.plan, f.rolled, model_.name, &model_.tree},
        backend::register_widths[width]);
  }

  void add_ways(ir::Solver solver, std::vector<Way>& ways) const {
    const std::vector<LoweredSection> lowered = described(solver), lines = described(solver, model_.options.refer);
    // Nobody reads a straight line of a million statements.
    const bool names = tree_.joints() < 200;
    std::vector<passes::Unroll> unrolls;
    unrolls.reserve(lowered.size());
    ir::Operations operations;
    for (const LoweredSection& f : lowered) {
      unrolls.push_back(unrolled(f.algorithm, elements_, names));
      operations += ir::operations(unrolls.back().program());
    }
    ir::CompileOptions options = model_.options;
    if (options.form == ir::Form::automatic && planned_.form) options.form = *planned_.form;
    const std::vector<ir::Form> forms = passes::forms(tree_, model_.scene, operations, options);
    for (const ir::Form form : forms) {
      Way way{form == ir::Form::straight ? lines : lowered, {form, solver, ir::Order::as_written, {}}};
      for (size_t section = 0; section < lowered.size(); ++section) {
        LoweredSection& f = way.sections[section];
        f.plan = passes::plan(tree_, model_.scene, form, model_.options, passes::rows_in_pairs(f.algorithm, tree_));
        if (form == ir::Form::rolled) {
          f.rolled = passes::roll(f.algorithm, unrolls[section], tree_, model_.scene, f.plan, options_);
          f.program = unrolls[section].take_program();
        } else {
          unroll(f, references(f), names);
        }
      }
      if (form == ir::Form::straight) finish_line(way);
      for (const LoweredSection& f : way.sections)
        for (size_t width = 0; width < backend::register_widths.size(); ++width)
          way.candidate.nanoseconds[width] += estimated(f, width);
      ways.push_back(std::move(way));
    }
  }

  // Kernels that pay as nodes, and the order. More than one section is joined where nothing is left beside the line: of robots
  // with more joints it is slower than the sections (measured), for lanes fill the matrices between them.
  void finish_line(Way& way) const {
    if (way.sections.size() == 1 || tree_.nv() <= passes::most_of_products) write_out_kernels(way.sections, false);
    way.candidate.order = planned_.order.value_or(ir::Order::as_written);
    for (LoweredSection& f : way.sections) {
      f.plan.order = way.candidate.order;
      if (f.plan.order != ir::Order::as_written)
        f.program.order = passes::schedule(f.program.graph, f.program.roots(), f.plan.order);
    }
  }

  const Model& model_;
  const std::shared_ptr<const PartOfRobot> part_;
  const ir::KinematicTree& tree_;
  const ir::NormalTree& normal_;
  const ir::EmittedFunction& function_;
  const ir::FunctionPlan planned_;
  const ir::Graph::Options options_;
  const ir::Elements elements_;
};

// Arrays that users do not see.
void make_internal(LoweredSection& section) {
  for (std::vector<ir::OutputArray>* arrays : {&section.algorithm.arrays, &section.program.arrays})
    for (ir::OutputArray& array : *arrays) array.internal = true;
}

// Each function calls another, on the tree without loops, and has no equations of its own.
template <class Lower>
Lowered lower_embedded(const Model& model, ir::Elements elements, const Lower& lower) {
  Lowered lowered;
  auto opened = std::make_shared<Model>(model);
  opened->tree = model.tree.opened();
  opened->scene = passes::opened(model.scene);
  lowered.opened = opened;
  lowered.normal = passes::normalise(opened->tree, passes::normalise_options(opened->scene, model.options.move_parameters));
  for (const ir::EmittedFunction& function : ir::functions_of(model.scene)) {
    passes::EmbeddedFunction embedded = passes::embed(function, model.tree, model.scene);
    LoweredSection called{std::move(embedded.algorithm), {}, {}, {}};
    called.program.arrays = called.algorithm.arrays;
    called.program.base_positions = model.tree.base_positions();
    LoweredFunction whole = lower(Lowering(*opened, lowered.normal, embedded.of_opened, elements));
    for (LoweredSection& section : whole.sections) make_internal(section);
    if (whole.elsewhere) make_internal(*whole.elsewhere);
    ir::Embedding& embedding = *called.algorithm.embedding;
    const ir::Program& program = whole.first().program;
    embedding.moving =
        embedding.rates >= 0 || !ir::inputs_read(program, ir::uses(program.graph, program.roots())).velocities.empty();
    LoweredFunction f;
    f.sections.push_back(std::move(called));
    f.candidates = whole.candidates;
    f.opened.push_back(std::move(whole));
    lowered.functions.push_back(std::move(f));
  }
  return lowered;
}

template <class Lower>
Lowered lower_functions(const Model& model, ir::Elements elements, const Lower& lower) {
  if (!model.tree.linkages.empty()) return lower_embedded(model, elements, lower);
  Lowered lowered;
  lowered.normal = passes::normalise(model.tree, passes::normalise_options(model.scene, model.options.move_parameters));
  for (const ir::EmittedFunction& function : ir::functions_of(model.scene))
    lowered.functions.push_back(lower(Lowering(model, lowered.normal, function, elements)));
  return lowered;
}

}  // namespace

std::vector<const LoweredSection*> LoweredFunction::all_sections() const {
  std::vector<const LoweredSection*> all;
  for (const LoweredSection& section : sections) all.push_back(&section);
  for (const LoweredFunction& called : opened)
    for (const LoweredSection* section : called.all_sections()) all.push_back(section);
  return all;
}

std::vector<const LoweredSection*> Lowered::all_sections() const {
  std::vector<const LoweredSection*> all;
  for (const LoweredFunction& function : functions)
    for (const LoweredSection* section : function.all_sections()) all.push_back(section);
  return all;
}

Lowered lower(const Model& model, ir::Elements elements) {
  return lower_functions(model, elements, [](const Lowering& lowering) { return lowering.form(); });
}
Lowered lower_to_programs(const Model& model, ir::Elements elements) {
  return lower_functions(model, elements, [](const Lowering& lowering) { return lowering.program(); });
}

}  // namespace dalembert
