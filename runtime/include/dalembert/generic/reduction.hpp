// Driven joints (URDF <mimic>): several joints share one independent coordinate.
//
// The full model has a coordinate per joint; q_full = G_q q + offset and v_full = G v with G constant, so
// M_r = Gᵀ M G, C_r = Gᵀ C G, g_r = Gᵀ g, W_r = Gᵀ W. The base's coordinates pass unchanged.
#pragma once

#include <dalembert/generic/model.hpp>

namespace dalembert::generic {

template <class S>
class Reduction {
 public:
  // Refuses a malformed model (check_model). Keeps a reference to it.
  explicit Reduction(const Model<S>& model)
      : model_(model), driven_(!model.coordinates.empty()), base_rows_(model.base_rows()) {
    check_model(model);
    if (!driven_) return;
    G_ = MatrixX<S>::Zero(base_rows_ + model.joints(), model.nv());
    G_.topLeftCorner(base_rows_, base_rows_).setIdentity();
    for (int k = 0; k < model.joints(); ++k) {
      const Coordinate<S>& coordinate = model.coordinates[static_cast<size_t>(k)];
      G_(base_rows_ + k, base_rows_ + coordinate.index) = coordinate.multiplier;
    }
  }

  // Position of every joint, behind the base's pose.
  VectorX<S> expand_position(const VectorX<S>& q) const {
    if (!driven_) return q;
    const Eigen::Index base = model_.floating_base ? 7 : 0;
    VectorX<S> full(base + model_.joints());
    full.head(base) = q.head(base);
    for (int k = 0; k < model_.joints(); ++k) {
      const Coordinate<S>& coordinate = model_.coordinates[static_cast<size_t>(k)];
      full[base + k] = coordinate.multiplier * q[base + coordinate.index] + coordinate.offset;
    }
    return full;
  }
  // Velocity or acceleration of every joint, behind the base's.
  VectorX<S> expand_velocity(const VectorX<S>& v) const { return driven_ ? VectorX<S>(G_ * v) : v; }

  // M or C: Gᵀ X G.
  MatrixX<S> reduce_matrix(MatrixX<S> full) const { return driven_ ? MatrixX<S>(G_.transpose() * full * G_) : full; }
  // g, bias or W: Gᵀ X.
  template <class X>
  X reduce_rows(X full) const {
    return driven_ ? X(G_.transpose() * full) : full;
  }
  // A Jacobian: J G.
  MatrixX<S> reduce_columns(MatrixX<S> full) const { return driven_ ? MatrixX<S>(full * G_) : full; }

 private:
  const Model<S>& model_;
  bool driven_;
  int base_rows_;
  MatrixX<S> G_;
};

}  // namespace dalembert::generic
