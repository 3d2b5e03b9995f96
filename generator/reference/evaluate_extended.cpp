#include "reference/evaluation.hpp"
#include "reference/instances.hpp"

namespace dalembert::generic {
DALEMBERT_GENERIC_ENGINE(template, long double);
}  // namespace dalembert::generic

namespace dalembert::reference {

template std::vector<Eigen::MatrixXd> evaluate_in<long double>(const ir::KinematicTree&, const ir::Scene&,
                                                               const std::vector<Wanted>&, const Inputs&);

}  // namespace dalembert::reference
