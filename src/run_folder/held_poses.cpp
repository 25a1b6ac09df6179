// SPDX-License-Identifier: MIT
#include "run_folder/held_poses.hpp"

#include "run_folder/frames_in_order.hpp"

namespace flotilla::io {

HeldPoses::HeldPoses(RunReader& run, const FrameRange& range) : ends_(run.scene().bodies.size()) {
    if (run.info().edits_json.empty()) return;
    frames_in_order(
        run, range, [](const Frame& frame) { return &frame; }, [&](const Frame* frame, std::int64_t) { see(*frame); });
}

void HeldPoses::see(const Frame& frame) {
    for (std::size_t i = 0; i < ends_.size(); ++i) {
        if (frame.absent(i)) {
            any_ = true;
            continue;
        }
        const Seen seen{frame.index, frame.position[i], frame.rotation[i]};
        if (!ends_[i]) ends_[i] = Ends{seen, seen};
        ends_[i]->last = seen;
    }
}

Frame HeldPoses::hold(const Frame& frame) const {
    Frame held = frame;
    for (std::size_t i = 0; i < ends_.size(); ++i) {
        if (!any_ || !frame.absent(i) || !ends_[i]) continue;
        const Seen& at = frame.index < ends_[i]->first.frame ? ends_[i]->first : ends_[i]->last;
        held.position[i] = at.position;
        held.rotation[i] = at.rotation;
    }
    return held;
}

} // namespace flotilla::io
