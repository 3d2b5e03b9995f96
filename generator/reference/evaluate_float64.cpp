#include "reference/evaluation.hpp"

namespace dalembert::reference {

template std::vector<Eigen::MatrixXd> evaluate_in<double>(const ir::KinematicTree&, const ir::Scene&,
                                                          const std::vector<Wanted>&, const Inputs&);

}  // namespace dalembert::reference
