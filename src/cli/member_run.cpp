// SPDX-License-Identifier: MIT
#include "cli/member_run.hpp"

#include <algorithm>
#include <fstream>
#include <vector>

#include <flotilla/error.hpp>

#include "cli/child_process.hpp"
#include "cli/commands.hpp"

namespace flotilla::cli {
namespace {

constexpr int kSignal = 128; // beyond it run_child gives signals

std::vector<std::string> command_of(const SweepMember& member, const std::string& time_limit) {
    std::vector<std::string> words{"run",           member.scene.string(),
                                   "--preset",      member.preset,
                                   "--steps",       std::to_string(member.steps),
                                   "--frame-every", std::to_string(member.frame_every),
                                   "--threads",     std::to_string(member.threads),
                                   "--output",      member.folder.string(),
                                   "--resume",      "--quiet"};
    for (const auto& [key, value] : member.overrides) {
        words.emplace_back("--set");
        words.push_back(key + "=" + value);
    }
    if (!time_limit.empty()) words.insert(words.end(), {"--time-limit", time_limit});
    return words;
}

/// What a run said at last, maybe in several lines, without the command's name: of one that is quiet, why it ended.
std::string last_message(const std::filesystem::path& log) {
    std::ifstream in(log);
    const std::string name = "flotilla: ";
    std::string last;
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with(name))
            last = line.substr(name.size());
        else if (!line.empty())
            last += (last.empty() ? "" : "\n") + line;
    }
    return last;
}

} // namespace

SweepAxis parse_axis(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) throw InputError("--vary " + text + ": must be key=a,b,...");
    SweepAxis axis{text.substr(0, equals), {}};
    for (std::size_t begin = equals + 1; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        axis.values.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return axis;
}

SweepOutcome run_member(const std::filesystem::path& program, const SweepMember& member, const std::string& time_limit,
                        const std::function<bool()>& stop) {
    const ChildResult child = run_child(program, command_of(member, time_limit), member.log, stop);
    if (child.exit_code > kSignal)
        return {kInternalError, "ended by signal " + std::to_string(child.exit_code - kSignal), child.cpu};
    return {child.exit_code, child.exit_code == kOk ? "" : last_message(member.log), child.cpu};
}

} // namespace flotilla::cli
