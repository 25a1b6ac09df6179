// SPDX-License-Identifier: MIT
// What a step leaves out because the scene does not need it (flotilla plan prints it). Switched off, the work is done
// all the same and comes to the same bits, but for the first one; tests and bench/scenarios/plan_savings do that,
// nobody else.
#pragma once

namespace flotilla {

struct Savings {
    /// Where no contact has friction, each has its normal's row alone. Without, rounding differs.
    bool normal_rows = true;
    /// Stage 1 looks at no pairs of which bounds show that nothing in them calls for an impulse.
    bool calm_pairs = true;
    /// Pairs of bodies are searched with a margin, and again only when a body leaves its own: until then one without
    /// pairs is ballistic and costs its bounds alone.
    bool kept_pairs = true;
    /// Bodies much larger than the others, or few bodies, fill no cells of a grid.
    bool large_bodies = true;
    /// Without scripted bodies no code of theirs runs.
    bool scripts = true;
    /// Where gravity moves and turns bodies by less in a step than the contact search sees, nothing is looked for
    /// ahead.
    bool look_ahead = true;
};

} // namespace flotilla
