// A static graph of tasks on oneTBB's flow graph: built once, run many times. The only header that needs oneTBB.
#pragma once

#include <oneapi/tbb/flow_graph.h>

#include <cstddef>
#include <deque>
#include <functional>
#include <utility>
#include <vector>

#include "happens_before.hpp"

namespace dalembert {

// Tasks are numbered in the order they are added. A task runs when all tasks it comes after have run.
class TaskGraph {
 public:
  // Returns the task's number.
  int add(std::function<void()> task) {
    const std::size_t number = nodes_.size();
    nodes_.emplace_back(graph_, [this, number, task = std::move(task)](const tbb::flow::continue_msg&) {
      start(number);
      task();
      detail::happens_before(&nodes_[number]);
    });
    comes_after_.emplace_back();
    return static_cast<int>(number);
  }

  // `after` runs when `before` has. The caller keeps the graph free of cycles.
  void edge(int before, int after) {
    tbb::flow::make_edge(nodes_[static_cast<std::size_t>(before)], nodes_[static_cast<std::size_t>(after)]);
    comes_after_[static_cast<std::size_t>(after)].push_back(static_cast<std::size_t>(before));
  }

  // Runs every task once and returns when all are done.
  void run() {
    detail::happens_before(&graph_);
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (comes_after_[i].empty()) nodes_[i].try_put(tbb::flow::continue_msg());
    graph_.wait_for_all();
    for (Node& node : nodes_) detail::happens_after(&node);
  }

 private:
  using Node = tbb::flow::continue_node<tbb::flow::continue_msg>;

  // Claims the graph's own edges and no more: ThreadSanitizer sees where they do not suffice.
  void start(std::size_t task) {
    detail::happens_after(&graph_);
    for (const std::size_t before : comes_after_[task]) detail::happens_after(&nodes_[before]);
  }

  tbb::flow::graph graph_;
  std::deque<Node> nodes_;
  std::vector<std::vector<std::size_t>> comes_after_;  // task → the tasks it comes after
};

}  // namespace dalembert
