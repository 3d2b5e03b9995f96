// A static graph of tasks on oneTBB's flow graph: built once, run many times. The only header that needs oneTBB.
#pragma once

#include <oneapi/tbb/flow_graph.h>

#include <deque>
#include <functional>
#include <utility>
#include <vector>

namespace dalembert {

// Tasks are numbered in the order they are added. A task runs when all tasks it comes after have run.
class TaskGraph {
 public:
  // Returns the task's number.
  int add(std::function<void()> task) {
    nodes_.emplace_back(graph_, [task = std::move(task)](const tbb::flow::continue_msg&) { task(); });
    first_.push_back(true);
    return static_cast<int>(nodes_.size()) - 1;
  }

  // `after` runs when `before` has. The caller keeps the graph free of cycles.
  void edge(int before, int after) {
    tbb::flow::make_edge(nodes_[static_cast<std::size_t>(before)], nodes_[static_cast<std::size_t>(after)]);
    first_[static_cast<std::size_t>(after)] = false;
  }

  // Runs every task once and returns when all are done.
  void run() {
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (first_[i]) nodes_[i].try_put(tbb::flow::continue_msg());
    graph_.wait_for_all();
  }

 private:
  using Node = tbb::flow::continue_node<tbb::flow::continue_msg>;
  tbb::flow::graph graph_;
  std::deque<Node> nodes_;
  std::vector<bool> first_;  // tasks that come after none
};

}  // namespace dalembert
