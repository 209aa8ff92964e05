#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "framework/core/aligned.hpp"
#include "framework/core/sum.hpp"
#include "framework/model/model.hpp"
#include "framework/model/rigid_kernels.hpp"

namespace tomlin {

/// The model's arrays. Kernels hold pointers into them, so none is resized after binding.
struct Model::Storage {
  std::size_t dofs = 0;
  std::size_t mapped_size = 0;
  std::size_t own_count = 0;
  std::deque<AlignedVector<double>> share;      ///< mass fractions, one array a body
  std::deque<AlignedVector<double>> reference;  ///< of rigid bodies
  std::deque<AlignedVector<double>> arms;
  std::vector<std::unique_ptr<RigidArguments>> rigid;
  std::vector<std::shared_ptr<void>> zeros;
  std::vector<PointForce<double>> point_forces;
  AlignedVector<double> inverse_mass;
  AlignedVector<double> largest_move;
  AlignedVector<double> tolerance_scale;
  AlignedVector<double> force;
  AlignedVector<double> mapped_position;
  AlignedVector<double> mapped_velocity;
  AlignedVector<double> mapped_force;
  AlignedVector<double> rates;
};

}  // namespace tomlin
