// SPDX-License-Identifier: MIT
#include "geometry/pack_avx512.hpp"

#include "static_contact/contact_packets.hpp"
#include "static_contact/sweep_kernel.hpp"

namespace flotilla {

double sweep_avx512(Cone cone, const SweepView& view) { return sweep_any<Avx512Pack>(cone, view); }
double largest_violation_avx512(Cone cone, const SweepView& view) {
    return largest_violation_any<Avx512Pack>(cone, view);
}
double find_violated_avx512(Cone cone, const SweepView& view, double tolerance, std::uint8_t* violated) {
    return find_violated_any<Avx512Pack>(cone, view, tolerance, violated);
}
double largest_parked_violation_avx512(Cone cone, const SweepView& view) {
    return largest_parked_violation_any<Avx512Pack>(cone, view);
}
void apply_impulses_avx512(Cone cone, const SweepView& view) { apply_any<Avx512Pack>(cone, view); }

} // namespace flotilla
