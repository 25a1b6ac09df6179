// SPDX-License-Identifier: MIT
#include "geometry/pack_avx2.hpp"

#include "static_contact/contact_rows_kernel.hpp"

namespace flotilla {

void set_principal_masses_avx2(const ContactBlock* const* blocks, ContactRow* const* rows, unsigned which) {
    set_principal_masses_any<Avx2Pack>(blocks, rows, which);
}

} // namespace flotilla
