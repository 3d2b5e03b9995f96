// Orders of straight lines: operands before what is made of them, everything once, and fewer live values where that can be.
#include "passes/schedule.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <sstream>

#include "both_forms.hpp"
#include "compile.hpp"
#include "ir/plan_words.hpp"
#include "lower.hpp"

namespace dalembert {
namespace {

constexpr ir::Order orders[] = {ir::Order::as_written, ir::Order::longest_first, ir::Order::newest_first};

ir::Program program_of(const char* name, ir::Quantity quantity) {
  ir::Scene scene;
  scene.outputs = {quantity};
  return lower_to_programs(model_of(robot(name), scene), ir::Elements::kept).functions.front().first().program;
}

TEST(Schedule, HasWhatIsNeededOnceAndOperandsFirst) {
  for (const char* name : {"chain_7", "quadruped", "grippers"})
    for (const ir::Quantity quantity : {ir::Quantity::mass_matrix, ir::Quantity::forward_dynamics}) {
      const ir::Program program = program_of(name, quantity);
      const std::vector<ir::NodeId> roots = program.roots();
      for (const ir::Order order : orders) {
        SCOPED_TRACE(std::string(name) + ", " + word_of(ir::order_words(), order));
        const std::vector<ir::NodeId> nodes = passes::schedule(program.graph, roots, order);
        std::set<ir::NodeId> there;
        for (const ir::NodeId id : nodes) {
          const ir::Node& n = program.graph[id];
          EXPECT_TRUE(there.insert(id).second) << id << " stands twice";
          if (n.op == ir::Op::sine || n.op == ir::Op::cosine) continue;  // computed before, with their angles
          for (const ir::NodeId operand : {n.a, n.b})
            EXPECT_TRUE(operand == ir::no_node || there.contains(operand)) << id << " before " << operand;
        }
        for (const ir::NodeId root : roots) EXPECT_TRUE(there.contains(root)) << root;
      }
    }
}

// Σ (x_i + 1) (x_i + 2) ..., all sums first: as written every sum is alive before the first product is made.
struct Squares {
  ir::Graph graph;
  std::vector<ir::NodeId> roots;
  static constexpr int count = 12;
  Squares() {
    std::vector<ir::NodeId> sums;
    for (int i = 0; i < count; ++i) sums.push_back(graph.add(graph.constant(1), graph.input({ir::InputKind::position, i})));
    for (const ir::NodeId sum : sums) roots.push_back(graph.multiply(sum, sum));
  }
};

int most_alive(const ir::Graph& graph, const std::vector<ir::NodeId>& roots, const std::vector<ir::NodeId>& order) {
  std::map<ir::NodeId, std::size_t> last;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (const ir::NodeId operand : {graph[order[i]].a, graph[order[i]].b}) last[operand] = i;
  int alive = 0, most = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const ir::Node& n = graph[order[i]];
    if (n.op == ir::Op::constant || n.op == ir::Op::input) continue;
    for (const ir::NodeId operand : std::set<ir::NodeId>{n.a, n.b})
      if (operand != ir::no_node && graph[operand].op != ir::Op::constant && graph[operand].op != ir::Op::input &&
          last[operand] == i)
        --alive;
    if (std::find(roots.begin(), roots.end(), order[i]) == roots.end()) ++alive;
    most = std::max(most, alive);
  }
  return most;
}

TEST(Schedule, EndsLiveValuesEarly) {
  const Squares squares;
  const auto alive = [&](ir::Order order) {
    return most_alive(squares.graph, squares.roots, passes::schedule(squares.graph, squares.roots, order));
  };
  EXPECT_EQ(alive(ir::Order::as_written), Squares::count);
  EXPECT_EQ(alive(ir::Order::longest_first), 1);
  EXPECT_EQ(alive(ir::Order::newest_first), 1);
}

TEST(Schedule, BreaksTiesByTheLongestWay) {
  ir::Graph graph;
  const ir::NodeId x = graph.input({ir::InputKind::position, 0}), y = graph.input({ir::InputKind::position, 1});
  const ir::NodeId near = graph.add(x, y), far = graph.multiply(x, y), between = graph.multiply(far, far);
  const std::vector<ir::NodeId> ends{graph.multiply(near, near), graph.multiply(between, between)};
  const auto far_first = [&](ir::Order order) {
    const std::vector<ir::NodeId> nodes = passes::schedule(graph, ends, order);
    return std::find(nodes.begin(), nodes.end(), far) < std::find(nodes.begin(), nodes.end(), near);
  };
  EXPECT_FALSE(far_first(ir::Order::as_written));
  EXPECT_TRUE(far_first(ir::Order::longest_first)) << "three steps to its end, not two";
  EXPECT_FALSE(far_first(ir::Order::newest_first));
}

// The statements of a straight function: each name is made once, and before it is read.
void expect_names_made_before_they_are_read(const std::string& text) {
  std::set<std::string> made, all;
  std::vector<std::pair<std::string, std::string>> statements;
  std::istringstream lines(text);
  const std::string begin = "  const Scalar ";
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(begin)) {
      const std::size_t equals = line.find(" = ");
      statements.emplace_back(line.substr(begin.size(), equals - begin.size()), line.substr(equals + 3));
      EXPECT_TRUE(all.insert(statements.back().first).second) << line;
    } else if (line.starts_with("  workspace.") && line.find(" = ") != line.npos) {
      statements.emplace_back("", line.substr(line.find(" = ") + 3));
    }
  }
  EXPECT_GT(statements.size(), 20u);
  for (const auto& [name, value] : statements) {
    for (std::size_t at = 0; at < value.size();) {
      std::size_t end = at;
      while (end < value.size() && (std::isalnum(static_cast<unsigned char>(value[end])) || value[end] == '_')) ++end;
      const std::string word = value.substr(at, end - at);
      EXPECT_TRUE(!all.contains(word) || made.contains(word)) << name << " = " << value;
      at = std::max(end, at + 1);
    }
    made.insert(name);
  }
}

std::string code_of(const char* name, ir::Quantity quantity, ir::Order order) {
  ir::Scene scene;
  scene.base = ir::Base::fixed;
  scene.outputs = {quantity};
  scene.plan[ir::functions_of(scene).front().name] = {ir::Form::straight, std::nullopt, order};
  Model model = model_of(robot(name), scene);
  model.name = "r";
  for (const backend::OutputFile& file : compile_without_self_test(model))
    if (file.name == "dynamics.cpp") return file.text;
  return "";
}

int statements_of(const std::string& text) {
  int count = 0;
  for (std::size_t at = 0; (at = text.find(";\n", at)) != text.npos; ++at) ++count;
  return count;
}

TEST(Schedule, IsTheOrderOfTheEmittedStatements) {
  for (const ir::Quantity quantity : {ir::Quantity::mass_matrix, ir::Quantity::forward_dynamics}) {
    const std::string written = code_of("chain_7", quantity, ir::Order::as_written);
    for (const ir::Order order : orders) {
      SCOPED_TRACE(word_of(ir::order_words(), order));
      const std::string text = code_of("chain_7", quantity, order);
      expect_names_made_before_they_are_read(text);
      EXPECT_EQ(statements_of(text), statements_of(written));
      EXPECT_EQ(text == written, order == ir::Order::as_written);
      EXPECT_EQ(text.find(" again\n") != text.npos, order != ir::Order::as_written);
    }
  }
}

}  // namespace
}  // namespace dalembert
