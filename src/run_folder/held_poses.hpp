// SPDX-License-Identifier: MIT
// Where programs that go from pose to pose find bodies that are not there (run_folder/run_bodies.hpp): at the place
// where they come or went. At the origin, where frames have them, they would be seen on the way to it and from it.
#pragma once

#include <optional>
#include <vector>

#include "run_folder/export.hpp"
#include "run_folder/run_folder.hpp"

namespace flotilla::io {

/// Of a range of frames. A body is there from one frame to another without a gap.
class HeldPoses {
  public:
    /// Reads the frames of a run that was edited; of others there is nothing to know.
    HeldPoses(RunReader& run, const FrameRange& range);

    /// Whether some body is not there in some frame.
    [[nodiscard]] bool any() const { return any_; }
    [[nodiscard]] bool seen(std::size_t body) const { return !any_ || ends_[body].has_value(); }
    /// The frame with bodies that are not there where they are seen first, before that, and where they are seen last,
    /// after it; at rest.
    [[nodiscard]] Frame hold(const Frame& frame) const;

  private:
    struct Seen {
        std::int64_t frame;
        Vec3 position;
        Quat rotation;
    };
    struct Ends {
        Seen first, last;
    };
    void see(const Frame& frame);

    bool any_ = false;
    std::vector<std::optional<Ends>> ends_; ///< by body; none: it is in no frame
};

} // namespace flotilla::io
