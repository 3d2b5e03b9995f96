#include "passes/schedule.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "ir/latency.hpp"

namespace dalembert::passes {
namespace {

using ir::NodeId;
using ir::Op;

// A value that has a name, and the values without one that it alone is made of.
struct Statement {
  NodeId value = ir::no_node;
  std::vector<NodeId> own;   // by number, the value last
  std::vector<int> reads;    // statements
  std::vector<int> read_by;  // likewise
  int cycles = 0;            // from here to the end of the longest way
};

class Schedule {
 public:
  Schedule(const ir::Graph& graph, const std::vector<NodeId>& roots)
      : graph_(graph), uses_(ir::uses_in_text(graph, roots)), statement_of_(uses_.size(), none) {
    std::vector<bool> root(uses_.size(), false);
    for (const NodeId id : roots) root[at(id)] = true;
    for (NodeId id = 0; id < graph.size(); ++id)
      if (uses_[at(id)] > 0 && (root[at(id)] || (!is_leaf(id) && uses_[at(id)] > 1))) add(id);
    for (Statement& s : statements_)
      for (const int read : s.reads) statements_[at(read)].read_by.push_back(statement_of_[at(s.value)]);
    for (auto s = statements_.rbegin(); s != statements_.rend(); ++s) {
      for (const int by : s->read_by) s->cycles = std::max(s->cycles, statements_[at(by)].cycles);
      for (const NodeId id : s->own) s->cycles += cycles_of(graph[id].op);
    }
  }

  std::vector<NodeId> run(ir::Order order) const {
    std::vector<NodeId> nodes;
    std::vector<bool> there(uses_.size(), false);
    for (const int s : order == ir::Order::as_written ? as_written() : listed(order))
      for (const NodeId id : statements_[at(s)].own)
        if (!there[at(id)]) there[at(id)] = true, nodes.push_back(id);
    return nodes;
  }

 private:
  static constexpr int none = -1;
  template <class Index>
  static std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
  }

  bool is_leaf(NodeId id) const {
    const Op op = graph_[id].op;
    return op == Op::constant || op == Op::input || op == Op::sine || op == Op::cosine;
  }
  static int cycles_of(Op op) {
    switch (op) {
      case Op::add:
      case Op::subtract:
      case Op::multiply: return ir::latency;
      case Op::divide: return ir::divide_latency;
      default: return 0;
    }
  }

  void add(NodeId value) {
    Statement s;
    s.value = value;
    std::vector<NodeId> todo{value};
    while (!todo.empty()) {
      const NodeId id = todo.back();
      todo.pop_back();
      s.own.push_back(id);
      if (is_leaf(id)) continue;
      for (const NodeId operand : {graph_[id].a, graph_[id].b}) {
        if (operand == ir::no_node) continue;
        if (statement_of_[at(operand)] == none) todo.push_back(operand);
        else s.reads.push_back(statement_of_[at(operand)]);
      }
    }
    const auto each_once = [](auto& list) {
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
    };
    each_once(s.own);
    each_once(s.reads);
    statement_of_[at(value)] = static_cast<int>(statements_.size());
    statements_.push_back(std::move(s));
  }

  std::vector<int> as_written() const {
    std::vector<int> all(statements_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
    return all;
  }

  // One after another of those whose operands are there, what ends more live values than it begins first. Among equals, what
  // the longest way begins with, or what reads the newest value.
  std::vector<int> listed(ir::Order order) const {
    const std::size_t n = statements_.size();
    std::vector<int> waits(n), readers(n), made(n, 0), done;
    std::vector<int> ready;
    for (std::size_t i = 0; i < n; ++i) {
      waits[i] = static_cast<int>(statements_[i].reads.size());
      readers[i] = static_cast<int>(statements_[i].read_by.size());
      if (waits[i] == 0) ready.push_back(static_cast<int>(i));
    }
    const auto rank = [&](int i) {
      const Statement& s = statements_[at(i)];
      int live = s.read_by.empty() ? 0 : 1, newest = 0;
      for (const int read : s.reads) {
        if (readers[at(read)] == 1) --live;
        newest = std::max(newest, made[at(read)]);
      }
      return std::tuple(live, order == ir::Order::newest_first ? -newest : -s.cycles, i);
    };
    while (!ready.empty()) {
      const auto next = std::min_element(ready.begin(), ready.end(), [&](int a, int b) { return rank(a) < rank(b); });
      const int i = *next;
      *next = ready.back();
      ready.pop_back();
      done.push_back(i);
      made[at(i)] = static_cast<int>(done.size());
      for (const int read : statements_[at(i)].reads) --readers[at(read)];
      for (const int by : statements_[at(i)].read_by)
        if (--waits[at(by)] == 0) ready.push_back(by);
    }
    return done;
  }

  const ir::Graph& graph_;
  const std::vector<std::int32_t> uses_;
  std::vector<int> statement_of_;  // of the value that gives it its name
  std::vector<Statement> statements_;
};

}  // namespace

std::vector<NodeId> schedule(const ir::Graph& graph, const std::vector<NodeId>& roots, ir::Order order) {
  return Schedule(graph, roots).run(order);
}

}  // namespace dalembert::passes
