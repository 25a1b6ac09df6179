// SPDX-License-Identifier: MIT
#include "run_folder/checkpoint.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include <flotilla/error.hpp>

#include "io/file.hpp"
#include "io/number.hpp"
#include "run_folder/hdf5.hpp"
#include "run_folder/run_files.hpp"

namespace flotilla::io {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "checkpoint-";
constexpr std::size_t kKept = 2;
constexpr const char* kContactRows = "/contact_rows";

struct CheckpointFile {
    std::int64_t step;
    fs::path path;
};

/// Newest first.
std::vector<CheckpointFile> list_checkpoints(const fs::path& folder) {
    std::vector<CheckpointFile> files;
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        const std::string name = it->path().filename().string();
        const std::string_view view = name;
        std::int64_t step = 0;
        if (view.starts_with(kPrefix) && view.ends_with(".h5") &&
            parse_number(view.substr(kPrefix.size(), view.size() - kPrefix.size() - 3), step))
            files.push_back({step, it->path()});
    }
    std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.step > b.step; });
    return files;
}

fs::path checkpoint_path(const fs::path& folder, std::int64_t step) {
    return folder / (std::string(kPrefix) + padded(step) + ".h5");
}

Checkpoint read_checkpoint(const CheckpointFile& entry) {
    const Hdf5Reader file(entry.path);
    Checkpoint checkpoint{entry.step, {}, {}};
    const auto bytes = file.read<std::uint8_t>("/state");
    checkpoint.state.resize(bytes.size());
    if (!bytes.empty()) std::memcpy(checkpoint.state.data(), bytes.data(), bytes.size());
    if (file.int_attribute("/", "step") != entry.step ||
        static_cast<std::uint64_t>(file.int_attribute("/", "checksum")) != checksum(checkpoint.state))
        throw IoError(entry.path.string() + ": damaged: the state does not match its checksum");
    if (!file.has(kContactRows)) return checkpoint;
    const auto rows = file.read<std::int64_t>(kContactRows);
    if (rows.size() != 3) throw IoError(entry.path.string() + ": damaged: it has other numbers of contacts");
    checkpoint.contacts = {rows[0], rows[1], rows[2]};
    return checkpoint;
}

} // namespace

void write_checkpoint(const fs::path& folder, std::int64_t step, std::span<const std::byte> state,
                      std::span<const CheckpointArray> arrays, const std::optional<ContactRows>& contacts) {
    Hdf5Writer file;
    file.attribute("/", "flotilla_checkpoint", std::int64_t{1});
    file.attribute("/", "step", step);
    file.attribute("/", "checksum", static_cast<std::int64_t>(checksum(state)));
    file.write<std::uint8_t>("/state", {reinterpret_cast<const std::uint8_t*>(state.data()), state.size()},
                             {state.size()});
    for (const auto& array : arrays) file.write<double>("/" + array.name, array.values, {array.values.size()});
    if (contacts) {
        const std::array<std::int64_t, 3> rows{contacts->from, contacts->contacts, contacts->totals};
        file.write<std::int64_t>(kContactRows, rows, {rows.size()});
    }
    write_file(checkpoint_path(folder, step), file.finish());
    const auto files = list_checkpoints(folder);
    for (std::size_t i = kKept; i < files.size(); ++i) {
        std::error_code error;
        fs::remove(files[i].path, error);
        if (error) throw IoError(files[i].path.string() + ": cannot remove: " + error.message());
    }
}

std::optional<Checkpoint> read_last_checkpoint(const fs::path& folder) {
    std::vector<std::string> warnings;
    for (const auto& entry : list_checkpoints(folder)) {
        try {
            Checkpoint checkpoint = read_checkpoint(entry);
            checkpoint.warnings = std::move(warnings);
            return checkpoint;
        } catch (const IoError& error) {
            warnings.emplace_back(error.what());
        }
    }
    if (warnings.empty()) return {};
    std::string message = folder.string() + ": no checkpoint is readable:";
    for (const auto& warning : warnings) message += "\n  " + warning;
    throw IoError(message);
}

} // namespace flotilla::io
