// SPDX-License-Identifier: MIT
// What this library was built from; a run folder and a trace say it too.
#pragma once

#include <string_view>

namespace flotilla {

struct BuildInfo {
    std::string_view version;  ///< of the project
    std::string_view commit;   ///< git commit, "-dirty" appended where the tree had changes; "unknown" outside git
    std::string_view compiler; ///< name and version
    std::string_view flags;    ///< build type and its flags
};

[[nodiscard]] BuildInfo build_info();

} // namespace flotilla
