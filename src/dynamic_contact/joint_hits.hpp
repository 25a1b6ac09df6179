// SPDX-License-Identifier: MIT
// Where sweeps of dynamic contact gain nothing: its hits solved together.
//
// A light body between heavy ones, or between one and the ground, hands on in a sweep no more than its own mass takes:
// pushes fall by the ratio of the masses, a plank under a roller of 10 times its mass takes 8 sweeps for each half of
// them, the links of a chain under a load of 100 times theirs thousands. So hits are kept here, each as what it asks
// for, n . u >= target, and after each round of queries the least impulses are found that satisfy all of an island's
// at once:
//
//     A l + q >= 0,  l >= 0,  l . (A l + q) = 0,     A = J M^-1 J^T,
//
// directly, by block principal pivoting (Judice and Pires, Comput. Oper. Res. 21, 1994). What that makes hit elsewhere
// is met in the next round. Rounds end where nothing hits any more, or a pair does so too often.
#pragma once

#include "pair/inelastic.hpp"

namespace flotilla {

/// Whether nothing hits any more. Clusters must be single bodies. `counters`: added to.
[[nodiscard]] bool resolve_jointly(const StepView& view, Movers movers, PairBook& book, Workers& workers,
                                   StageCounters& counters);

} // namespace flotilla
