// SPDX-License-Identifier: MIT
// The contact points of a run as CSV, one row per contact and step. Bodies are numbered in scene order from 0, body_a < body_b; p is the
// point (m, world), n the unit normal from a to b, gap the distance there (m); normal_impulse and tangential_impulse (N s, along n and
// the length of the rest) are what static contact at the end of the step, stage 7, did there to b, and the opposite to a.
// Sleeping bodies have contacts with awake ones only.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include <flotilla/report.hpp>

#include "io/file_stream.hpp"

namespace flotilla::io {

inline constexpr std::string_view kContactsHeader =
    "step,time,body_a,body_b,px,py,pz,nx,ny,nz,gap,normal_impulse,tangential_impulse";

/// Written aside; the file is there once close() has been called. Compressed where its name ends with .gz.
class ContactsCsv {
  public:
    explicit ContactsCsv(const std::filesystem::path& path);

    /// The contacts at the end of a step; `time` in s.
    void add(std::int64_t step, double time, std::span<const ContactState> contacts);
    void close() { out_.close(); }

  private:
    OutputStream out_;
};

} // namespace flotilla::io
