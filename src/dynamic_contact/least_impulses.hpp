// SPDX-License-Identifier: MIT
// A linear complementarity problem with a symmetric matrix that is positive semidefinite.
#pragma once

#include <vector>

#include <Eigen/Dense>

namespace flotilla {

/// Changes l >= 0 (N s) to what solves
///
///     w = A l + q >= 0,  l >= 0,  l . w = 0,
///
/// of which `present` is w at the given l (m/s) and `matrix` A (1/kg), by block principal pivoting (Judice and Pires,
/// Comput. Oper. Res. 21, 1994), or where that goes round in circles by active sets. Each row yields a little, which is
/// taken back: so rows that say the same share what they carry. Whether it found a solution.
[[nodiscard]] bool least_impulses(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& present,
                                  std::vector<double>& impulses);

} // namespace flotilla
