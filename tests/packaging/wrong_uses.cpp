// What must not compile, and what a compiler must say of it: emitted_code_test.sh looks for the words of each comment.
#include <prismatic_mix/dynamics.hpp>
#include <quadruped/tasks.hpp>
#include <utility>

// A fixed base: q and v are equally long.
void of_an_arm(prismatic_mix::VectorQ q, prismatic_mix::VectorV v, prismatic_mix::Workspace& workspace) {
  using namespace prismatic_mix;
  const double numbers[nq] = {};
  const Eigen::Map<const VectorQ> positions(numbers);
  evaluate(v, v, workspace);                                   // error: velocities (a VectorV) where positions
  evaluate(q, q, workspace);                                   // error: positions (a VectorQ) where a VectorV is wanted
  evaluate(q, positions, workspace);                           // error: positions (a VectorQ) where a VectorV is wanted
  evaluate(q.head<nq - 1>(), v, workspace);                    // error: the vector's length is not the one wanted
  evaluate(Eigen::Matrix<double, nq + 1, 1>(), v, workspace);  // error: the vector's length is not the one wanted
  evaluate(q, v.transpose(), workspace);                       // error: a row or a matrix where a column is wanted
  evaluate(q, Eigen::RowVectorXd(nv), workspace);              // error: a row or a matrix where a column is wanted
  evaluate(q, Eigen::MatrixXd(nv, 1), workspace);              // error: a row or a matrix where a column is wanted
  evaluate(q, v.cast<float>(), workspace);                     // error: the vector's scalar is not the robot's
  evaluate(q, Eigen::VectorXf(nv), workspace);                 // error: the vector's scalar is not the robot's
  q = Eigen::Ref<VectorV>(v);                                  // error: velocities (a VectorV) where positions
  VectorV of_head = q.head<2>();                               // error: the vector's length is not the one wanted
  mass_matrix(Workspace());                                    // error: deleted function
  gravity(std::move(workspace));                               // error: deleted function
}

// A floating base, with a task graph and factors to solve with.
void of_a_quadruped(quadruped::VectorQ q, quadruped::VectorV v, quadruped::Workspace& workspace) {
  using namespace quadruped;
  TaskGraph graph(workspace);
  graph.evaluate(v, Eigen::VectorXd(q));  // error: velocities (a VectorV) where positions
  graph.evaluate(q.tail<joints>(), v);    // error: the vector's length is not the one wanted
  ForwardDynamicsTaskGraph forward(workspace);
  forward.forward_dynamics(q, v, q);                     // error: positions (a VectorQ) where a VectorV is wanted
  forward_dynamics(q, v, v.tail<joints>(), workspace);   // error: the vector's length is not the one wanted
  solve(Eigen::Matrix<double, nv + 2, 3>(), workspace);  // error: the vector's length is not the one wanted
  solve(q, workspace);                                   // error: positions (a VectorQ) where a VectorV is wanted
  forward_dynamics(Workspace());                         // error: deleted function
}
