// SPDX-License-Identifier: MIT
#include "parallel/unbound.hpp"

#include <vector>

#include <omp.h>
#include <sched.h>

namespace flotilla {

struct Unbound::Cores {
    cpu_set_t set;
};

Unbound::Unbound() {
    const int places = omp_get_num_places();
    if (places == 0) return; // nobody is bound
    Cores bound;
    if (sched_getaffinity(0, sizeof bound.set, &bound.set) != 0) return;
    cpu_set_t all;
    CPU_ZERO(&all);
    std::vector<int> ids;
    for (int place = 0; place < places; ++place) {
        ids.resize(static_cast<std::size_t>(omp_get_place_num_procs(place)));
        omp_get_place_proc_ids(place, ids.data());
        for (const int id : ids) CPU_SET(static_cast<std::size_t>(id), &all);
    }
    if (sched_setaffinity(0, sizeof all, &all) == 0) bound_ = std::make_unique<Cores>(bound);
}

Unbound::~Unbound() {
    if (bound_) sched_setaffinity(0, sizeof bound_->set, &bound_->set);
}

void Unbound::stay() { bound_.reset(); }

} // namespace flotilla
