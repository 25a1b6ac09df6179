// SPDX-License-Identifier: MIT
// Recorded task graphs: what was read is written and read again to the same, and analysed.
#include <flotilla/trace.hpp>

#include "fuzz/checks.hpp"
#include "io/file.hpp"
#include "trace/trace_file.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace flotilla;
    const std::string text = fuzz::text_of(data, size);
    const std::string name = text.starts_with("\x1f\x8b") ? "trace.json.gz" : "trace.json";
    const std::filesystem::path path = fuzz::write_scratch(name, text), once = fuzz::scratch() / "once.json",
                                twice = fuzz::scratch() / "twice.json";
    fuzz::accepted(name, [&] {
        const io::Trace trace = io::read_trace(path);
        io::write_trace(once, trace.info, trace.record);
        const io::Trace again = io::read_trace(once);
        io::write_trace(twice, again.info, again.record);
        fuzz::require(io::read_text(once) == io::read_text(twice), "a written trace reads back to the same");
    });
    fuzz::accepted(name, [&] { (void)analyze_trace({path}, {.cores = {1, 4, 64}}); });
    return 0;
}
